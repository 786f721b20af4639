#pragma once
/// What rows of a table come from beside the sweep: the version of the program, the states that the scene names, whether there are records.

#include <string>

#include "engine/record/case_table.hpp"
#include "tasks/batch/sweep/sweep.hpp"

namespace cvtflow::tasks {

/// Notes in a table without rows what this program would fill it from. @throws as saved_start
void set_origin(engine::CaseTable& table, const Sweep& sweep);

/// Of the rows of a table that was recovered: versions of the program in them.
void set_programs_of_rows(engine::CaseTable& table);

/// Refuses to join rows of different origin, in a line that names what differs; or, if that is `mixed` knowingly, notes both in `there`.
/// @throws SimulationError  "out/cases.h5: program 0.2.0 (b9f2dddb) there, 0.2.0 (c0ffee00) here; …"
void require_same_origin(const std::string& path, engine::CaseTable& there, const engine::CaseTable& here, bool mixed);

}  // namespace cvtflow::tasks
