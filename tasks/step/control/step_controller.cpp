#include "tasks/step/control/step_controller.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "tasks/step/control/step_grid.hpp"
#include "tasks/step/integration_state.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

namespace {

/// A step shorter than this fraction of the longest one will not help [1].
constexpr double shortest_step = 1e-7;

/// A longer automatic step replaces a shorter one only if it is longer by this factor.
constexpr double min_gain = 1.05;

[[nodiscard]] double longest_step(const StepSettings& settings) noexcept {
    return settings.automatic() ? settings.output_interval : std::min(settings.step, settings.output_interval);
}

/// Temperatures follow the losses so far, and the tips' law the temperatures: forces are no longer those that were observed.
void warm(Workspace& w) noexcept {
    if (!w.heat.enabled()) return;
    w.links.observed = false;
    w.heat.advance(w.step.time, w.energy.sums(w.step.time).loss);
    w.warm();
}

/// Stages must have different times, and a step must advance the time by its length, to three digits.
[[nodiscard]] Fault check_precision(double time, double step) noexcept {
    const double shortest = 1e3 * std::numeric_limits<double>::epsilon() * std::abs(time);
    if (step >= shortest) return {};
    return {FaultKind::step_too_short, time, {}, step, shortest};
}

void sample_energy(Workspace& w) noexcept {
    if (w.energy.counted()) return w.energy.sample_counted(w.step.time, w.pin_period());
    model::Account pulleys;
    if (w.layout().pulley_size != 0) w.variator.pulleys().account(w.tail(), pulleys);
    w.energy.sample(w.step.time, model::total_of(w.links.accounts), pulleys, w.pin_period());
}

/// Phases of the start state, without dwell: a geometric start comes with all tips free.
void probe_start(Workspace& w) noexcept {
    const model::ChainLayout& at = w.layout();
    if (at.pulley_size == 0) return;
    w.variator.pulleys().motions(w.states[0] + at.pulley_begin(), w.pulleys.sheaves);
    for (int link = 0; link < at.links; ++link) {
        model::TipProbe probe;
        model::NeighbourWindow strip;
        indicate(w, strip.of(at, w.states[0], link), w.pulleys.sheaves, w.tips.before.data() + model::tips_per_link * link, probe);
    }
    for (std::size_t tip = 0; tip < w.tips.phases.size(); ++tip) w.tips.phases[tip] = w.rule.next(w.tips.phases[tip], w.tips.before[tip]);
    w.phases_changed();
}

}  // namespace

StepController::StepController(Workspace& workspace, StepMethod& method, const StepSettings& settings, RunObserver& observer,
                               const engine::Cancellation& cancel, const IntegrationState* from)
    : w_(workspace),
      method_(method),
      settings_(settings),
      observer_(&observer),
      cancel_(&cancel),
      grid_(grid_of(settings)),
      errors_(workspace, method_, settings),
      transitions_(workspace, method_),
      integration_(integrate()) {
    if (from != nullptr) {
        outputs_ = from->outputs;
        counters_ = from->counters;
        if (from->grid_steps > 0) grid_.continue_at(from->grid_number, from->grid_steps);
    }
    w_.step.time = from != nullptr ? from->time : settings.begin;
    w_.step.dwell = dwell_steps * grid_.step;
    w_.step.evaluations = counters_.evaluations;
    method_.restart();  // a run does not depend on what ran before it
    if (from != nullptr) {
        w_.energy.restart(method_.observation_stride());
        read_sums(w_, from->energy);
        if (settings.choice != nullptr) settings.choice->restart();
        w_.phases_changed();
        engine::read_fields(from->method, [this](auto& archive) { visit(archive); });
    } else {
        method_.start();
        w_.energy.restart(method_.observation_stride());
        if (settings.choice != nullptr) settings.choice->restart();
        probe_start(w_);
    }
}

void StepController::resume(const StepSettings& settings, RunObserver& observer, const engine::Cancellation& cancel) {
    settings_ = settings;
    observer_ = &observer;
    cancel_ = &cancel;
    started_ = std::chrono::steady_clock::now();
    w_.energy.inputs_changed(w_.step.time, false);
    integration_.reset();  // its frame is that of the next one
    integration_.emplace(integrate());
}

void StepController::visit(engine::Archive& archive) {
    if (settings_.choice != nullptr) settings_.choice->visit(archive);
    errors_.visit(archive);
    method_.visit(archive);
}

