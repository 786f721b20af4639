#pragma once
/// What an exception says to a user.

#include <exception>
#include <string>

namespace cvtflow::engine {

/// what(), which our own exceptions make for users; of the standard library's: "PATH: reason" for a failure of std::filesystem, and for
/// those that only a mistake of this program's can cause (an index out of range, an empty variant) that it is one.
[[nodiscard]] std::string error_text(const std::exception& error);

}  // namespace cvtflow::engine
