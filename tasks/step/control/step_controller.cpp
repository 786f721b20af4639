#include "tasks/step/control/step_controller.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "tasks/step/control/input_points.hpp"
#include "tasks/step/control/longest_step.hpp"
#include "tasks/step/integration_state.hpp"
#include "tasks/step/method_memory.hpp"
#include "tasks/step/stage_method.hpp"

namespace cvtflow::tasks {

namespace {

/// A step shorter than this fraction of the longest one will not help [1].
constexpr double shortest_step = 1e-7;

/// A point of an input's table that lies nearer than this fraction of a step is where the step begins or ends [1].
constexpr double nearest_input_point = 1e-6;

/// A step by hand [s]. A third of 10 us is written as 3.33 us: it is that of the grid that is longer by what three digits leave out.
[[nodiscard]] double step_by_hand(const StepSettings& settings) noexcept {
    constexpr double three_digits = 1.1e-3, a_tenth_of_a_step = 0.1;
    const double steps = settings.output_interval / settings.step, whole = std::floor(steps);
    const bool is_meant = whole >= 1.0 && steps - whole <= std::min(three_digits * steps, a_tenth_of_a_step);
    return is_meant ? settings.output_interval / whole : settings.step;
}

/// With the error in charge, the grid is that of outputs.
[[nodiscard]] StepGrid grid_of(const StepSettings& settings, model::PinDetail pins) noexcept {
    StepGrid grid;
    grid.begin = settings.begin;
    grid.output_interval = settings.output_interval;
    const bool free = settings.control == StepControl::error;
    if (settings.automatic() && !free)
        grid.legs_per_output = static_cast<long>(std::ceil(settings.output_interval / StepChoice::ask_interval * (1.0 - 1e-12)));
    grid.divide(free ? settings.output_interval : settings.automatic() ? longest_automatic_step(pins) : step_by_hand(settings));
    return grid;
}

/// Longest step where the error decides.
[[nodiscard]] double longest_free_step(const StepSettings& settings) noexcept {
    return settings.automatic() ? settings.output_interval : std::min(settings.step, settings.output_interval);
}

}  // namespace

StepController::StepController(Workspace& workspace, const StepSettings& settings, RunObserver& observer,
                               const engine::Cancellation& cancel)
    : StepController(workspace, std::make_unique<StageMethod>(workspace), nullptr, settings, observer, cancel) {}

StepController::StepController(Workspace& workspace, StepMethod& method, const StepSettings& settings, RunObserver& observer,
                               const engine::Cancellation& cancel)
    : StepController(workspace, nullptr, &method, settings, observer, cancel) {}

StepController::StepController(Workspace& workspace, std::unique_ptr<StepMethod> own, StepMethod* method, const StepSettings& settings,
                               RunObserver& observer, const engine::Cancellation& cancel)
    : w_(workspace),
      own_method_(std::move(own)),
      method_(own_method_ ? *own_method_ : *method),
      settings_(settings),
      observer_(observer),
      cancel_(cancel),
      grid_(grid_of(settings, workspace.parameters.detail.pins)),
      control_(longest_free_step(settings), std::max(1, method_.error_power())),
      phases_before_(workspace.tips.phases) {
    w_.step.estimate_error = settings.control != StepControl::fixed;
    if (w_.step.estimate_error && method_.error_power() == 0)
        throw std::invalid_argument("this method has no estimate of its error: run.step_control can only be \"fixed\"");
    w_.step.time = settings.begin;
    w_.step.dwell = dwell_steps * grid_.step;
    w_.step.secant = method_.retakes();
    w_.step.evaluations = 0;
    method_.restart();  // a run does not depend on what ran before it
    w_.energy.restart(method_.observation_stride());
    if (settings.choice != nullptr) settings.choice->restart();
    probe_start();
}

StepController::StepController(Workspace& workspace, StepMethod& method, const StepSettings& settings, const IntegrationState& from,
                               RunObserver& observer, const engine::Cancellation& cancel)
    : w_(workspace),
      method_(method),
      settings_(settings),
      observer_(observer),
      cancel_(cancel),
      outputs_(from.outputs),
      grid_(grid_of(settings, workspace.parameters.detail.pins)),
      control_(longest_free_step(settings), std::max(1, method_.error_power())),
      counters_(from.counters),
      phases_before_(workspace.tips.phases) {
    w_.step.estimate_error = settings.control != StepControl::fixed;
    w_.step.time = from.time;
    if (from.grid_steps > 0) {
        grid_.divide(grid_.leg_length() / static_cast<double>(from.grid_steps));
        grid_.leg = from.grid_number / grid_.steps_per_leg;
        grid_.point = from.grid_number % grid_.steps_per_leg;
    }
    w_.step.dwell = dwell_steps * grid_.step;
    w_.energy.load(from.energy, method_.observation_stride());
    if (settings.choice != nullptr) settings.choice->load(from.step_choice);
    w_.step.secant = method_.retakes();
    w_.step.evaluations = from.counters.evaluations;
    method_.restart();
    std::span<const double> memory(from.method);
    if (settings.control == StepControl::error) control_.load(taken(memory, StepSizeControl::memory_size));
    method_.load(memory);
    w_.list_touching();
}

void StepController::save(IntegrationState& state) const {
    state.started = true;
    state.time = w_.step.time;
    state.begin = settings_.begin;
    state.output_interval = settings_.output_interval;
    state.step = settings_.step;
    state.grid_number = grid_.leg * grid_.steps_per_leg + grid_.point;
    state.grid_steps = grid_.steps_per_leg;
    w_.energy.save(state.energy);
    state.step_choice.clear();
    if (settings_.choice != nullptr) settings_.choice->save(state.step_choice);
    state.outputs = outputs_;
    state.counters = counters_;
    state.state.assign(w_.states[0], w_.states[0] + w_.layout().size());
    state.phases = w_.tips.phases;
    state.changed = w_.tips.changed;
    state.before = w_.tips.before;
    method_.save(state.method);
    if (settings_.control == StepControl::error) {
        const auto own = control_.save();
        state.method.insert(state.method.begin(), own.begin(), own.end());
    }
}

void StepController::rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
}

