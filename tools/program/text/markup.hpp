#pragma once
/// Texts inside HTML, SVG and XML, and SHA-256, by which a page's policy names the scripts that may run.

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace cvtflow::tools {

/// A text, escaped for use between tags or in an attribute.
[[nodiscard]] std::string html(std::string_view text);

[[nodiscard]] std::array<std::byte, 32> sha256(std::span<const std::byte> bytes);

}  // namespace cvtflow::tools
