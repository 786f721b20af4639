#pragma once
/// What becomes of a file that is already where a record, a state or a checkpoint is to go.

#include <string>

namespace cvtflow::tools {

inline constexpr const char* force_meaning = "Replace what is already there under the names given";

/// @param chosen whether the user gave the name, who may have meant another; a default name is there to be used again
/// @return a line that says what is replaced; empty: nothing is
/// @throws engine::RecordError if the file is there, the name was chosen, and `force` is not given
[[nodiscard]] std::string replacing(const std::string& file, bool chosen, bool force);

/// A checkpoint is there only while its run is not finished: beginning anew would lose it.
/// @throws engine::RecordError if there is one and `force` is not given
void keep_checkpoint(const std::string& file, bool force);

}  // namespace cvtflow::tools
