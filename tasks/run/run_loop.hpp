#pragma once
/// The loop of runs and of cases: settling, then the run, with pauses at outputs, until its goal or until its means are steady.

#include <chrono>

#include "tasks/run/checkpoint.hpp"
#include "tasks/run/run_means.hpp"
#include "tasks/run/run_recorder.hpp"

namespace cvtflow::tasks {

/// Reasons to pause a run at an output: a checkpoint, a request to stop.
class Pauses {
public:
    virtual ~Pauses() = default;
    /// Whether the run pauses here; asked at every output. time [s]
    [[nodiscard]] virtual bool due(double time, const Counters& counters) = 0;
    /// Does between two steps what the pause is for. false: the run ends, as if it were cancelled.
    [[nodiscard]] virtual bool pass() = 0;

protected:
    Pauses() = default;
    Pauses(const Pauses&) = default;
    Pauses& operator=(const Pauses&) = default;
};

/// End of a run.
struct RunEnd {
    double time;    ///< infinite where it ends when its means are steady [s]
    double latest;  ///< latest possible end [s]
};
[[nodiscard]] RunEnd end_of(const Scene& scene);

/// Settles a simulation and runs it from its present state.
class RunLoop final : private RunObserver {
public:
    /// All must outlive the loop. @param history  settling and wall times of the run, which the loop continues
    /// @param means  end the run where they are steady   @param observer  sees outputs, samples and transitions after the recorder
    RunLoop(Simulation& simulation, RunHistory& history, const RunMeans& means, Pauses& pauses, RunObserver& observer,
            const engine::Cancellation& cancel)
        : simulation_(simulation), history_(history), means_(means), pauses_(pauses), observer_(observer), cancel_(cancel) {}

    /// Records outputs; nullptr: none.
    void record(RunRecorder* recorder) noexcept { recorder_ = recorder; }
    /// Settles from the present state on, if the start needs it. @param from begin of settling, negative [s]
    [[nodiscard]] Fault settle(double from);
    /// Runs from the present state to the end.
    [[nodiscard]] Fault run(const RunEnd& end);

private:
    [[nodiscard]] Fault part(double until, double& wall);
    [[nodiscard]] bool sheave_due() const noexcept;  ///< whether control ends, and the sheave is held (control.when_steady)
    void hold_sheave();
    void output(double time, const Workspace& workspace, const Counters& counters) override;
    [[nodiscard]] bool samples(double time) const noexcept override;
    void sample(double time, const Workspace& workspace, const Counters& counters) override;
    void transition(const TransitionRecord& record) override;

    Simulation& simulation_;
    RunHistory& history_;
    const RunMeans& means_;
    Pauses& pauses_;
    RunObserver& observer_;
    const engine::Cancellation& cancel_;
    RunRecorder* recorder_ = nullptr;
    bool pause_ = false;
};

}  // namespace cvtflow::tasks
