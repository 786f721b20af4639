#pragma once
/// The results of a sweep in its folder, and what they amount to:
///
///     DIR/sweep.toml   the sweep as it was run
///     DIR/sweep.json   facts: columns with units, all that results depend on, provenance, status
///     DIR/rows-*.csv   a line per case, by the process that ran it (engine/record/row_files.hpp)
///     DIR/results.csv  all lines in the order of cases, once the sweep is finished
///
/// A cell is a number that reads back as the same double, "nan", or a text.

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/record/row_files.hpp"
#include "engine/record/run/schema.hpp"
#include "tasks/batch/case_engine.hpp"
#include "tasks/batch/sweep/sweep.hpp"

namespace cvtflow::tasks {

struct ResultColumn {
    std::string name, unit, description;  ///< unit is empty for texts
    std::string key{};                    ///< key of the scene that varies; empty for results
    bool operator==(const ResultColumn&) const = default;
};

/// Begins the names of columns with errors of scalars, of cases that end when they are steady.
inline constexpr std::string_view error_prefix = "error_of_";

/// case, status, varying keys, scalars, their errors, start, steps, evaluations, …, wall, hash, error.
[[nodiscard]] std::vector<ResultColumn> result_columns(const Sweep& sweep);
/// Heading of the rows: names with units in brackets, but for pure numbers.
[[nodiscard]] std::string heading_of(const std::vector<ResultColumn>& columns);
/// Cells of a case in the order of the columns.
[[nodiscard]] std::string row_of(const Sweep& sweep, const CaseResult& result);

/// What DIR/sweep.json says.
struct SweepFacts {
    std::vector<engine::Attribute> attributes;  ///< sweep, description, sweep_path, cases, definition, parameters, status, …
    std::vector<ResultColumn> columns;

    [[nodiscard]] std::string text(std::string_view name) const;  ///< empty if there is none
    void set(engine::Attribute attribute);
    [[nodiscard]] long cases() const;
    [[nodiscard]] bool finished() const { return text("status") == "finished"; }
};

/// The facts of a sweep that begins.
[[nodiscard]] SweepFacts facts_of(const Sweep& sweep);
/// @throws engine::RecordError  "DIR: contains no sweep"; damaged; results of version 0.4, with what can be done
[[nodiscard]] SweepFacts read_facts(const std::string& folder);
/// Whether a folder has facts of a sweep.
[[nodiscard]] bool holds_sweep(const std::string& folder);
/// Writes or replaces the facts. @throws engine::RecordError
void write_facts(const std::string& folder, const SweepFacts& facts);
/// Begins a sweep in a folder, or checks that the one there is the same: equal in all that results depend on, by the same program.
/// @return the facts that are there   @throws engine::RecordError; SimulationError, a line per difference:
///     out: results of another sweep:
///       axes.load.torque = 6, 12 there, 6, 12, 18 here
[[nodiscard]] SweepFacts begin_results(const std::string& folder, const Sweep& sweep);

/// What the rows of a sweep amount to.
class CaseTally {
public:
    /// A message with which cases failed.
    struct Failure {
        std::string status, error;
        long first = 0;  ///< smallest number of its cases
        long cases = 0;
    };
    static constexpr std::size_t max_failures = 3;

    void add(long number, const std::string& status, const std::string& notes, const std::string& error);

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

/// The rows of a folder with the meaning of their cells.
class SweepRows {
public:
    /// Finished, running, or left by a killed process. @throws engine::RecordError
    explicit SweepRows(const std::string& folder) : SweepRows(folder, read_facts(folder)) {}
    SweepRows(const std::string& folder, SweepFacts facts);

    [[nodiscard]] const SweepFacts& facts() const noexcept { return facts_; }
    [[nodiscard]] const engine::RowFiles& files() const noexcept { return files_; }
    /// Reads what other processes have added. @return whether there was anything   @throws engine::RecordError
    bool refresh() { return files_.refresh(); }
    [[nodiscard]] std::size_t size() const noexcept { return files_.size(); }
    /// Place of a column. @throws std::out_of_range
    [[nodiscard]] std::size_t column(std::string_view name) const;
    /// Cells of a case, which has a row. @throws engine::RecordError  damaged
    [[nodiscard]] std::vector<std::string> cells(long number) const;
    /// A cell; not a number if it is none.
    [[nodiscard]] double number(long of_case, std::string_view column) const;
    [[nodiscard]] std::string text(long of_case, std::string_view column) const;
    [[nodiscard]] CaseTally tally() const;
    /// Hash over all cells in the order of cases, but for what differs from run to run (wall time) and what a row comes from (program,
    /// start state). Equal for every number of threads, workers, kills and resumptions.
    [[nodiscard]] std::string hash() const;
    /// All rows in the order of cases as a file. @param change may change the cells of a case before it is written
    [[nodiscard]] std::string file(const std::function<void(long, std::vector<std::string>&)>& change = {}) const;

private:
    SweepFacts facts_;
    engine::RowFiles files_;
};

/// Writes DIR/results.csv and the facts of a finished sweep. @param facts  status, hash and remarks are set by the caller
void write_results(const std::string& folder, const SweepFacts& facts, const std::string& rows);

/// Takes the rows with one of these statuses out of a folder, so that their cases run again. @throws SimulationError  a process is at work
/// there
void drop_rows(const std::string& folder, const SweepFacts& facts, const std::vector<std::string>& statuses);

/// Progress of the sweep in a folder, running or not.
struct FolderProgress {
    /// A process that has added rows.
    struct Worker {
        std::string name;
        long rows = 0;
        long pieces = 0;       ///< pieces of the work that it has claimed
        bool running = false;  ///< on this machine
    };

    SweepFacts facts;
    CaseTally tally;  ///< statuses of all done cases
    std::vector<Worker> workers;
};

/// Reads everything of the folder; writes and locks nothing. @throws engine::RecordError
[[nodiscard]] FolderProgress folder_progress(const std::string& folder);

}  // namespace cvtflow::tasks