void StepController::save(IntegrationState& state) {
    state.started = true;
    state.time = w_.step.time;
    state.begin = settings_.begin;
    state.output_interval = settings_.output_interval;
    state.step = settings_.step;
    state.grid_number = grid_.leg * grid_.steps_per_leg + grid_.point;
    state.grid_steps = grid_.steps_per_leg;
    state.outputs = outputs_;
    state.counters = counters_;
    state.state.assign(w_.state(), w_.state() + w_.layout().size());
    state.phases = w_.tips.phases;
    state.changed = w_.tips.changed;
    state.before = w_.tips.before;
    write_sums(w_, state.energy);
    engine::write_fields(state.method, [this](auto& archive) { visit(archive); });
}

/// The integration. Each co_yield runs one cycle of the task graph on all segments; everything else is serial.
CycleSequence StepController::integrate() {
    const AtTransition at_transition = w_.step.at_transition;
    for (;;) {
        if (const Fault fault = check_precision(w_.step.time, grid_.step)) co_return fault;
        if (w_.energy.due(w_.step.time, grid_.steps_to_output(outputs_))) {
            if (prepare_observation()) co_yield observe_cycle;
            sample_energy(w_);
        }
        if (deliver_output()) co_return {};
        if (const Fault fault = check_budget()) co_return fault;
        plan_step();
        bool cut = false;  // the step ends at a transition
        while (true) {     // twice or more: after a rejection shorter, or up to the transition
            CycleSequence step = method_.step();
            for (int cycle = step.next(); cycle != stop; cycle = step.next()) co_yield cycle;
            step.rethrow();
            if (step.fault()) co_return step.fault();
            if (at_transition == AtTransition::inside) break;
            transitions_.prepare_detection();
            errors_.prepare(method_);
            co_yield detect_cycle;
            const bool accurate = errors_.accepts(cut);
            if (const Fault fault = accurate ? transitions_.check(counters_) : reject()) co_return fault;
            if (!accurate) continue;
            if (!cut && !transitions_.due()) break;
            transitions_.complete_start_slopes();
            if (cut) break;
            if (at_transition == AtTransition::interpolate) {
                co_yield transitions_.prepare_end_slope();
                transitions_.close_end_slope();
            }
            co_yield locate_cycle;
            cut = transitions_.locate();
            if (!cut || at_transition == AtTransition::interpolate || w_.step.theta <= 0.0) break;
            w_.step.h *= std::exchange(w_.step.theta, 1.0);
        }
        if (cut) co_yield transitions_.prepare_truncation();
        cut ? truncate() : accept();
    }
}

/// The sheaves for an observe cycle, and whether an observer reads what it leaves. @return false: losses and energies are known
bool StepController::prepare_observation() noexcept {
    if (w_.energy.counted()) return false;
    if (w_.layout().pulley_size != 0) w_.variator.pulleys().motions(w_.states[0] + w_.layout().pulley_begin(), w_.pulleys.observed_sheaves);
    const double next = w_.step.time + w_.energy.stride() * grid_.step;  // the next evaluation that an observer may share
    w_.links.observed = grid_.steps_to_output(outputs_) == 0.0 || observer_->samples(next);
    return true;
}

Fault StepController::check_budget() const {
    if (cancel_->requested() || (settings_.pause != nullptr && *settings_.pause)) return {FaultKind::cancelled, w_.step.time, {}, 0.0, 0.0};
    if (settings_.max_steps > 0 && counters_.steps >= settings_.max_steps) {
        return {FaultKind::max_steps, w_.step.time, {}, 0.0, static_cast<double>(settings_.max_steps)};
    }
    if (settings_.max_wall > 0.0 && counters_.steps % 64 == 0) {
        const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
        if (wall > settings_.max_wall) return {FaultKind::max_wall, w_.step.time, {}, wall, settings_.max_wall};
    }
    return {};
}

/// Delivers an output if one is due; true at the end of the integration.
bool StepController::deliver_output() {
    counters_.evaluations = w_.step.evaluations;
    const bool due = w_.step.time == grid_.here() && grid_.at_output(outputs_);
    w_.step.output = grid_.leg_begin();
    const bool over = w_.step.time >= settings_.until - 1e-9 * settings_.output_interval;
    if (due) {  // not where a call ends: no result depends on that
        w_.energy.output(w_.step.time, shaft_momentum(w_));
        warm(w_);
    }
    if (due || over) observer_->output(w_.step.time, w_, counters_);
    if (due) ++outputs_;
    if (!due && !over && (w_.links.observed || observer_->samples(w_.step.time))) observer_->sample(w_.step.time, w_, counters_);
    w_.links.observed = false;
    return over;
}

void StepController::plan_step() {
    if (settings_.automatic() && !errors_.decides() && grid_.point == 0 && w_.step.time == grid_.here()) choose_step();
    propose_step();
}

