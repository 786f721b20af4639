/// The part of StepController that watches the integration: samples of losses and energies, and the length of automatic steps.

#include <algorithm>
#include <cmath>
#include <limits>

#include "tasks/step/control/longest_step.hpp"
#include "tasks/step/control/step_controller.hpp"

namespace cvtflow::tasks {

namespace {

/// A new choice replaces a shorter step only where it is longer by this.
constexpr double worth_while = 1.05;

}  // namespace

/// Stages must lie at times of their own, and a step must move the time by what it says, to three digits.
Fault StepController::lost_in_rounding() const {
    const double shortest = 1e3 * std::numeric_limits<double>::epsilon() * std::abs(w_.step.time);
    if (grid_.step >= shortest) return {};
    return {FaultKind::step_too_short, w_.step.time, {}, grid_.step, shortest};
}

int StepController::start_observation() {
    state_ = State::observe;
    if (w_.layout().pulley_size != 0) w_.variator.pulleys().motions(w_.states[0] + w_.layout().pulley_begin(), w_.pulleys.observed_sheaves);
    return observe_cycle;
}

int StepController::finish_observation() {
    w_.energy.sample(w_.step.time, w_.observed_links(), w_.observed_pulleys(), w_.pin_period());
    return go_on();
}

/// Steps of the leg that begins: shorter ones as soon as they are needed, longer ones where it is worth while.
void StepController::choose_step() {
    if (settings_.control == StepControl::error) return;
    const double longest = std::min(method_.longest_step(longest_automatic_step(w_.parameters.detail.pins)),
                                    settings_.choice->longest(w_.step.time, w_.states[0], w_.tips.phases.data()));
    StepGrid next = grid_;
    next.divide(longest);
    const bool longer = next.step > grid_.step;
    if (longer && grid_.leg > 0) next.divide(longest / worth_while);
    if (!longer || next.step > grid_.step) grid_ = next;
    w_.step.dwell = dwell_steps * grid_.step;
}

}  // namespace cvtflow::tasks
