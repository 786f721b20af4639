#pragma once
/// The largest stable step, found by taking steps: what the spectrum predicts, confirmed without it.

#include "engine/method/stage_plan.hpp"
#include "model/variator/variator.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::bench {

struct MeasuredStep {
    double stable = 0.0;    ///< longest step tried with which a small disturbance died out [s]
    double unstable = 0.0;  ///< shortest step tried with which it grew [s]; 0: none did, the limit is beyond
    long evaluations = 0;   ///< of the right-hand side
    [[nodiscard]] double limit() const noexcept { return unstable > 0.0 ? 0.5 * (stable + unstable) : stable; }
};

/// Whether a disturbance of all velocities by ± 1e-9 m/s (so little that hardly a contact comes to the kink of its law) grows in `steps`
/// steps about the held state: twofold in their second half, or a thousandfold in all, beyond what it does by itself.
/// @param natural_growth largest positive real part in the spectrum, or 0 [1/s]
[[nodiscard]] bool disturbance_grows(const model::Variator& variator, const engine::StagePlan& plan, const tasks::FrozenStart& start,
                                     double h, int steps, double natural_growth = 0.0);

/// Brackets the limit to 0.5 % between 0.6 and 1.6 times `expected`, with up to 2000 steps per trial, fewer for methods of many stages.
/// @param expected > 0 [s]
[[nodiscard]] MeasuredStep measured_stable_step(const model::Variator& variator, const engine::StagePlan& plan,
                                                const tasks::FrozenStart& start, double expected, double natural_growth = 0.0);

}  // namespace cvtflow::bench
