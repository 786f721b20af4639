#pragma once
/// Writes a text as a whole.

#include <string>
#include <string_view>

namespace cvtflow::tools {

/// @throws std::runtime_error "FILE: cannot write"
void write_text(const std::string& path, std::string_view text);

}  // namespace cvtflow::tools
