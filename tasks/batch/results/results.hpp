#pragma once
/// The table of a sweep: its columns, rows made from results, what they amount to, and what may be joined. A table that can no longer be
/// opened is recovered: intact rows are kept, the other cases run again.

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/record/case_table.hpp"
#include "tasks/batch/case_engine.hpp"
#include "tasks/batch/sweep/sweep.hpp"

namespace cvtflow::tasks {

class CaseTally {
public:
    /// A message with which cases failed.
    struct Failure {
        std::string status, error;
        long first = 0;  ///< smallest number of its cases
        long cases = 0;
    };
    static constexpr std::size_t max_failures = 3;

    void add(const engine::RowLayout& layout, std::span<const std::byte> row);

    [[nodiscard]] long rows() const noexcept { return rows_; }
    /// Rows with another status than ok.
    [[nodiscard]] long failed() const noexcept;
    [[nodiscard]] const std::map<std::string, long>& statuses() const noexcept { return statuses_; }
    [[nodiscard]] const std::map<std::string, long>& notes() const noexcept { return notes_; }
    /// The first few different messages, in the order of the rows.
    [[nodiscard]] const std::vector<Failure>& failures() const noexcept { return failures_; }

private:
    long rows_ = 0;
    std::map<std::string, long> statuses_, notes_;
    std::vector<Failure> failures_;
};

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

/// Fills and seals a row.
void fill_row(const engine::RowLayout& layout, const Sweep& sweep, const CaseResult& result, std::span<std::byte> row);

/// Refuses to continue or join results of another sweep.
/// @throws SimulationError, a line per difference:
///     out/cases.h5: results of another sweep:
///       axes.load.torque = 6, 12 there, 6, 12, 18 here
void require_same_sweep(const std::string& path, const engine::CaseTable& there, const engine::CaseTable& here);

/// Rows in the order of their cases.
void sort_rows(engine::CaseTable& table);

/// Whether a column is part of the hash: not wall time and threads, nor what a row comes from (program, start state).
[[nodiscard]] bool is_hashed(std::string_view column) noexcept;

/// Hash over everything in the rows, in the order of cases, but what differs from run to run (wall time, threads) and what they come from
/// (program, start state). Equal for every number of threads, shards, kills and resumptions.
[[nodiscard]] std::string results_hash(const engine::CaseTable& table);

/// CSV of the rows in their order.
[[nodiscard]] std::string csv_text(const engine::CaseTable& table);

/// The rows of a table on disk in the order of their cases, a few at a time: memory grows by 16 bytes per case and no more.
class OrderedRows {
public:
    /// @throws engine::RecordError
    explicit OrderedRows(const std::string& path);

    [[nodiscard]] const engine::CaseTable& head() const noexcept { return reader_.head(); }
    [[nodiscard]] std::size_t size() const noexcept { return order_.size(); }
    [[nodiscard]] const CaseTally& tally() const noexcept { return tally_; }
    /// Row of a case, valid until the next call; empty if it has none.
    [[nodiscard]] std::span<const std::byte> of_case(long number);
    /// results_hash() of all rows. @param change applied to every row before it is hashed
    [[nodiscard]] std::string hash(const std::function<void(std::span<std::byte>)>& change = {});
    /// Writes rows for engine::write_cases().
    void fill(std::size_t first, std::span<std::byte> rows);

private:
    [[nodiscard]] std::span<const std::byte> row(std::size_t place);

    engine::CaseReader reader_;
    std::vector<std::pair<long, std::size_t>> order_;  ///< case, row in the file; ascending
    CaseTally tally_;
    std::vector<std::byte> window_;  ///< rows from first_ on
    std::size_t first_ = 0;
};

/// Prefix of every mark.
inline constexpr std::string_view mark_of_a_sweep = "rows of the sweep ";

/// Identifies a table in a line, as an attribute whose text is found in the file's bytes: a hash of everything that the results depend on,
/// the shard and the columns. Tables of equal marks contain rows of the same sweep.
void set_mark(engine::CaseTable& table);

/// The rows of a table that was growing when power went. @param begin  that sweep's, without rows, marked
/// @return nothing if the file is not known to be of that sweep, or was finished
[[nodiscard]] std::optional<engine::CaseTable> recover_results(const std::string& path, const engine::CaseTable& begin);

}  // namespace cvtflow::tasks
