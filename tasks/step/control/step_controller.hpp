#pragma once
/// The integration as a controller: called between cycles, it closes what the segments have left open (pulleys), decides on acceptance or
/// truncation, and names the next cycle. The whole run happens inside one Executor::run().
///
///     method's cycles ─► detect ─► accept ──────────────────────────────► next step
///                           └─► evaluate (end) ─► locate ─► truncate ─► next step from the cut
///                           └─► locate ─► method's cycles up to the cut ─► detect ─► truncate   (methods that retake)

#include <chrono>
#include <exception>
#include <memory>

#include "engine/executor/cancellation.hpp"
#include "engine/executor/executor.hpp"
#include "tasks/step/control/step_choice.hpp"
#include "tasks/step/control/step_grid.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/step_method.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// What happened so far. All monotone.
struct Counters {
    long steps = 0;        ///< accepted, truncated ones included
    long evaluations = 0;  ///< of the right-hand side
    long detected = 0;     ///< transitions carried out
    long truncated = 0;    ///< steps cut at a transition
    long suppressed = 0;   ///< transitions put off because the tip had just changed
    long rejected = 0;     ///< steps taken again because of their error
    bool operator==(const Counters&) const = default;
};

/// One change of a tip's phase, as recorded.
struct TransitionRecord {
    double time;  ///< [s]
    int pin;      ///< link's rear pin + end
    int tip;      ///< 4 link + 2 end + side
    model::Phase from, to;
};

/// Called by the controller, serially, while the graph rests. May throw: the run then ends and the exception reaches its caller.
class RunObserver {
public:
    virtual ~RunObserver() = default;
    /// At every output time, the first one included. The state is that of the workspace's slot 0.
    virtual void output(double time, const Workspace& workspace, const Counters& counters) = 0;
    /// After each truncated step, for every tip that changed.
    virtual void transition(const TransitionRecord& record) = 0;

protected:
    RunObserver() = default;
    RunObserver(const RunObserver&) = default;
    RunObserver& operator=(const RunObserver&) = default;
};

struct IntegrationState;

/// Takes no notice.
class SilentObserver final : public RunObserver {
public:
    void output(double, const Workspace&, const Counters&) override {}
    void transition(const TransitionRecord&) override {}
};

struct StepSettings {
    double begin = 0.0;  ///< [s]
    double until = 0.0;  ///< [s]
    double step = 5e-8;  ///< longest step [s]; a fixed step divides the output interval. 0: automatic, and `choice` must be there
    double output_interval = 1e-5;  ///< [s]
    long max_steps = 0;             ///< 0: no budget
    double max_wall = 0.0;          ///< [s], 0: no budget
    StepControl control = StepControl::fixed;
    double tolerance = 1.0;        ///< of local errors, in units of ErrorScale [1]
    StepChoice* choice = nullptr;  ///< what chooses automatic steps; outlives the controller
    const bool* pause = nullptr;   ///< if it becomes true (an observer's wish), the run ends before the next step as if cancelled

    [[nodiscard]] bool automatic() const noexcept { return choice != nullptr && step == 0.0; }
};

/// Local errors of accepted steps, in units of ErrorScale; only with StepControl::report and error.
struct LocalErrorStatistics {
    long steps = 0;
    double largest = 0.0;  ///< [1]
    double sum = 0.0;      ///< [1]

    [[nodiscard]] double mean() const noexcept { return steps > 0 ? sum / static_cast<double>(steps) : 0.0; }
};

class StepController final : public engine::Controller {
public:
    /// The workspace's slot 0 and phases hold the start state. `cancel` may be set from anywhere, also from a signal handler.
    /// @throws std::invalid_argument if errors are asked for and the method estimates none
    StepController(Workspace& workspace, StepMethod& method, const StepSettings& settings, RunObserver& observer,
                   const engine::Cancellation& cancel);
    /// A controller with the workspace's table of stages as method.
    StepController(Workspace& workspace, const StepSettings& settings, RunObserver& observer, const engine::Cancellation& cancel);

    /// Goes on from where an integration stood. Workspace and `from` hold the same state (Simulation::restore); settings.begin and the grid
    /// are those of `from`.
    StepController(Workspace& workspace, StepMethod& method, const StepSettings& settings, const IntegrationState& from,
                   RunObserver& observer, const engine::Cancellation& cancel);

    [[nodiscard]] int next() noexcept override;
    /// Where the integration stands, once next() has said stop. Allocates nothing if `state` has held one of the same size before.
    void save(IntegrationState& state) const;

    [[nodiscard]] const Fault& fault() const noexcept { return fault_; }
    [[nodiscard]] const Counters& counters() const noexcept { return counters_; }
    [[nodiscard]] double time() const noexcept { return w_.step.time; }
    /// Step in use: settings.step, or what was chosen, or a little less, so that it divides the output interval; the longest one if the
    /// error decides [s].
    [[nodiscard]] double step() const noexcept { return settings_.control == StepControl::error ? settings_.step : grid_.step; }
    [[nodiscard]] const LocalErrorStatistics& local_errors() const noexcept { return local_errors_; }
    /// Rethrows what the observer threw.
    void rethrow() const;

private:
    /// @param own the method, or nullptr where somebody else owns `method`
    StepController(Workspace& workspace, std::unique_ptr<StepMethod> own, StepMethod* method, const StepSettings& settings,
                   RunObserver& observer, const engine::Cancellation& cancel);

    /// Longest time a freshly changed tip keeps its phase, in steps: one whole step, whatever rounding says.
    static constexpr double dwell_steps = 1.5;  ///< [1]

    enum class State { begin_step, observe, method, detect, end_slope, locate, truncate };

    int begin_step();
    int start_observation();
    int finish_observation();
    int go_on();
    int start_step();
    void choose_step();
    int reject();
    [[nodiscard]] double step_error();
    int take(NextCycle next);
    int start_detect();
    int finish_detect();
    int start_end_slope();
    int start_locate();
    int finish_locate();
    int retake();
    int start_truncate();
    int finish_truncate();
    int accept();
    int end(Fault fault);
    void make_secants();
    void make_start_secants();
    void record_transitions();
    [[nodiscard]] Fault budget() const;
    [[nodiscard]] Fault lost_in_rounding() const;
    void probe_start();

    Workspace& w_;
    std::unique_ptr<StepMethod> own_method_;
    StepMethod& method_;
    StepSettings settings_;
    RunObserver& observer_;
    const engine::Cancellation& cancel_;
    State state_ = State::begin_step;
    bool retaking_ = false;  ///< the step at hand ends at a transition that has been located
    long outputs_ = 0;       ///< outputs delivered
    StepGrid grid_;
    bool lands_ = true;  ///< the step at hand ends at the next grid point
    StepSizeControl control_;
    LocalErrorStatistics local_errors_;
    Counters counters_;
    Fault fault_;
    std::exception_ptr thrown_;
    std::vector<model::Phase> phases_before_;
    std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
};

}  // namespace cvtflow::tasks
