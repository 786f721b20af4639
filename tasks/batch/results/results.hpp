#pragma once
/// The table of a sweep: its columns, rows made from results, and what may be joined.

#include <string>
#include <vector>

#include "engine/base/hash.hpp"
#include "engine/record/case_table.hpp"
#include "tasks/batch/case_engine.hpp"
#include "tasks/batch/sweep/sweep.hpp"

namespace cvtflow::tasks {

/// Begins the names of columns with measured errors of scalars, in sweeps with an accuracy.
inline constexpr std::string_view error_prefix = "error_of_";

/// case, status, varying keys, scalars, their errors, start, steps, evaluations, …, wall, threads, hash, error.
[[nodiscard]] engine::RowLayout result_layout(const Sweep& sweep);

/// The table without rows, with provenance and what the results depend on.
[[nodiscard]] engine::CaseTable empty_table(const Sweep& sweep);

/// The table in a file, with the columns that every sweep's has.
/// @throws engine::RecordError as engine::read_cases, and "out/cases.h5: a table, but not of a sweep: it has no column 'case' of integers"
[[nodiscard]] engine::CaseTable read_results(const std::string& path);

/// Number of cases of a table's sweep. @throws engine::RecordError if the attribute is missing
[[nodiscard]] long cases_of(const engine::CaseTable& table, const std::string& path);

/// Fills and seals a row. @param scene of the case
void fill_row(const engine::RowLayout& layout, const Sweep& sweep, const CaseResult& result, std::span<std::byte> row);

/// Refuses to continue or join results of another sweep.
/// @throws SimulationError, a line per difference:
///     out/cases.h5: results of another sweep:
///       axes.load.torque = 6, 12 there, 6, 12, 18 here
void require_same_sweep(const std::string& path, const engine::CaseTable& there, const engine::CaseTable& here);

/// Rows in the order of their cases.
void sort_rows(engine::CaseTable& table);

/// Everything of a row but wall time, threads, and what it comes from (program, start state).
void add_result(engine::Hash& hash, const engine::RowLayout& layout, std::span<const std::byte> row);

/// Hash over everything in the rows, in the order of cases, but what differs from run to run (wall time, threads) and what they come from
/// (program, start state). Equal for every number of threads, shards, kills and resumptions.
[[nodiscard]] std::string results_hash(const engine::CaseTable& table);

/// Text for people and CSV of the rows in the order of their cases. @param units whether CSV headings carry them
[[nodiscard]] std::string csv_text(const engine::CaseTable& table);

}  // namespace cvtflow::tasks
