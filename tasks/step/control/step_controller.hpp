#pragma once
/// The integration as a controller: between two cycles of the task graph it closes what the segments leave open (pulleys), accepts, rejects
/// or cuts the step, and names the next cycle. The whole run happens inside one Executor::run(). integrate() shows a step from top to
/// bottom. ErrorControl estimates the local errors of steps and, where they decide, the length of the next step; TransitionSearch cuts
/// steps.

#include <chrono>
#include <optional>
#include <vector>

#include "engine/executor/cancellation.hpp"
#include "engine/executor/executor.hpp"
#include "tasks/step/control/cycle_sequence.hpp"
#include "tasks/step/control/run_observer.hpp"
#include "tasks/step/control/step_control.hpp"
#include "tasks/step/control/step_grid.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/step_method.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

class ErrorControl {
public:
    /// @throws std::invalid_argument if errors are requested and the method estimates none
    ErrorControl(Workspace& workspace, const StepMethod& method, const StepSettings& settings);

    /// Whether the error decides the length of steps.
    [[nodiscard]] bool decides() const noexcept { return decides_; }
    /// Sets the row that estimates the error in the next detect cycle.
    void prepare(const StepMethod& method) const;
    /// Whether the detected step is accurate enough. A step that is retaken up to a transition always is.
    [[nodiscard]] bool accepts(bool retaken);
    /// Proposed length of the next step [s].
    [[nodiscard]] double proposal() const noexcept { return size_.proposal(); }
    [[nodiscard]] const LocalErrorStatistics& statistics() const noexcept { return statistics_; }

    void visit(engine::Archive& archive) {
        if (decides_) size_.visit(archive);
    }

private:
    [[nodiscard]] double step_error() const;

    Workspace& w_;
    bool estimates_, decides_;
    double tolerance_;  ///< tolerance in units of ErrorScale
    StepSizeControl size_;
    LocalErrorStatistics statistics_;
};

/// The serial part of finding and carrying out transitions, between detect, locate and truncate cycles.
class TransitionSearch {
public:
    TransitionSearch(Workspace& workspace, StepMethod& method);

    /// Computes the pulleys' part of the step's result, for a detect cycle.
    void prepare_detection();
    /// Finds the first fault in the result of a detect cycle, and whether a tip may change its phase (due()). Adds to counters.suppressed.
    [[nodiscard]] Fault check(Counters& counters);
    [[nodiscard]] bool due() const noexcept { return due_; }
    /// Slopes of the links at the step's start, which locate and truncate cycles interpolate. Only few steps need them.
    void complete_start_slopes();
    /// Begins and ends an evaluate cycle for the slope at the step's end. @return the cycle
    [[nodiscard]] int prepare_end_slope();
    void close_end_slope();
    /// Takes the earliest transition of all segments as the place of the cut, after a locate cycle; false if none lies within the step.
    [[nodiscard]] bool locate();
    /// Computes the pulleys at the cut, for a truncate cycle. @return the cycle
    [[nodiscard]] int prepare_truncation();
    /// Makes the state at the cut the current one, after a truncate cycle. Reports every tip that has changed to `observer`.
    void truncate(RunObserver& observer, Counters& counters);
    /// Reports every tip that differs from tips.phases_before to `observer`.
    void report_changes(RunObserver& observer, Counters& counters);

private:
    Workspace& w_;
    StepMethod& method_;
    bool due_ = false;
};

struct IntegrationState;

class StepController final : public engine::Controller {
public:
    /// The workspace's slot 0 and phases hold the start state. `cancel` may be set from anywhere, also from a signal handler.
    /// @param from resumes that integration, whose state the workspace holds (Simulation::restore), and whose begin and grid apply;
    /// nullptr: a new one begins
    /// @throws std::invalid_argument if errors are requested and the method has no estimate
    StepController(Workspace& workspace, StepMethod& method, const StepSettings& settings, RunObserver& observer,
                   const engine::Cancellation& cancel, const IntegrationState* from = nullptr);

    /// Continues where the last run of this controller ended, without a fault or by one that a goal or a caller set; bitwise as a new one
    /// that resumes from save(). @param settings those of the beginning, but for end, budgets and pause
    void resume(const StepSettings& settings, RunObserver& observer, const engine::Cancellation& cancel);

    [[nodiscard]] int next() noexcept override { return integration_->next(); }
    /// State of the integration once next() has returned stop. Allocates nothing if `state` has held one of the same size before.
    void save(IntegrationState& state);

    [[nodiscard]] const Fault& fault() const noexcept { return integration_->fault(); }
    [[nodiscard]] const Counters& counters() const noexcept { return counters_; }
    [[nodiscard]] double time() const noexcept { return w_.step.time; }
    /// Step in use: settings.step, or what was chosen, or a little less, so that it divides the output interval; the longest one if the
    /// error decides [s].
    [[nodiscard]] double step() const noexcept { return settings_.control == StepControl::error ? settings_.step : grid_.step; }
    [[nodiscard]] const LocalErrorStatistics& local_errors() const noexcept { return errors_.statistics(); }
    /// Memory of the workspace, kept from one run to the next.
    [[nodiscard]] FrameMemory* frame_memory() const noexcept { return &w_.frame; }
    /// Rethrows what the observer threw.
    void rethrow() const { integration_->rethrow(); }

private:
    /// Minimum time between two changes of a tip's phase, in steps: one whole step, whatever rounding does.
    static constexpr double dwell_steps = 1.5;

    /// IntegrationState::method
    void visit(engine::Archive& archive);
    [[nodiscard]] CycleSequence integrate();
    [[nodiscard]] bool prepare_observation() noexcept;
    [[nodiscard]] Fault check_budget() const;
    [[nodiscard]] bool deliver_output();
    void plan_step();
    void choose_step();
    void propose_step();
    [[nodiscard]] Fault reject();
    void accept();
    void truncate();

    Workspace& w_;
    StepMethod& method_;
    StepSettings settings_;
    RunObserver* observer_;
    const engine::Cancellation* cancel_;
    StepGrid grid_;
    ErrorControl errors_;
    TransitionSearch transitions_;
    bool reaches_grid_point_ = true;  ///< the proposed step ends at the next grid point
    long outputs_ = 0;                ///< outputs delivered
    Counters counters_;
    std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
    std::optional<CycleSequence> integration_;
};

}  // namespace cvtflow::tasks