/// Phases of the start state, without dwell: a geometric start comes with all tips free.
void StepController::probe_start() {
    const model::ChainLayout& at = w_.layout();
    if (at.pulley_size == 0) return;
    w_.variator.pulleys().motions(w_.states[0] + at.pulley_begin(), w_.pulleys.sheaves);
    for (int link = 0; link < at.links; ++link) {
        model::TipProbe probe;
        model::LinkStrip strip;
        w_.variator.chain().probe(strip.of(at, w_.states[0], link), w_.pulleys.sheaves, w_.parameters.detail.stick_slip, probe);
        for (int corner = 0; corner < model::tips_per_link; ++corner) {
            const std::size_t tip = static_cast<std::size_t>(model::tips_per_link * link + corner);
            w_.tips.before[tip] = {probe.depth[corner], probe.slip[corner]};
            w_.tips.phases[tip] = w_.rule.next(w_.tips.phases[tip], w_.tips.before[tip]);
        }
    }
    w_.list_touching();
}

int StepController::next() noexcept {
    try {
        switch (state_) {
            case State::begin_step: return begin_step();
            case State::observe: return finish_observation();
            case State::method: return take(method_.next());
            case State::detect: return finish_detect();
            case State::end_slope:
                close_evaluation(w_, w_.step.time + w_.step.h, w_.end_state + w_.layout().pulley_begin(), w_.sheave_forces(), w_.end_slope);
                return start_locate();
            case State::locate: return finish_locate();
            case State::truncate: return finish_truncate();
        }
    } catch (...) {
        thrown_ = std::current_exception();
    }
    return stop;
}

int StepController::end(Fault fault) {
    fault_ = fault;
    return Controller::stop;
}

Fault StepController::budget() const {
    if (cancel_.requested() || (settings_.pause != nullptr && *settings_.pause)) return {FaultKind::cancelled, w_.step.time, {}, 0.0, 0.0};
    if (settings_.max_steps > 0 && counters_.steps >= settings_.max_steps) {
        return {FaultKind::max_steps, w_.step.time, {}, 0.0, static_cast<double>(settings_.max_steps)};
    }
    if (settings_.max_wall > 0.0 && counters_.steps % 64 == 0) {
        const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
        if (wall > settings_.max_wall) return {FaultKind::max_wall, w_.step.time, {}, wall, settings_.max_wall};
    }
    return {};
}

int StepController::begin_step() {
    if (const Fault lost = lost_in_rounding()) return end(lost);
    counters_.evaluations = w_.step.evaluations;
    if (w_.energy.due(w_.step.time)) return start_observation();
    return go_on();
}

