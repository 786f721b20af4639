#pragma once
/// One simulation of one scene: its start state, its step loop, its counters; and its slope as solvers outside know it. No global state;
/// any number may live side by side.

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/law/phase_rule.hpp"
#include "model/start/start_state.hpp"
#include "model/variator/variator.hpp"
#include "tasks/method/auto_step.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/schedule/integrator.hpp"
#include "tasks/step/control/step_controller.hpp"

namespace cvtflow::tasks {

/// A simulation cannot begin: the start state does not fit, the method is unknown.
class SimulationError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// End of a call of Simulation::advance().
struct Goal {
    double until = std::numeric_limits<double>::infinity();  ///< [s]
    long steps = 0;                       ///< maximum of further steps, besides run.max_steps, whose fault it shares; 0: no limit
    bool new_part = false;                ///< begins another part at the present time, with new output times and counters, settled or not
    std::optional<double> max_wall = {};  ///< replaces run.max_wall; 0: no budget [s]
    bool rows_between = false;            ///< from its begin on: of outputs_together(), the observer finds those between ends of steps
    const bool* pause = nullptr;          ///< ends before the next step once it is true, with a Fault of kind cancelled; set by an observer
};

/// The part of a simulation that is in progress, settling or the run: where it is, and where its next call continues.
class RunPart {
public:
    /// Both must outlive this; the scene may become another one between forget() and begin().
    RunPart(const Scene& scene, Integrator& integrator) noexcept;

    /// Forgets what has run. @param same_machine  whether the next part is one of the same machine: what chooses its steps may stay
    void forget(bool same_machine) noexcept;
    /// Begins at the workspace's state; nothing runs yet. time [s]
    /// @param settles  as needs_settling()   @param balance_error_ratio, residual  IntegrationState::settling_… of the settling before it
    void begin(double time, bool settles, double balance_error_ratio = 0.0, double residual = 0.0);
    /// Held inputs changed since the last step; expects a fast transient.
    void inputs_changed();

    // As those of Simulation.
    [[nodiscard]] Fault advance(const Goal& goal, RunObserver& observer, const engine::Cancellation& cancel);
    void restore(IntegrationState from);
    void move_offset();
    [[nodiscard]] const IntegrationState& integration_state() const;
    [[nodiscard]] bool needs_settling() const noexcept { return needs_settling_; }
    [[nodiscard]] double time() const noexcept { return time_; }  ///< [s]
    [[nodiscard]] double step() const noexcept { return step_; }  ///< [s]
    [[nodiscard]] double balance_error_ratio(const std::optional<EnergyMark>& from) const noexcept {
        return std::max(saved_.settling_balance_error_ratio, workspace_.energy.balance_error_ratio(from));
    }

    /// Zero where no step of this part has been taken yet.
    [[nodiscard]] const Counters& counters() const noexcept { return saved_.started ? counters_ : saved_.counters; }
    /// Counters of the part before, as long as no step of this one has been taken.
    [[nodiscard]] const Counters& last_counters() const noexcept { return counters_; }
    /// Local errors of the steps that last_counters() counts, if the scene asks for errors.
    [[nodiscard]] const LocalErrorStatistics& local_errors() const noexcept { return local_errors_; }
    /// Choice of automatic steps, with its last estimate; nullptr: run.step is given.
    [[nodiscard]] const AutoStep* step_choice() const noexcept { return choice_.get(); }
    /// RunSettings::outputs_together() with leapfrogs; other methods end steps at all outputs.
    [[nodiscard]] long outputs_together() const noexcept;

private:
    [[nodiscard]] StepSettings settings_of(const Goal& goal) const;
    [[nodiscard]] Fault drive();
    void end_settling();
    void forget_controller() noexcept;

    const Scene& scene_;
    Integrator& integrator_;
    Workspace& workspace_;              ///< the integrator's
    std::unique_ptr<AutoStep> choice_;  ///< nullptr: run.step is given
    bool needs_settling_ = false;
    double time_ = 0.0;  ///< [s]
    double step_ = 0.0;  ///< [s]
    Counters counters_;
    LocalErrorStatistics local_errors_;
    mutable IntegrationState saved_;                    ///< state at the next call, except for what controller_ has
    mutable bool rest_known_ = true;                    ///< saved_ is up to date
    mutable std::optional<StepController> controller_;  ///< controller of the last call, if the next one may continue with it
    double paused_wall_ = 0.0;                          ///< wall time of the calls since the last that did not end in a pause [s]
};

class Simulation {
public:
    /// Prepares the start state: from the scene's state file if that fits the machine (start_fits), else geometric. Nothing runs yet.
    /// @throws SimulationError, engine::RecordError (state file), std::invalid_argument (the chain does not close)
    explicit Simulation(const Scene& scene);
    /// Prepares the start state for a given schedule and, optionally, time stamps of its tasks.
    /// @param start begins there; neither reads a state nor places a chain. nullptr: prepares it
    Simulation(const Scene& scene, const Schedule& schedule, engine::StampRecorder* recorder = nullptr,
               const model::StartState* start = nullptr);
    /// Prepares the start state for schedules to choose from while it runs, serial first (see ScheduleChooser).
    Simulation(const Scene& scene, const std::vector<Schedule>& candidates, const ChooserOptions& options,
               engine::StampRecorder* recorder = nullptr, const model::StartState* start = nullptr);
    Simulation(const Simulation&) = delete;

