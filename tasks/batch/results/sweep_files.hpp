#pragma once
/// The files that a sweep writes into its folder, by name: what it may replace there, all that it removes, and what the rows of its table
/// come from (the version of the program, the states that the scene names, whether there are records). Internal to tasks.

#include <filesystem>
#include <string>

#include "engine/record/case_table.hpp"
#include "engine/record/run/output_rule.hpp"
#include "tasks/batch/sweep/sweep.hpp"

namespace cvtflow::tasks {

/// The table of a sweep. Replaces a table with the same definition. @param read  the contents of the file were read and are of this sweep,
/// even if HDF5 cannot read it
[[nodiscard]] engine::Permit permit_table(const std::string& file, const std::string& definition, bool read = false);
/// The record of a case. Replaces one of the same case, and what a killed writer left of it.
[[nodiscard]] engine::Permit permit_record(const std::string& file, const Scene& of_case);
/// A state or checkpoint. Replaces one.
[[nodiscard]] engine::Permit permit_state(const std::string& file, const Sweep& sweep);

/// Removes the checkpoints and ends of cases that are over: DIR/checkpoints and DIR/continuation. Files of other names stay, and so do the
/// sweep's inputs.
void remove_case_files(const std::filesystem::path& checkpoints, const std::filesystem::path& continuation, const Sweep& sweep);

/// Removes the ends of the cases of a strand likewise.
void remove_ends(const std::filesystem::path& continuation, const Sweep& sweep, long strand);

/// Notes in a table without rows what this program would fill it from. @throws as saved_start
void set_origin(engine::CaseTable& table, const Sweep& sweep);

/// Sets the attribute `program` of a recovered table to the versions in its rows.
void set_programs_of_rows(engine::CaseTable& table);

/// Refuses to join rows of different origin, in a line that names what differs; or, if that is `mixed` knowingly, notes both in `there`.
/// @throws SimulationError  "out/cases.h5: program 0.2.0 (b9f2dddb) there, 0.2.0 (c0ffee00) here; …"
void require_same_origin(const std::string& path, engine::CaseTable& there, const engine::CaseTable& here, bool mixed);

}  // namespace cvtflow::tasks
