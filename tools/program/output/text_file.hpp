#pragma once
/// Writes a text as a whole.

#include <string>
#include <string_view>

namespace cvtflow::tools {

/// A plain file takes its name when it is complete; an existing file remains until then. Devices, pipes and links are written as by a
/// shell's `>`. @throws engine::RecordError "FILE: cannot write: reason"
void write_text(const std::string& path, std::string_view text);

}  // namespace cvtflow::tools
