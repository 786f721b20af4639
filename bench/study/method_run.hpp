#pragma once
/// Runs of any method by its name, from any state, to compare methods.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/study/stability/frozen_step.hpp"
#include "tasks/method/auto_step.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/schedule/schedule.hpp"
#include "tasks/step/control/step_controller.hpp"

namespace cvtflow::bench {

/// A run with transitions, as `cvtflow run` would do it, from a state in memory. Unlike a Simulation it can begin again.
class MethodRun {
public:
    /// @throws std::invalid_argument for an unknown method, or one that cannot be used with the scene
    MethodRun(const model::Parameters& parameters, const std::string& method, const tasks::Schedule& schedule = {});
    ~MethodRun();
    MethodRun(const MethodRun&) = delete;
    MethodRun& operator=(const MethodRun&) = delete;

    /// Runs from `start` over `duration`: a multiple of the output interval, itself a multiple of the step.
    /// @param step 0: automatic (AutoStep) [s]
    [[nodiscard]] tasks::Fault run(const tasks::FrozenStart& start, double duration, double step, double output_interval,
                                   tasks::RunObserver& observer, const engine::Cancellation& cancel);
    /// Counters of the last run.
    [[nodiscard]] const tasks::Counters& counters() const noexcept { return counters_; }
    /// End of the last run [s].
    [[nodiscard]] double time() const noexcept { return integrator_.workspace().step.time; }
    /// Step in use at the end of the last run [s].
    [[nodiscard]] double step() const noexcept { return step_; }
    [[nodiscard]] const tasks::Workspace& workspace() const noexcept { return integrator_.workspace(); }
    [[nodiscard]] const tasks::StepMethod& method() const noexcept { return integrator_.method(); }

private:
    tasks::Integrator integrator_;
    tasks::Counters counters_;
    double step_ = 0.0;                        ///< [s]
    std::unique_ptr<tasks::AutoStep> choice_;  ///< choice of the automatic step, once one was requested
};

/// Local errors of any method. A table of stages takes its step with phases held. A program takes it as it does in a run, and so
/// does the reference then; across a transition no method has its order, so a step within which one happens is left out: its errors are
/// NaN, as are those of a step that failed. steps [s]
[[nodiscard]] std::vector<LocalError> local_errors(const model::Parameters& parameters, const std::string& method,
                                                   const tasks::FrozenStart& start, std::span<const double> steps);

}  // namespace cvtflow::bench
