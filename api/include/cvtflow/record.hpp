#pragma once
/// Files that runs and sweeps have written. A file is opened at once and read on request; it may still be growing, or come from a killed
/// run. Every failure is an Error (record) that names the file. HDF5 is not thread-safe: only one thread at a time may use an object, or
/// two of them.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <cvtflow/export.hpp>
#include <cvtflow/simulation.hpp>

namespace cvtflow {
inline namespace v0 {

using RecordValue = std::variant<std::string, double, std::int64_t>;
using RecordAttributes = std::vector<std::pair<std::string, RecordValue>>;

/// A column of a table, or a channel over time.
struct Column {
    std::string name;
    std::string unit;  ///< "N*m", "1" for none; empty for texts
    std::string description;
    std::size_t width = 1;  ///< numbers per row
    bool text = false;
};

/// The record of a run (`cvtflow run`).
class CVTFLOW_EXPORT Record {
public:
    explicit Record(const std::string& path);
    ~Record();
    Record(Record&& other) noexcept;
    Record& operator=(Record&& other) noexcept;

    /// "finished", "running" (also of a killed run), "unreliable", "cycle_missed: …", or what ended the run.
    [[nodiscard]] const std::string& status() const noexcept;
    /// Attributes of the whole file: scene, method, versions, balance.
    [[nodiscard]] RecordAttributes attributes() const;
    [[nodiscard]] std::vector<Column> channels() const;
    /// Number of rows when the file was opened.
    [[nodiscard]] std::size_t rows() const noexcept;
    /// Rows first … first + count - 1 of a channel, or of "time" [s]: [count * width], row by row.
    [[nodiscard]] std::vector<double> read(const std::string& channel, std::size_t first, std::size_t count) const;
    /// All rows.
    [[nodiscard]] std::vector<double> read(const std::string& channel) const;
    /// Times of the states recorded [s].
    [[nodiscard]] std::vector<double> state_times() const;
    /// Unknowns of a recorded state [unknowns], in the order of Simulation::unknowns(). @param number 0 … state_times().size() - 1
    [[nodiscard]] std::vector<double> state(std::size_t number) const;
    /// Phases of the tips in a recorded state [tips], as those of a Transition.
    [[nodiscard]] std::vector<std::uint8_t> phases(std::size_t number) const;
    /// All changes of a tip's phase, in their order.
    [[nodiscard]] std::vector<Transition> transitions() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Channels so far by sum, from whose changes the mean of a quotient follows: of an efficiency five energies [J], of the speed ratio the
/// angles of both shafts [rad]; empty for other channels. A machine may lack some: they count as zero.
[[nodiscard]] CVTFLOW_EXPORT std::vector<std::vector<std::string>> sums_of_quotient(const std::string& channel);

/// Writes the record of a simulation while it is advanced: channels, states, transitions and file of `cvtflow run`, at the scene's
/// run.output_interval from now on. Settling is not recorded. Without `replace`, no existing file is replaced, and no rows of a killed run
/// in `path`.part are discarded. Must not outlive the simulation; one at a time for each.
class CVTFLOW_EXPORT Recording {
public:
    /// @throws Error (record) for files that cannot be written, (state) if the simulation is being recorded already
    Recording(Simulation& simulation, const std::string& path, bool replace = false);
    /// Leaves the rows in `path`.part if finish() was not called.
    ~Recording();
    Recording(Recording&& other) noexcept;
    Recording& operator=(Recording&& other) noexcept;

    /// Completes the record, which takes its final name. @param complete false: the status becomes "cancelled"
    /// @throws Error (record)
    void finish(bool complete = true);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace v0
}  // namespace cvtflow