/// Length of automatic steps, at the start of a leg: shorter as soon as needed, longer only if the gain is worth it.
void StepController::choose_step() {
    StepChoice& choice = *settings_.choice;
    const double* state = choice.reads_state(w_.step.time) ? w_.state() : nullptr;  // rigid pins have theirs elsewhere, and copy it
    const double longest = std::min(method_.longest_step(choice.longest()), choice.caution(w_.energy.balance_error_ratio()) *
                                                                                choice.longest(w_.step.time, state, w_.tips.phases.data()));
    StepGrid next = grid_;
    next.divide(longest);
    const bool longer = next.step > grid_.step;
    if (longer && grid_.leg > 0) next.divide(longest / min_gain);
    if (!longer || next.step > grid_.step) grid_ = next;
    w_.step.dwell = dwell_steps * grid_.step;
}

/// Proposes a step towards the next grid point or point of an input, in as many equal steps as the error requires.
void StepController::propose_step() {
    const double step_end = next_step_end(w_, grid_);
    w_.step.h = step_end - w_.step.time;
    reaches_grid_point_ = step_end == grid_.next();
    if (errors_.decides()) {
        const double pieces = std::ceil(w_.step.h / method_.longest_step(errors_.proposal()) * (1.0 - 1e-9));
        reaches_grid_point_ = reaches_grid_point_ && pieces <= 1.0;
        if (pieces > 1.0) w_.step.h /= pieces;
        w_.step.dwell = dwell_steps * w_.step.h;
    }
    w_.step.search_until = w_.step.time + w_.step.h;
}

/// The step is repeated, shorter. Only slots have changed.
Fault StepController::reject() {
    ++counters_.rejected;
    const double shortest = shortest_step * settings_.step;
    if (errors_.proposal() < shortest) return {FaultKind::step_size, w_.step.time, {}, errors_.proposal(), shortest};
    if (const Fault spent = check_budget()) return spent;
    propose_step();
    return {};
}

void StepController::accept() {
    const double begin = w_.step.time;
    if (reaches_grid_point_) grid_.pass();
    w_.step.time = reaches_grid_point_ ? grid_.here() : w_.step.time + w_.step.h;
    ++counters_.steps;
    w_.energy.step(w_.variator, begin, w_.states[0] + w_.layout().pulley_begin(), w_.step.time, w_.end_state + w_.layout().pulley_begin());
    std::swap(w_.states[0], w_.end_state);
    if (w_.step.at_transition != AtTransition::inside)
        std::swap(w_.tips.before, w_.tips.after);
    else if (w_.tips.have_changed)
        transitions_.report_changes(*observer_, counters_);
}

void StepController::truncate() {
    const double begin = w_.step.time;
    w_.step.time += w_.step.theta * w_.step.h;
    w_.energy.step(w_.variator, begin, w_.states[0] + w_.layout().pulley_begin(), w_.step.time, w_.cut_state + w_.layout().pulley_begin());
    ++counters_.truncated;
    ++counters_.steps;
    transitions_.truncate(*observer_, counters_);
}

ErrorControl::ErrorControl(Workspace& workspace, const StepMethod& method, const StepSettings& settings)
    : w_(workspace),
      estimates_(settings.control != StepControl::fixed),
      decides_(settings.control == StepControl::error),
      tolerance_(settings.tolerance),
      size_(longest_step(settings), std::max(1, method.error_estimate().power)) {
    if (estimates_ && method.error_estimate().power == 0)
        throw std::invalid_argument("this method has no error estimate: run.step_control must be \"fixed\"");
    w_.step.estimate_error = estimates_;
}

void ErrorControl::prepare(const StepMethod& method) const {
    if (estimates_) w_.step.error_row = method.error_estimate().row;
}

bool ErrorControl::accepts(bool retaken) {
    const bool counts = estimates_ && !retaken;
    const double error = counts ? step_error() : 0.0;
    if (decides_ && !size_.judge(error / tolerance_, w_.step.h)) return false;
    if (counts) {
        ++statistics_.steps;
        statistics_.sum += error;
        statistics_.largest = std::max(statistics_.largest, error);
    }
    return true;
}

/// Local error of the step, the largest of all links and of the pulleys; not a number if an estimate is not finite.
double ErrorControl::step_error() const {
    const model::ChainLayout& at = w_.layout();
    double largest = 0.0;
    if (at.pulley_size != 0) {
        engine::combine(w_.step.error_row, w_.step.h, w_.slots(), at.pulley_begin(), at.control_begin(), w_.pulleys.tail.data());
        largest = w_.step.error_scale.norm(w_.pulleys.tail.data(), at.pulley_size);
        if (!std::isfinite(largest)) return largest;
    }
    for (const double error : w_.links.errors) {
        if (!std::isfinite(error)) return error;
        largest = std::max(largest, error);
    }
    return largest;
}

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
