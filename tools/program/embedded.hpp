#pragma once
/// Files that the program contains (tools/cmake/embedded.cmake): licences, and the icon of FMUs.

#include <string_view>

namespace cvtflow::tools {

/// Contents of an embedded file. @param name "LICENSE", "licenses.txt", "fmu_icon.svg", "fmu_icon.png"
[[nodiscard]] std::string_view embedded(std::string_view name);

}  // namespace cvtflow::tools
