#pragma once
/// Texts inside HTML, SVG and XML.

#include <string>
#include <string_view>

namespace cvtflow::tools {

/// A text, escaped for use between tags or in an attribute.
[[nodiscard]] std::string html(std::string_view text);

}  // namespace cvtflow::tools
