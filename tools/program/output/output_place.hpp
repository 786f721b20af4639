#pragma once
/// Checks of output paths: results never replace their inputs.

#include <filesystem>
#include <string>
#include <vector>

namespace cvtflow::tools {

/// Errors (RecordError) if `path`, or its .part, is one of the `inputs` under whatever name.
void require_no_input(const std::string& path, const std::vector<std::filesystem::path>& inputs);

/// As require_no_input, and engine::require_replaceable: for files that are written as a whole and renamed at the end. An empty path
/// passes.
void require_output(const std::string& path, const std::vector<std::filesystem::path>& inputs);

/// Checks the path of a checkpoint: as require_output. It must differ from the record's, and an existing file must be a checkpoint, because
/// it is removed at the end of the run.
void require_checkpoint_place(const std::string& path, const std::string& record, const std::vector<std::filesystem::path>& inputs);

}  // namespace cvtflow::tools
