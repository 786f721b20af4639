#pragma once
/// The files that a sweep writes into its folder, by name: what it may replace there, all that it removes, and what the rows of its table
/// come from (the version of the program, the states that the scene names, whether there are records). Internal to tasks.

#include <filesystem>
#include <string>

#include "engine/record/case_table.hpp"
#include "engine/record/run/output_rule.hpp"
#include "tasks/batch/sweep/sweep.hpp"

namespace cvtflow::tasks {

/// The table of a sweep. Replaces a table with the same definition. @param read  the file's own contents were read and are of this sweep,
/// even if HDF5 cannot read it
[[nodiscard]] engine::Permit permit_table(const std::string& file, const std::string& definition, bool read = false);
/// The record of a case. Replaces one of the same case, and what a killed writer left of it.
[[nodiscard]] engine::Permit permit_record(const std::string& file, const Scene& of_case);
/// A state or checkpoint. Replaces one.
[[nodiscard]] engine::Permit permit_state(const std::string& file, const Sweep& sweep);

/// Removes the checkpoints and ends of cases that are over: DIR/checkpoints and DIR/continuation. Files of other names stay, and so do the
/// sweep's inputs.
void remove_case_files(const std::filesystem::path& checkpoints, const std::filesystem::path& continuation, const Sweep& sweep);

}  // namespace cvtflow::tasks
