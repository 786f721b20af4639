#include "tasks/step/control/transition_search.hpp"

#include <algorithm>
#include <cmath>

#include "tasks/step/assembly/segment_tasks.hpp"
#include "tasks/step/step_graph.hpp"

namespace cvtflow::tasks {

TransitionSearch::TransitionSearch(Workspace& workspace, StepMethod& method) : w_(workspace), method_(method) {
    w_.step.at_transition = method.at_transition();
}

void TransitionSearch::prepare_detection() {
    const model::ChainLayout& at = w_.layout();
    close_tail(w_);
    if (at.pulley_size != 0) w_.variator.pulleys().motions(w_.end_state + at.pulley_begin(), w_.pulleys.end_sheaves);
}

Fault TransitionSearch::check(Counters& counters) {
    due_ = false;
    if (const Fault fault = check_tail(w_)) return fault;
    for (const SegmentResult& result : w_.segment_results) {
        if (result.fault) return result.fault;
        counters.suppressed += result.suppressed;
        due_ = due_ || result.pending;
    }
    return {};
}

void TransitionSearch::complete_start_slopes() {
    if (!w_.step.slopes_from_states()) return;  // slopes[0] is the slope that the method has evaluated
    const model::ChainLayout& at = w_.layout();
    const int half = at.link_size();
    for (int link = 0; link < at.links; ++link) {
        const int begin = at.link_begin(link);
        std::copy_n(w_.states[0] + begin + half, half, w_.slopes[0] + begin);
        std::copy_n(w_.end_slope + begin + half, half, w_.slopes[0] + begin + half);
    }
}

int TransitionSearch::prepare_end_slope() {
    w_.step.evaluate_end = true;
    w_.step.slope_out = w_.end_slope;
    std::copy(std::begin(w_.pulleys.end_sheaves), std::end(w_.pulleys.end_sheaves), std::begin(w_.pulleys.sheaves));
    return evaluate_cycle;
}

void TransitionSearch::close_end_slope() {
    close_evaluation(w_, w_.step.time + w_.step.h, w_.end_state + w_.layout().pulley_begin(), sheave_forces(w_), w_.end_slope);
}

bool TransitionSearch::locate() {
    Transition first;
    for (const SegmentResult& result : w_.segment_results) {
        if (result.first.theta < first.theta) first = result.first;
    }
    if (first.theta > 1.0) return false;
    w_.step.theta = first.theta;
    w_.step.due = first;
    return true;
}

int TransitionSearch::prepare_truncation() {
    std::copy(w_.tips.phases.begin(), w_.tips.phases.end(), w_.tips.phases_before.begin());
    const model::ChainLayout& at = w_.layout();
    w_.interpolant().evaluate(w_.step.theta, at.pulley_begin(), at.size(), w_.cut_state + at.pulley_begin());
    w_.variator.pulleys().motions(w_.cut_state + at.pulley_begin(), w_.pulleys.sheaves);
    return truncate_cycle;
}

void TransitionSearch::truncate(RunObserver& observer, Counters& counters) {
    std::swap(w_.states[0], w_.cut_state);
    std::swap(w_.tips.before, w_.tips.after);
    report_changes(observer, counters);
}

void TransitionSearch::report_changes(RunObserver& observer, Counters& counters) {
    method_.phases_changed();
    w_.phases_changed();
    for (std::size_t tip = 0; tip < w_.tips.phases.size(); ++tip) {
        if (w_.tips.phases[tip] == w_.tips.phases_before[tip]) continue;
        const int number = static_cast<int>(tip);
        const int pin = (number / 4 + number / 2 % 2) % w_.layout().links;
        ++counters.detected;
        observer.transition({w_.step.time, pin, number, w_.tips.phases_before[tip], w_.tips.phases[tip]});
    }
}

}  // namespace cvtflow::tasks
