#include "tasks/run/run_loop.hpp"

#include <limits>

#include "model/start/shift_ratio.hpp"

namespace cvtflow::tasks {

namespace {

/// Where control has led the driving sheave: its mean in the last half of that time, moved by what the ratio was off
/// (model/EQUATIONS.md section 8).
[[nodiscard]] model::HeldSheave sheave_of(const RunMeans& means, const Simulation& simulation) noexcept {
    const Workspace& w = simulation.workspace();
    const model::Parameters& p = w.parameters;
    const auto last = static_cast<std::size_t>(means.rule().controlled);
    const MeanPoint &begin = means.curve().points()[last / 2], &end = means.curve().points()[last];
    const double target = end.mean_since(begin, Mean::target);
    model::HeldSheave held{end.mean_since(begin, Mean::opening), end.mean_since(begin, Mean::clamping)};
    const auto is = model::chain_radii(p, end.ratio_since(begin)), aimed = model::chain_radii(p, target);
    const model::PulleyCoordinates& at = w.variator.pulleys().coordinates();
    if (is && aimed) held.opening += (is->driving - aimed->driving) / at.narrowing();
    held.offset = at.opening(w.state() + w.layout().pulley_begin(), 0) - held.opening;
    held.since = simulation.time();
    return held;
}

}  // namespace

RunEnd end_of(const Scene& scene) {
    const double latest = latest_end(scene);
    return {scene.run.until.automatic() ? std::numeric_limits<double>::infinity() : latest, latest};
}

Fault RunLoop::settle(double from) {
    if (!simulation_.needs_settling()) return {};
    history_.settled = true;
    if (recorder_ != nullptr) recorder_->begin_part(from, 0.0);
    return part(0.0, history_.settling_wall);
}

Fault RunLoop::run(const RunEnd& end) {
    if (!simulation_.integration_state().started) history_.begin = simulation_.time();
    if (recorder_ != nullptr) recorder_->begin_part(history_.begin, end.latest);
    return part(end.time, history_.wall);
}

/// Advances from the present state until the part is complete. @param wall  of the part, which is right in every pause [s]
Fault RunLoop::part(double until, double& wall) {
    const bool settling = simulation_.needs_settling();
    for (;;) {
        const auto started = std::chrono::steady_clock::now();
        pause_ = false;
        const Fault fault = simulation_.advance({.until = until, .rows_between = true, .pause = &pause_}, *this, cancel_);
        wall += std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
        if (settling) history_.settling = simulation_.counters();
        if (fault.kind != FaultKind::cancelled || !pause_) return fault;
        if (means_.ended()) return means_.steady_fault();
        if (sheave_due()) {
            hold_sheave();
            continue;
        }
        if (!pauses_.pass()) return fault;
    }
}

bool RunLoop::sheave_due() const noexcept {
    const double periods = means_.rule().controlled;
    return periods > 0.0 && static_cast<double>(means_.curve().points().size()) > periods &&
           !simulation_.workspace().variator.pulleys().torques().held().sheave;
}

void RunLoop::hold_sheave() {
    model::HeldInputs held = simulation_.workspace().variator.pulleys().torques().held();
    held.sheave = sheave_of(means_, simulation_);
    simulation_.hold(held);
}

void RunLoop::output(double time, const Workspace& workspace, const Counters& counters) {
    if (recorder_ != nullptr) recorder_->output(time, workspace, counters);
    observer_.output(time, workspace, counters);
    pause_ = pauses_.due(time, counters) || means_.ended() || sheave_due();
}

bool RunLoop::samples(double time) const noexcept { return observer_.samples(time) || (recorder_ != nullptr && recorder_->samples(time)); }

void RunLoop::sample(double time, const Workspace& workspace, const Counters& counters) {
    if (recorder_ != nullptr && recorder_->samples(time)) recorder_->sample(time, workspace, counters);
    if (observer_.samples(time)) observer_.sample(time, workspace, counters);
    pause_ = pause_ || means_.ended() || sheave_due();
}

void RunLoop::transition(const TransitionRecord& record) {
    if (recorder_ != nullptr) recorder_->transition(record);
    observer_.transition(record);
}

}  // namespace cvtflow::tasks
