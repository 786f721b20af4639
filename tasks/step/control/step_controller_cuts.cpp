/// The part of StepController that cuts steps at transitions.

#include <algorithm>

#include "tasks/step/control/step_controller.hpp"

namespace cvtflow::tasks {

int StepController::start_locate() {
    state_ = State::locate;
    return locate_cycle;
}

int StepController::finish_locate() {
    Transition first;
    for (const Verdict& verdict : w_.verdicts) {
        if (verdict.first.theta < first.theta) first = verdict.first;
    }
    if (first.theta > 1.0) return accept();
    w_.step.theta = first.theta;
    w_.step.due = first;
    return method_.retakes() && first.theta > 0.0 ? retake() : start_truncate();
}

/// The step once more, only up to the transition.
int StepController::retake() {
    retaking_ = true;
    w_.step.h *= w_.step.theta;
    w_.step.theta = 1.0;
    return take(method_.begin());
}

int StepController::start_truncate() {
    state_ = State::truncate;
    std::copy(w_.tips.phases.begin(), w_.tips.phases.end(), phases_before_.begin());
    const model::ChainLayout& at = w_.layout();
    w_.interpolant().evaluate(w_.step.theta, at.pulley_begin(), at.size(), w_.cut_state + at.pulley_begin());
    w_.variator.pulleys().motions(w_.cut_state + at.pulley_begin(), w_.pulleys.sheaves);
    return truncate_cycle;
}

void StepController::record_transitions() {
    for (std::size_t tip = 0; tip < w_.tips.phases.size(); ++tip) {
        if (w_.tips.phases[tip] == phases_before_[tip]) continue;
        const int number = static_cast<int>(tip);
        const int pin = (number / 4 + number / 2 % 2) % w_.layout().links;
        ++counters_.detected;
        observer_.transition({w_.step.time, pin, number, phases_before_[tip], w_.tips.phases[tip]});
    }
}

int StepController::finish_truncate() {
    const double begin = w_.step.time;
    w_.step.time += w_.step.theta * w_.step.h;
    w_.energy.step(w_.variator, begin, w_.states[0] + w_.layout().pulley_begin(), w_.step.time, w_.cut_state + w_.layout().pulley_begin());
    std::swap(w_.states[0], w_.cut_state);
    std::swap(w_.tips.before, w_.tips.after);
    ++counters_.truncated;
    ++counters_.steps;
    method_.transition();
    w_.list_touching();
    record_transitions();
    return begin_step();
}

}  // namespace cvtflow::tasks
