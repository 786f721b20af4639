#pragma once
/// Where results may go: never over what they are made from.

#include <filesystem>
#include <string>
#include <vector>

namespace cvtflow::tools {

/// Errors (RecordError) if `path`, or its .part, is one of the `inputs` under whatever name.
void require_no_input(const std::string& path, const std::vector<std::filesystem::path>& inputs);

/// Requires that, and engine::require_replaceable: for what is written as a whole and takes its name in the end. Nothing to say about an
/// empty path.
void require_output(const std::string& path, const std::vector<std::filesystem::path>& inputs);

/// A checkpoint's place: as require_output; not the record's, and no file that is anything else, for it is removed when the run has
/// finished.
void require_checkpoint_place(const std::string& path, const std::string& record, const std::vector<std::filesystem::path>& inputs);

}  // namespace cvtflow::tools
