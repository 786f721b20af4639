#pragma once
/// Files that the program contains (tools/cmake/embedded.cmake): licences.

#include <string_view>

namespace cvtflow::tools {

/// Contents of an embedded file. @param name "licenses.txt"
[[nodiscard]] std::string_view embedded(std::string_view name);

}  // namespace cvtflow::tools
