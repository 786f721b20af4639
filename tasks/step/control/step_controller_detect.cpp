#include <algorithm>
#include <cmath>

#include "tasks/step/control/step_controller.hpp"

namespace cvtflow::tasks {

int StepController::start_detect() {
    state_ = State::detect;
    const model::ChainLayout& at = w_.layout();
    engine::combine(w_.step.row, w_.step.h, w_.slots(), at.pulley_begin(), at.size(), w_.end_state + at.pulley_begin());
    if (at.pulley_size != 0) w_.variator.pulleys().motions(w_.end_state + at.pulley_begin(), w_.pulleys.end_sheaves);
    if (w_.step.secant) make_secants();
    if (w_.step.estimate_error) w_.step.error_row = *method_.error_row();
    return detect_cycle;
}

/// Slopes behind the links at both ends of a step from its states there: velocities, and one mean acceleration.
void StepController::make_secants() {
    const model::ChainLayout& at = w_.layout();
    const int begin = at.pulley_begin();
    const int half = at.pulley_size;
    for (int k = begin; k < at.size(); ++k) {
        const double mean = (w_.end_state[k] - w_.states[0][k]) / w_.step.h;
        const bool position = k < begin + half;
        w_.slopes[0][k] = position ? w_.states[0][k + half] : mean;
        w_.end_slope[k] = position ? w_.end_state[k + half] : mean;
    }
}

/// The same of links at the step's start: what locating and cutting read. Few steps need it, so that it is not made in every detect cycle.
void StepController::make_start_secants() {
    const model::ChainLayout& at = w_.layout();
    const int half = at.link_size();
    for (int link = 0; link < at.links; ++link) {
        const int begin = at.link_begin(link);
        std::copy_n(w_.states[0] + begin + half, half, w_.slopes[0] + begin);
        std::copy_n(w_.end_slope + begin + half, half, w_.slopes[0] + begin + half);
    }
}

int StepController::finish_detect() {
    bool pending = false;
    const double error = w_.step.estimate_error && !retaking_ ? step_error() : 0.0;
    if (settings_.control == StepControl::error && !control_.judge(error / settings_.tolerance, w_.step.h)) return reject();
    if (w_.step.estimate_error && !retaking_) {
        ++local_errors_.steps;
        local_errors_.sum += error;
        local_errors_.largest = std::max(local_errors_.largest, error);
    }
    const double* tail = w_.end_state + w_.layout().pulley_begin();
    for (int k = 0; k < w_.tail_size(); ++k) {
        if (!std::isfinite(tail[k])) return end({FaultKind::non_finite, w_.step.time + w_.step.h, {}, 0.0, 0.0});
    }
    for (const Verdict& verdict : w_.verdicts) {
        if (verdict.fault) return end(verdict.fault);
        counters_.suppressed += verdict.suppressed;
        pending = pending || verdict.pending;
    }
    if (!retaking_ && !pending) return accept();
    if (w_.step.secant) make_start_secants();
    if (retaking_) return start_truncate();
    return method_.retakes() ? start_locate() : start_end_slope();
}

}  // namespace cvtflow::tasks
