#include "tasks/step_controller.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "tasks/checkpoint/integration_state.hpp"

namespace cvtflow::tasks {

namespace {

/// Longest time a freshly changed tip keeps its phase, in steps: one whole step, whatever rounding says.
constexpr double dwell_steps = 1.5;

[[nodiscard]] long steps_per_output(const StepSettings& settings) {
    return std::max(1L, static_cast<long>(std::ceil(settings.output_interval / settings.step * (1.0 - 1e-12))));
}

}  // namespace

StepController::StepController(Workspace& workspace, const StepSettings& settings, RunObserver& observer, const engine::Cancellation& cancel)
    : w_(workspace), settings_(settings), observer_(observer), cancel_(cancel),
      steps_per_output_(steps_per_output(settings)),
      grid_step_(settings.output_interval / static_cast<double>(steps_per_output_)), phases_before_(workspace.phases) {
    w_.time = settings.begin;
    w_.dwell = dwell_steps * grid_step_;
    probe_start();
}

StepController::StepController(Workspace& workspace, const StepSettings& settings, const IntegrationState& from, RunObserver& observer, const engine::Cancellation& cancel)
    : w_(workspace), settings_(settings), observer_(observer), cancel_(cancel), outputs_(from.outputs), grid_number_(from.grid_number),
      steps_per_output_(steps_per_output(settings)), grid_step_(settings.output_interval / static_cast<double>(steps_per_output_)), counters_(from.counters),
      phases_before_(workspace.phases) {
    w_.time = from.time;
    w_.dwell = dwell_steps * grid_step_;
    w_.list_touching();
}

void StepController::save(IntegrationState& state) const {
    state.started = true;
    state.time = w_.time;
    state.begin = settings_.begin;
    state.output_interval = settings_.output_interval;
    state.step = settings_.step;
    state.grid_number = grid_number_;
    state.outputs = outputs_;
    state.counters = counters_;
    state.state.assign(w_.states[0], w_.states[0] + w_.layout().size());
    state.phases = w_.phases;
    state.changed = w_.changed;
    state.before = w_.before;
}

void StepController::rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
}

/// Phases of the start state, without dwell: a geometric start comes with all tips free.
void StepController::probe_start() {
    const model::ChainLayout& at = w_.layout();
    if (at.pulley_size == 0) return;
    w_.variator.pulleys().motions(w_.states[0] + at.pulley_begin(), w_.sheaves);
    for (int link = 0; link < at.links; ++link) {
        model::TipProbe probe;
        w_.variator.chain().probe(w_.states[0] + at.link_begin(link), w_.sheaves, probe);
        for (int corner = 0; corner < model::tips_per_link; ++corner) {
            const std::size_t tip = static_cast<std::size_t>(model::tips_per_link * link + corner);
            w_.before[tip] = {probe.depth[corner], probe.slip[corner]};
            w_.phases[tip] = w_.rule.next(w_.phases[tip], w_.before[tip]);
        }
    }
    w_.list_touching();
}

int StepController::next() noexcept {
    try {
        switch (state_) {
            case State::begin_step: return begin_step();
            case State::stage: return finish_stage();
            case State::detect: return finish_detect();
            case State::end_slope:
                close_evaluation(w_.time + w_.h, w_.end_state + w_.layout().pulley_begin(), w_.end_slope);
                state_ = State::locate;
                return locate_cycle;
            case State::locate: return finish_locate();
            case State::truncate: return finish_truncate();
        }
    } catch (...) {
        thrown_ = std::current_exception();
    }
    return stop;
}

double StepController::grid_time(long number) const noexcept {
    const long interval = number / steps_per_output_;
    return settings_.begin + static_cast<double>(interval) * settings_.output_interval + static_cast<double>(number % steps_per_output_) * grid_step_;
}

int StepController::end(Fault fault) {
    fault_ = fault;
    return Controller::stop;
}

Fault StepController::budget() const {
    if (cancel_.requested() || (settings_.pause != nullptr && *settings_.pause)) return {FaultKind::cancelled, w_.time, -1, 0.0, 0.0};
    if (settings_.max_steps > 0 && counters_.steps >= settings_.max_steps) {
        return {FaultKind::max_steps, w_.time, -1, 0.0, static_cast<double>(settings_.max_steps)};
    }
    if (settings_.max_wall > 0.0 && counters_.steps % 64 == 0) {
        const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
        if (wall > settings_.max_wall) return {FaultKind::max_wall, w_.time, -1, wall, settings_.max_wall};
    }
    return {};
}

