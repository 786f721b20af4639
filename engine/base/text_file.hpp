#pragma once
/// A whole text file, or an error: never the part that could be read, and never without end.

#include <cstddef>
#include <string>

namespace cvtflow::engine {

/// Contents of a file, a pipe or a device. A pipe into which nothing comes for `patience` seconds is given up.
/// @param most longest text [byte]
/// @throws std::runtime_error with the reason alone ("No such file or directory", "longer than 4194304 bytes")
[[nodiscard]] std::string read_text_file(const std::string& path, std::size_t most, double patience = 10.0);

}  // namespace cvtflow::engine
