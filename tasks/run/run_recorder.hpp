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

/// Means of channels over the time since the output before, by the trapezoidal rule over samples. Without columns it does nothing.
class OutputMeans {
public:
    OutputMeans() = default;
    /// @param averaged columns of which means are taken
    explicit OutputMeans(std::vector<bool> averaged) : averaged_(std::move(averaged)), before_(averaged_.size()), sum_(averaged_.size()) {}

    [[nodiscard]] bool on() const noexcept { return !averaged_.empty(); }
    /// Values of all columns at a time between outputs, or at one [s].
    void add(double time, std::span<const double> row);
    /// Replaces values by means at an output, which has been added; the next mean begins there.
    void take(std::span<double> row);
    void visit(engine::Archive& archive);

private:
    std::vector<bool> averaged_;
    double begin_ = 0.0, last_ = 0.0;  ///< times of the begin of the mean and of the latest sample [s]
    bool any_ = false;
    std::vector<double> before_, sum_;  ///< [columns]: values [unit of the channel], integrals [unit s]
};

class RunRecorder final : public RunObserver {
public:
    RunRecorder(const Scene& scene, const Simulation& simulation, const RunOptions& options);

    void output(double time, const Workspace& workspace, const Counters& counters) override;  ///< time [s]
    [[nodiscard]] bool samples(double time) const noexcept override { return begin_ >= 0.0 && means_.curve().due(time); }
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
    void read(const Instant& instant);                    ///< the channels into the row
    void write(double time, const Workspace& workspace);  ///< time [s]

    const RunOptions& options_;
    double state_interval_;  ///< [s]
    int followed_pin_;
    bool has_pulleys_;
    model::Observer observer_;
    std::vector<const Channel*> channels_;
    std::vector<double> row_;  ///< one number per column of the channels [columns]
    OutputMeans output_means_;
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
