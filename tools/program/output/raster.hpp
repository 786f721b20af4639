#pragma once
/// SVG as PNG, by librsvg's program.

#include <string>

namespace cvtflow::tools {

/// Writes a picture as PNG with rsvg-convert.
/// @throws std::runtime_error if rsvg-convert is missing (names the package) or fails
void write_png(const std::string& path, const std::string& svg);

}  // namespace cvtflow::tools
