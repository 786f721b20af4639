#pragma once
/// Writes a text as a whole.

#include <string>
#include <string_view>

namespace cvtflow::tools {

/// A plain file appears under its name when it is complete, and what was there stays until then; devices, pipes and links are written as by
/// a shell's `>`. @throws engine::RecordError "FILE: cannot write: reason"
void write_text(const std::string& path, std::string_view text);

}  // namespace cvtflow::tools
