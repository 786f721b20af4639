#pragma once
/// Writes outputs of a run to its record, and keeps the means of the report. Internal to tasks.

#include <chrono>
#include <memory>
#include <vector>

#include "engine/record/run/former_record.hpp"
#include "engine/record/run/run_file.hpp"
#include "tasks/channel/channels.hpp"
#include "tasks/run/run.hpp"

namespace cvtflow::tasks {

/// Rows and states of a whole run, before they are compressed [byte].
[[nodiscard]] double record_bytes(const Scene& scene, const model::ChainModel& chain);

/// Channels between samples at the ends of steps, where they are linear: values at outputs, or means over the time since the output before.
class RowSamples {
public:
    /// @param averaged columns that are averages where means are taken   @param means  outputs are means
    RowSamples(std::vector<bool> averaged, bool means)
        : averaged_(std::move(averaged)), means_(means), before_(averaged_.size()), sum_(averaged_.size()) {}

    [[nodiscard]] bool means() const noexcept { return means_; }
    [[nodiscard]] bool any() const noexcept { return any_; }
    [[nodiscard]] double last() const noexcept { return last_; }  ///< time of the latest sample [s]
    /// Values at a time between the latest sample and the next one. time, next [s]; row, out [columns]
    void between(double time, double next, std::span<const double> row, std::span<double> out) const;
    /// Values of all columns at a time between outputs, or at one [s].
    void add(double time, std::span<const double> row);
    /// Replaces values by means at an output, which has been added; the next mean begins there.
    void take(std::span<double> row);
    void visit(engine::Archive& archive);

private:
    std::vector<bool> averaged_;
    bool means_;
    double begin_ = 0.0, last_ = 0.0;  ///< times of the begin of the mean and of the latest sample [s]
    bool any_ = false;
    std::vector<double> before_, sum_;  ///< [columns]: values [unit of the channel], integrals [unit s]
};

class RunRecorder final : public RunObserver {
public:
    RunRecorder(const Scene& scene, const Simulation& simulation, const RunOptions& options);

    void output(double time, const Workspace& workspace, const Counters& counters) override;  ///< time [s]
    /// An output that steps do not end at is between two samples.
    [[nodiscard]] bool samples(double time) const noexcept override {
        return begin_ >= 0.0 && (means_.curve().due(time) || (file_ && between_ && near_output(time)));
    }
    void sample(double time, const Workspace& workspace, const Counters& counters) override;
    void transition(const TransitionRecord& record) override;
    /// Means so far: whether the run should end because they are steady.
    [[nodiscard]] const RunMeans& means() const noexcept { return means_; }
    /// Identity of the run: drawn when it began, kept by its checkpoints; empty without a record.
    [[nodiscard]] const std::string& run() const noexcept { return run_; }
    /// Position of the record and the means, for a checkpoint; all of it is on disk then.
    [[nodiscard]] std::vector<std::byte> position();
    /// Continues from there, with the rows of the record that options.from names.
    void restore(std::span<const std::byte> position);  ///< @throws engine::ArchiveError
    /// Ends the record with the simulation as it is now, and completes the report: all but its history, its fault and what it ran with.
    /// @param wall time of the run; 0: time since construction [s]
    void finish(const Simulation& simulation, RunReport& report, double wall = 0.0);
    /// Time span of the present part of the run, for progress. begin [s], until [s]
    void begin_part(double begin, double until) noexcept;

private:
    void visit(engine::Archive& archive);
    /// Whether an output lies within a step before or after a time [s].
    [[nodiscard]] bool near_output(double time) const noexcept;
    void read(const Instant& instant);  ///< the channels into the row
    /// Writes the outputs between the latest sample and the present one, and adds it. time [s]
    void add_between(double time, const Workspace& workspace);
    void write(double time, std::span<double> row);             ///< an output that has been added. time [s], row [columns]
    void write_state(double time, const Workspace& workspace);  ///< time [s]

    const RunOptions& options_;
    double state_interval_;  ///< [s]
    int followed_pin_;
    bool has_pulleys_;
    model::Observer observer_;
    std::vector<const Channel*> channels_;
    std::vector<double> row_;          ///< one number per column of the channels [columns]
    std::vector<double> row_between_;  ///< [columns]
    RowSamples samples_{{}, false};
    bool between_;              ///< outputs may lie between ends of steps
    double output_interval_;    ///< [s]
    double longest_step_;       ///< [s]
    double next_output_ = 0.0;  ///< where outputs lie between ends of steps: the first one after the latest sample [s]
    std::string run_;
    engine::FormerRecord former_;  ///< the rows before the checkpoint
    engine::RunContents contents_;
    std::unique_ptr<engine::RunFile> file_;
    engine::RecordPosition written_{{}, {}, {{}}};
    double next_state_ = 0.0;           ///< [s]
    double begin_ = 0.0, until_ = 0.0;  ///< [s]
    std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();

    long outputs_ = 0;
    RunMeans means_;
};

}  // namespace cvtflow::tasks