    /// Becomes a simulation of another scene that fits(), in the memory of this one; bit for bit as a new one.
    /// @param saved the state to start from, instead of the scene's file; nullptr, or one that does not fit: geometric start
    /// @param placed that start, if it has been made already
    /// @throws as the constructor
    void reset(const Scene& scene, const engine::SavedState* saved, const model::StartState* placed = nullptr);

    /// Whether the start is geometric and has to settle before t = 0.
    [[nodiscard]] bool needs_settling() const noexcept { return part_.needs_settling(); }
    /// Continues from the present state: that of the last call, of restore(), or the start. A geometric start settles first, from t =
    /// -start.settling_time to t = 0 with clamping and load ramped up: that is a separate part, with outputs at negative times, and the
    /// call ends with it in any case. Where calls end does not change a bit of what follows. Ends with the first step at or after the
    /// goal's time, or with a Fault.
    [[nodiscard]] Fault advance(const Goal& goal, RunObserver& observer, const engine::Cancellation& cancel) {
        return part_.advance(goal, observer, cancel);
    }
    /// Puts values in place of the tables of inputs, between runs. A fast transient may follow.
    void hold(const model::HeldInputs& held) {
        workspace_->variator.hold(held);
        part_.inputs_changed();
    }

    /// The present integration state, which is written when it is read.
    [[nodiscard]] const IntegrationState& integration_state() const { return part_.integration_state(); }
    /// Takes an integration_state() of a simulation of the same scene and method, in whatever process.
    /// @throws SimulationError if the numbers of unknowns or tips differ; engine::ArchiveError for other fields
    void restore(IntegrationState state) { part_.restore(std::move(state)); }

    /// The part in progress: settling, or the run.
    [[nodiscard]] const RunPart& part() const noexcept { return part_; }
    /// Method, schedule and graph at present, and how schedules have come and gone.
    [[nodiscard]] const Integrator& integrator() const noexcept { return *integrator_; }
    /// State, phases, model and energies of the present part.
    [[nodiscard]] const Workspace& workspace() const noexcept { return *workspace_; }
    [[nodiscard]] double time() const noexcept { return part_.time(); }
    /// Counters of the present part, or of the last one: settling, or the run.
    [[nodiscard]] const Counters& counters() const noexcept { return part_.last_counters(); }
    /// The largest EnergyLedger::balance_error_ratio() of settling and run: above 1 the results are wrong.
    /// @param from mark from which on the run counts
    [[nodiscard]] double balance_error_ratio(const std::optional<EnergyMark>& from = {}) const noexcept {
        return part_.balance_error_ratio(from);
    }
    /// false: keeps no energies from the next run on, for measurements of what that costs.
    void keep_energies(bool on) noexcept { workspace_->energy.keep(on); }
    /// The method of its steps: run.method, or what that is where it is "auto".
    [[nodiscard]] const Method& method() const noexcept { return integrator_->chosen_method(); }
    /// Step in use in the last run [s].
    [[nodiscard]] double step() const noexcept { return part_.step(); }
    /// Hash of state and phases: equal for every number of segments, threads and schedule.
    [[nodiscard]] std::uint64_t hash() const noexcept;
    /// Differences between this scene and the one that the state file was settled with, one line each, and whether the state therefore was
    /// not taken; empty if none.
    [[nodiscard]] const std::vector<std::string>& start_differences() const noexcept { return start_differences_; }

    /// Moves the present correction of the proportional part into the integral part, with control.gains = "found".
    void move_offset() { part_.move_offset(); }
    /// The present state as a file for start.state.
    [[nodiscard]] engine::SavedState saved_state() const;

private:
    void begin_with(const engine::SavedState* saved, const model::StartState* placed);

    Scene scene_;
    std::unique_ptr<Integrator> integrator_;
    Workspace* workspace_;  ///< the integrator's
    RunPart part_;
    std::vector<std::string> start_differences_;
    /// Misfit of the last saved start in this machine: cases of a sweep often share both.
    struct CheckedStart {
        std::uint64_t hash = 0;  ///< hash of the saved start
        double misfit = 0.0;
    };
    std::optional<CheckedStart> checked_start_;
};

/// Whether reset() may be used: the same unknowns and the same method.
[[nodiscard]] bool fits(const Simulation& simulation, const Scene& scene);
/// The automatic step at the present state, independent of run.step [s].
[[nodiscard]] double automatic_step(const Simulation& simulation);
/// The largest step that is stable and accurate for the method at the present state. Takes a hundred evaluations.
[[nodiscard]] LargestStep largest_step(const Simulation& simulation);

/// The right-hand side as a function of time and unknowns alone. Serial; owns the memory of one evaluation.
class PlainSlope {
public:
    /// Both must outlive this.
    PlainSlope(const model::Variator& variator, const model::PhaseRule& rule);

    /// out = dx/dt. Phases are those of the moment: a tip that penetrates touches, any other is free; no hysteresis. The contact law is
    /// continuous at depth zero, so out is continuous in x. @param x, out [layout.size()], not the same
    void operator()(double t, const double* x, double* out) noexcept;

private:
    const model::Variator& variator_;
    const model::PhaseRule& rule_;
    model::EvaluationScratch scratch_;
    std::vector<model::Phase> phases_;  ///< [4 links]
};

/// One line on an energy balance that does not close, with what to do about it. @param balance_error_ratio
/// EnergyLedger::balance_error_ratio(), above 1
/// @param setting run.step   @param step the last one that was chosen [s]
[[nodiscard]] std::string unreliable_text(double balance_error_ratio, const AutoNumber& setting, double step);
/// @param step  largest stable one of the method [s]
[[nodiscard]] std::string stable_text(const std::string& method, double step);

}  // namespace cvtflow::tasks
