#pragma once
/// Steps with phases held: no events, no outputs, one thread. They measure the local error of a method, because no method has its order
/// across a transition.

#include <span>
#include <vector>

#include "engine/method/compiled_plan.hpp"
#include "model/variator/variator.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::bench {

class FrozenStepper {
public:
    /// `variator` and `phases` must outlive the stepper.
    FrozenStepper(const model::Variator& variator, const engine::StagePlan& plan, std::span<const model::Phase> phases);
    /// Holds the state constant unless it is disturbed: its drift is subtracted from every slope and time is held at t. The
    /// remaining equation, u' = f(t, y + u) - f(t, y), shows whether small disturbances decay. Nothing is linearised. t [s]
    void hold(double t, const std::vector<double>& state);
    /// Takes `steps` steps of length h from time t. @param state [layout.size()], replaced
    void advance(double t, double h, int steps, std::vector<double>& state);

private:
    void step(double t, double h);  ///< t [s], h [s]

    const model::Variator& variator_;
    const engine::CompiledPlan plan_;
    std::span<const model::Phase> phases_;
    std::vector<std::vector<double>> states_, slopes_;  ///< [slot][layout.size()]
    std::vector<double*> state_slots_, slope_slots_;
    std::vector<double> stage_;  ///< [unknowns]
    std::vector<double> drift_;  ///< [layout.size()] while a state is held, else empty
    double held_time_ = 0.0;     ///< [s]
    model::EvaluationScratch scratch_;
};

/// Error of one step, ‖y - reference‖/‖reference‖ (Euclidean) of four parts of the solution.
struct LocalError {
    double step = 0.0;         ///< [s]
    double positions = 0.0;    ///< coordinates of all links [1]
    double velocities = 0.0;   ///< velocities of all links
    double axial_force = 0.0;  ///< axial forces of all tips; 0 if none carries a force
    double tension = 0.0;      ///< tensions of all links
};

/// Distance of `state` from `reference`, both reached from `start` after time h. h [s]
[[nodiscard]] LocalError error_of(const model::Variator& variator, const tasks::FrozenStart& start, double h,
                                  const std::vector<double>& state, const std::vector<double>& reference);

/// Steps of the classical Runge-Kutta method that a reference takes over h: `refinement`, but none longer than 12.5 ns, a quarter of its
/// stable step at full detail.
[[nodiscard]] int reference_steps(double h, int refinement) noexcept;

/// The error of one step of `plan` from `start`, for each step length. The reference takes reference_steps() of the classical Runge-Kutta
/// method over the same time, so errors of methods up to order 4 are resolved to a part (1/refinement)^4. steps [s]
[[nodiscard]] std::vector<LocalError> local_errors(const model::Variator& variator, const engine::StagePlan& plan,
                                                   const tasks::FrozenStart& start, std::span<const double> steps, int refinement = 32);

}  // namespace cvtflow::bench
