#pragma once
/// The part of a simulation that is in progress, settling or the run: where it is, and where its next call continues.

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

#include "tasks/method/auto_step.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/schedule/integrator.hpp"
#include "tasks/step/control/step_controller.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::tasks {

/// End of a call of Simulation::advance().
struct Goal {
    double until = std::numeric_limits<double>::infinity();  ///< [s]
    long steps = 0;  ///< at most this many further steps, in addition to run.max_steps: ends with a Fault of kind max_steps; 0: no limit
    bool new_part = false;  ///< begins another part at the present time, with output times and counters of its own, settled or not
    std::optional<double> max_wall = {};  ///< in place of run.max_wall [s], 0: no budget
    const bool* pause = nullptr;          ///< ends before the next step once it is true, with a Fault of kind cancelled; set by an observer
};

class RunPart {
public:
    /// Both must outlive this; the scene may become another one between forget() and begin().
    RunPart(const Scene& scene, Integrator& integrator) noexcept;

    /// Forgets what has run. @param same_machine  whether the next part is one of the same machine: what chooses its steps may stay
    void forget(bool same_machine) noexcept;
    /// Begins at the workspace's state; nothing runs yet. time [s]
    /// @param settles  as needs_settling()   @param balance_error_ratio, residual  IntegrationState::settling_… of the settling before it
    void begin(double time, bool settles, double balance_error_ratio = 0.0, double residual = 0.0);
    /// Held inputs are not those of the last step: what follows may be fast.
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
    /// Likewise, if the scene asks for errors.
    [[nodiscard]] const LocalErrorStatistics& local_errors() const noexcept { return local_errors_; }
    /// Choice of automatic steps, with its last estimate; nullptr: run.step is given.
    [[nodiscard]] const AutoStep* step_choice() const noexcept { return choice_.get(); }

private:
    [[nodiscard]] StepSettings settings_of(const Goal& goal) const;
    [[nodiscard]] Fault drive();
    void end_settling();
    void forget_controller() noexcept;

    const Scene& scene_;
    Integrator& integrator_;
    Workspace& workspace_;              ///< the integrator's
    std::unique_ptr<AutoStep> choice_;  ///< of automatic steps
    bool needs_settling_ = false;
    double time_ = 0.0;  ///< [s]
    double step_ = 0.0;  ///< [s]
    Counters counters_;
    LocalErrorStatistics local_errors_;
    mutable IntegrationState saved_;            ///< where the next call begins, but for what controller_ knows
    mutable bool rest_known_ = true;            ///< saved_ is that of now
    std::optional<StepController> controller_;  ///< of the last call, if the next one may continue with it
    double paused_wall_ = 0.0;                  ///< of the calls since the last that did not end in a pause [s]
};

}  // namespace cvtflow::tasks
