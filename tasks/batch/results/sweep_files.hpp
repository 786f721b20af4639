#pragma once
/// The records and states that a sweep writes into its folder, by name: what it may replace there, and all that it removes. Internal to
/// tasks.

#include <filesystem>
#include <string>
#include <string_view>

#include "engine/record/run/part_file.hpp"
#include "tasks/batch/sweep/sweep.hpp"

namespace cvtflow::tasks {

/// Advice in messages about files that are in the way.
inline constexpr const char* remove_by_hand = "move it away, or name another folder";

/// File of a case in a folder, "case-000012.h5" or "end-000012.state".
[[nodiscard]] std::string case_file(const std::filesystem::path& folder, std::string_view kind, long number);
/// The record of a case. Replaces one of the same case, and what a killed writer left of it.
[[nodiscard]] engine::OutputFile case_record(const std::string& file, const Scene& of_case);
/// Removes the ends of cases, DIR/continuation, or those of one strand. Files of other names stay, and so do the sweep's inputs.
void remove_ends(const std::filesystem::path& continuation, const Sweep& sweep, long strand = -1);

}  // namespace cvtflow::tasks