int StepController::go_on() {
    const bool due = w_.step.time == grid_.here() && grid_.at_output(outputs_);
    const bool over = w_.step.time >= settings_.until - 1e-9 * settings_.output_interval;
    if (due || over) {
        w_.energy.output(w_.step.time, w_.shaft_momentum());
        observer_.output(w_.step.time, w_, counters_);
    }
    if (due) ++outputs_;
    if (over) return end(Fault{});
    if (const Fault spent = budget()) return end(spent);
    if (settings_.automatic() && grid_.point == 0 && w_.step.time == grid_.here()) choose_step();
    return start_step();
}

namespace {

/// Where a step that begins now may end: at the grid's next point, or at a point of an input's table before it. Inputs may jump between
/// two points, and their works are exact only where they are linear over a step. What follows a point may be fast. [s]
[[nodiscard]] double next_end(Workspace& w, const StepGrid& grid) noexcept {
    if (w.layout().pulley_size == 0) return grid.next();
    const double now = w.step.time, nearest = nearest_input_point * grid.step;
    const auto after = [&](double t) { return next_input_point(w.parameters, w.variator.pulleys().held(), t); };
    if (after(now - nearest) <= now + nearest) w.energy.inputs_changed(now);
    const double point = after(now + nearest);
    return point < grid.next() - nearest ? point : grid.next();
}

}  // namespace

/// To the next grid point or point of an input, in as many equal steps as the error asks for.
int StepController::start_step() {
    const double step_end = next_end(w_, grid_);
    w_.step.h = step_end - w_.step.time;
    lands_ = step_end == grid_.next();
    retaking_ = false;
    if (settings_.control == StepControl::error) {
        const double pieces = std::ceil(w_.step.h / method_.longest_step(control_.proposal()) * (1.0 - 1e-9));
        lands_ = lands_ && pieces <= 1.0;
        if (pieces > 1.0) w_.step.h /= pieces;
        w_.step.dwell = dwell_steps * w_.step.h;
    }
    w_.step.lookout = w_.step.time + w_.step.h;
    return take(method_.begin());
}

/// The step again, shorter. Nothing has changed but the slots.
int StepController::reject() {
    ++counters_.rejected;
    method_.rejected();
    const double shortest = shortest_step * settings_.step;
    if (control_.proposal() < shortest) return end({FaultKind::step_size, w_.step.time, {}, control_.proposal(), shortest});
    if (const Fault spent = budget()) return end(spent);
    return start_step();
}

/// Local error of the step, the largest of all links and of the pulleys; not a number if the estimate is none.
double StepController::step_error() {
    const model::ChainLayout& at = w_.layout();
    double largest = 0.0;
    if (at.pulley_size != 0) {
        engine::combine(w_.step.error_row, w_.step.h, w_.slots(), at.pulley_begin(), at.pulley_begin() + 2 * at.pulley_size,
                        w_.pulleys.tail.data());
        largest = w_.step.error_scale.norm(w_.pulleys.tail.data(), at.pulley_size);
        if (!std::isfinite(largest)) return largest;
    }
    for (const double error : w_.links.errors) {
        if (!std::isfinite(error)) return error;
        largest = std::max(largest, error);
    }
    return largest;
}

/// What the method wants next: a cycle, or the step is taken, or it cannot be.
int StepController::take(NextCycle next) {
    state_ = State::method;
    if (next.has_failed()) return end(method_.fault());
    return next.is_done() ? start_detect() : next.cycle();
}

int StepController::start_end_slope() {
    state_ = State::end_slope;
    w_.step.evaluate_end = true;
    w_.step.slope_out = w_.end_slope;
    std::copy(std::begin(w_.pulleys.end_sheaves), std::end(w_.pulleys.end_sheaves), std::begin(w_.pulleys.sheaves));
    return evaluate_cycle;
}

int StepController::accept() {
    const double begin = w_.step.time;
    if (lands_) grid_.pass();
    w_.step.time = lands_ ? grid_.here() : w_.step.time + w_.step.h;
    w_.energy.step(w_.variator, begin, w_.states[0] + w_.layout().pulley_begin(), w_.step.time, w_.end_state + w_.layout().pulley_begin());
    std::swap(w_.states[0], w_.end_state);
    std::swap(w_.tips.before, w_.tips.after);
    ++counters_.steps;
    return begin_step();
}

}  // namespace cvtflow::tasks
