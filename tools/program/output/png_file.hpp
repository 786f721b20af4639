#pragma once
/// Pictures as PNG.

#include <string>

namespace cvtflow::tools {

/// A picture as PNG, by rsvg-convert, with a text chunk that contains `mark`. @param path in messages
/// @throws std::runtime_error if rsvg-convert is missing (names the package) or fails
[[nodiscard]] std::string png_of(const std::string& path, const std::string& svg, const std::string& mark);

}  // namespace cvtflow::tools
