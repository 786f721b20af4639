#include "tasks/run/run_loop.hpp"

#include <limits>

namespace cvtflow::tasks {

RunEnd end_of(const Scene& scene) {
    const double latest = latest_end(scene);
    return {scene.run.until.automatic() ? std::numeric_limits<double>::infinity() : latest, latest};
}

Fault RunLoop::settle(double from) {
    if (!simulation_->needs_settling()) return {};
    history_.settled = true;
    if (recorder_ != nullptr) recorder_->begin_part(from, 0.0);
    return part(0.0, history_.settling_wall);
}

Fault RunLoop::run(const RunEnd& end) {
    if (!simulation_->integration_state().started) history_.begin = simulation_->time();
    if (recorder_ != nullptr) recorder_->begin_part(history_.begin, end.latest);
    return part(end.time, history_.wall);
}

/// Advances from the present state until the part is complete. @param wall  of the part, which is right in every pause [s]
Fault RunLoop::part(double until, double& wall) {
    const bool settling = simulation_->needs_settling();
    for (;;) {
        const auto started = std::chrono::steady_clock::now();
        pause_ = false;
        const Fault fault = simulation_->advance({.until = until, .pause = &pause_}, *this, cancel_);
        wall += std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
        if (settling) history_.settling = simulation_->counters();
        if (fault.kind != FaultKind::cancelled || !pause_) return fault;
        if (means_.ended()) return means_.steady_fault();
        if (!pauses_.pass(*this)) return fault;
    }
}

void RunLoop::output(double time, const Workspace& workspace, const Counters& counters) {
    if (recorder_ != nullptr) recorder_->output(time, workspace, counters);
    observer_.output(time, workspace, counters);
    pause_ = pauses_.due(time, counters) || means_.ended();
}

bool RunLoop::samples(double time) const noexcept { return observer_.samples(time) || (recorder_ != nullptr && recorder_->samples(time)); }

void RunLoop::sample(double time, const Workspace& workspace, const Counters& counters) {
    if (recorder_ != nullptr && recorder_->samples(time)) recorder_->sample(time, workspace, counters);
    if (observer_.samples(time)) observer_.sample(time, workspace, counters);
    pause_ = pause_ || means_.ended();
}

void RunLoop::transition(const TransitionRecord& record) {
    if (recorder_ != nullptr) recorder_->transition(record);
    observer_.transition(record);
}

}  // namespace cvtflow::tasks
