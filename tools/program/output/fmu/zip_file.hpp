#pragma once
/// A ZIP file of a few parts, stored as they are.

#include <string>
#include <vector>

namespace cvtflow::tools {

struct ZipPart {
    std::string name;  ///< with '/' between folders
    std::string bytes;
};

/// The file's bytes: the same for the same parts. @throws std::length_error beyond 4 GiB
[[nodiscard]] std::string zip_file(const std::vector<ZipPart>& parts);

}  // namespace cvtflow::tools
