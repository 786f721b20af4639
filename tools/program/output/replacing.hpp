#pragma once
/// Treatment of existing files at the path of a record, a state or a checkpoint.

#include <string>

namespace cvtflow::tools {

inline constexpr const char* force_meaning = "Replace existing output files";

/// @param chosen whether the user gave the name; a default name is replaced without --force
/// @return a notice of what is replaced; empty: nothing
/// @throws engine::RecordError if the file exists, the name was chosen, and `force` is false
[[nodiscard]] std::string replacing(const std::string& file, bool chosen, bool force);

/// Refuses to start a run whose checkpoint exists: that run is unfinished, and its checkpoint would be lost.
/// @throws engine::RecordError if a checkpoint exists and `force` is false
void keep_checkpoint(const std::string& file, bool force);

}  // namespace cvtflow::tools