int StepController::begin_step() {
    const bool due = w_.time == grid_time(grid_number_) && grid_number_ == outputs_ * steps_per_output_;
    const bool over = w_.time >= settings_.until - 1e-9 * settings_.output_interval;
    if (due || over) observer_.output(w_.time, w_, counters_);
    if (due) ++outputs_;
    if (over) return end(Fault{});
    if (const Fault spent = budget()) return end(spent);
    w_.h = grid_time(grid_number_ + 1) - w_.time;
    return start_stage(0);
}

int StepController::start_stage(int stage) {
    stage_ = stage;
    state_ = State::stage;
    w_.evaluate_end = false;
    w_.row = w_.plan.stage(stage);
    w_.slope_out = w_.slopes[static_cast<std::size_t>(w_.row.slope)];
    const model::ChainLayout& at = w_.layout();
    engine::combine(w_.row, w_.h, w_.slots(), at.pulley_begin(), at.size(), w_.tail.data());
    if (w_.row.keep >= 0) std::copy(w_.tail.begin(), w_.tail.end(), w_.states[static_cast<std::size_t>(w_.row.keep)] + at.pulley_begin());
    if (at.pulley_size != 0) w_.variator.pulleys().motions(w_.tail.data(), w_.sheaves);
    return evaluate_cycle;
}

void StepController::close_evaluation(double time, const double* tail, double* slope) {
    ++counters_.evaluations;
    w_.variator.close(time, tail, w_.phases.data(), w_.loads.data(), w_.accounts.data(), slope + w_.layout().pulley_begin());
}

int StepController::finish_stage() {
    close_evaluation(w_.time + w_.row.time * w_.h, w_.tail.data(), w_.slope_out);
    return stage_ + 1 < w_.plan.stages() ? start_stage(stage_ + 1) : start_detect();
}

int StepController::start_detect() {
    state_ = State::detect;
    w_.row = w_.plan.result();
    const model::ChainLayout& at = w_.layout();
    engine::combine(w_.row, w_.h, w_.slots(), at.pulley_begin(), at.size(), w_.end_state + at.pulley_begin());
    if (at.pulley_size != 0) w_.variator.pulleys().motions(w_.end_state + at.pulley_begin(), w_.end_sheaves);
    return detect_cycle;
}

int StepController::finish_detect() {
    bool pending = false;
    const double* tail = w_.end_state + w_.layout().pulley_begin();
    for (int k = 0; k < w_.tail_size(); ++k) {
        if (!std::isfinite(tail[k])) return end({FaultKind::non_finite, w_.time + w_.h, -1, 0.0, 0.0});
    }
    for (const Verdict& verdict : w_.verdicts) {
        if (verdict.fault) return end(verdict.fault);
        counters_.suppressed += verdict.suppressed;
        pending = pending || verdict.pending;
    }
    return pending ? start_end_slope() : accept();
}

int StepController::start_end_slope() {
    state_ = State::end_slope;
    w_.evaluate_end = true;
    w_.slope_out = w_.end_slope;
    std::copy(std::begin(w_.end_sheaves), std::end(w_.end_sheaves), std::begin(w_.sheaves));
    return evaluate_cycle;
}

int StepController::finish_locate() {
    double theta = 2.0;
    for (const Verdict& verdict : w_.verdicts) theta = std::min(theta, verdict.first.theta);
    if (theta > 1.0) return accept();
    w_.theta = theta;
    state_ = State::truncate;
    std::copy(w_.phases.begin(), w_.phases.end(), phases_before_.begin());
    const model::ChainLayout& at = w_.layout();
    w_.interpolant().evaluate(theta, at.pulley_begin(), at.size(), w_.cut_state + at.pulley_begin());
    w_.variator.pulleys().motions(w_.cut_state + at.pulley_begin(), w_.sheaves);
    return truncate_cycle;
}

void StepController::record_transitions() {
    for (std::size_t tip = 0; tip < w_.phases.size(); ++tip) {
        if (w_.phases[tip] == phases_before_[tip]) continue;
        const int number = static_cast<int>(tip);
        const int pin = (number / 4 + number / 2 % 2) % w_.layout().links;
        ++counters_.detected;
        observer_.transition({w_.time, pin, number, phases_before_[tip], w_.phases[tip]});
    }
}

int StepController::finish_truncate() {
    std::swap(w_.states[0], w_.cut_state);
    std::swap(w_.before, w_.after);
    w_.time += w_.theta * w_.h;
    ++counters_.truncated;
    ++counters_.steps;
    w_.list_touching();
    record_transitions();
    return begin_step();
}

int StepController::accept() {
    std::swap(w_.states[0], w_.end_state);
    std::swap(w_.before, w_.after);
    ++grid_number_;
    w_.time = grid_time(grid_number_);
    ++counters_.steps;
    return begin_step();
}

}  // namespace cvtflow::tasks
