#include "tasks/run/run_part.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>

#include "engine/executor/cancellation.hpp"
#include "model/force/pulley_inputs.hpp"
#include "tasks/run/simulation.hpp"

namespace cvtflow::tasks {

namespace {

/// Rest of a budget that is used up: 0 would mean no budget [s].
constexpr double shortest_budget = 1e-9;

/// Couplings and hydraulics take over where a run begins: at t = 0 after settling, or at a start that needs none.
/// @param couplings IntegrationState::couplings [none or 6]
void couple(Workspace& w, double time, std::vector<double>& couplings) {
    if (w.layout().pulley_size == 0) return;
    double* const tail = w.state_to_set() + w.layout().pulley_begin();
    w.variator.pulleys().fill_cylinders(time, tail);
    w.variator.couple(time, tail);
    for (const model::ReferenceAngle& from : w.variator.pulleys().held().reference)
        couplings.insert(couplings.end(), {from.since, from.angle, from.zero});
}

/// @param numbers IntegrationState::couplings [none or 6]
void restore_couplings(model::Variator& variator, std::span<const double> numbers) {
    model::HeldInputs held = variator.pulleys().held();
    held.coupled = !numbers.empty();
    for (model::ReferenceAngle& reference : held.reference) {
        reference = {};
        if (!held.coupled) continue;
        reference = {numbers[0], numbers[1], numbers[2]};
        numbers = numbers.subspan(3);
    }
    variator.hold(held);
}

}  // namespace

RunPart::RunPart(const Scene& scene, Integrator& integrator) noexcept
    : scene_(scene), integrator_(integrator), workspace_(integrator.workspace()) {}

void RunPart::forget(bool same_machine) noexcept {
    if (!same_machine) choice_.reset();
    forget_controller();
    counters_ = {};
}

void RunPart::begin(double time, bool settles, double balance_error_ratio, double residual) {
    Workspace& w = workspace_;
    time_ = time;
    needs_settling_ = settles;
    saved_.settling_balance_error_ratio = balance_error_ratio;
    saved_.settling_residual = residual;
    forget_controller();
    saved_.couplings.clear();
    if (!needs_settling_) couple(w, time_, saved_.couplings);
    if (!scene_.run.step.automatic())
        choice_.reset();
    else if (choice_ == nullptr)
        choice_ = std::make_unique<AutoStep>(w.variator, scene_.parameters, integrator_.chosen_method());
    w.energy.restart(integrator_.method().observation_stride());
    w.heat.restart(scene_.parameters);
    w.trip.follow(scene_.vehicle, scene_.cycle);
    w.warm();
    saved_.started = false;
    saved_.settling = needs_settling_;
    saved_.time = time_;
    saved_.begin = saved_.output_interval = saved_.step = 0.0;
    saved_.grid_number = saved_.grid_steps = saved_.outputs = 0;
    saved_.counters = {};
    saved_.method.clear();
    saved_.state.assign(w.state(), w.state() + w.layout().size());
    saved_.phases = w.tips.phases;
    saved_.changed = w.tips.changed;
    saved_.before = w.tips.before;
    saved_.energy.clear();
    saved_.heat.clear();
    saved_.step_choice.clear();
}

Fault RunPart::advance(const Goal& goal, RunObserver& observer, const engine::Cancellation& cancel) {
    StepSettings settings = settings_of(goal);
    const double budget = settings.max_wall;
    if (budget > 0.0) settings.max_wall = std::max(shortest_budget, budget - paused_wall_);
    const auto begun = std::chrono::steady_clock::now();
    const bool continues = saved_.started && !goal.new_part;
    if (continues && controller_) {
        controller_->resume(settings, observer, cancel);
    } else if (continues) {
        controller_.emplace(workspace_, integrator_.method(), settings, observer, cancel, &saved_);
    } else {
        static_cast<void>(integration_state());
        controller_.emplace(workspace_, integrator_.method(), settings, observer, cancel);
        saved_.begin = settings.begin;
        saved_.output_interval = settings.output_interval;
        saved_.step = settings.step;
    }
    if (goal.new_part) saved_.settling = needs_settling_ && settings.begin < 0.0;
    Fault fault = drive();
    paused_wall_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    if (fault.kind == FaultKind::max_wall) std::tie(fault.value, fault.limit) = std::pair(paused_wall_, budget);
    if (fault.kind != FaultKind::cancelled || goal.pause == nullptr || !*goal.pause) paused_wall_ = 0.0;
    const bool settled = saved_.settling && !goal.new_part && time_ >= -1e-9 * settings.output_interval;
    if (settled && (!fault || goal.steps > 0)) end_settling();
    return fault;
}

StepSettings RunPart::settings_of(const Goal& goal) const {
    const RunSettings& run = scene_.run;
    StepSettings settings{.begin = time_,
                          .until = goal.until,
                          .step = run.step,
                          .output_interval = run.output_interval,
                          .max_steps = run.max_steps,
                          .max_wall = goal.max_wall.value_or(run.max_wall),
                          .control = run.step_control,
                          .tolerance = run.tolerance,
                          .choice = choice_.get(),
                          .pause = goal.pause};
    if (saved_.settling && !goal.new_part) {
        const double duration = scene_.parameters.start.settling_time;
        settings.begin = -duration;
        settings.until = std::min(goal.until, 0.0);
        settings.output_interval = duration / std::max(1.0, std::ceil(duration / run.output_interval * (1.0 - 1e-12)));
    }
    if (goal.steps > 0) settings.max_steps = goal.steps;
    if (!saved_.started || goal.new_part) return settings;
    if (goal.steps > 0) settings.max_steps += counters_.steps;
    settings.begin = saved_.begin;
    settings.output_interval = saved_.output_interval;
    settings.step = saved_.step;
    return settings;
}

/// A run that ended by a goal, a pause or its caller continues with the same controller.
Fault RunPart::drive() {
    integrator_.run(*controller_);
    counters_ = controller_->counters();
    local_errors_ = controller_->local_errors();
    step_ = controller_->step();
    time_ = controller_->time();
    saved_.started = true;
    rest_known_ = false;
    const Fault fault = controller_->fault();
    const auto drop = [this] {
        static_cast<void>(integration_state());
        controller_.reset();
    };
    try {
        controller_->rethrow();
    } catch (...) {
        drop();
        throw;
    }
    if (fault && fault.kind != FaultKind::cancelled && fault.kind != FaultKind::max_steps) drop();
    return fault;
}

void RunPart::end_settling() {
    time_ = 0.0;
    move_offset();
    begin(0.0, false, workspace_.energy.balance_error_ratio(), workspace_.energy.balance().relative());
}

void RunPart::move_offset() {
    if (scene_.gains == ControlGains::given) return;
    const model::ChainLayout& at = workspace_.layout();
    const model::Control& control = scene_.parameters.control;
    const double* tail = workspace_.state() + at.pulley_begin();
    const double corrected = workspace_.variator.pulleys().inputs(time_, tail).clamping[0] - scene_.parameters.clamping.driving.at(time_);
    workspace_.state_to_set()[at.control_begin()] = std::clamp(corrected, -control.authority, control.authority) / control.integral;
}

void RunPart::restore(IntegrationState from) {
    if (const char* why = from.invalid_reason()) throw SimulationError(why);
    Workspace& w = workspace_;
    const std::size_t size = static_cast<std::size_t>(w.layout().size()), tips = w.tips.phases.size();
    if (from.state.size() != size || from.phases.size() != tips || from.changed.size() != tips || from.before.size() != tips) {
        throw SimulationError(fmt::format("a state of {} unknowns and {} tips does not fit this scene: {} and {}", from.state.size(),
                                          from.phases.size(), size, tips));
    }
    forget_controller();
    std::copy(from.state.begin(), from.state.end(), w.state_to_set());
    w.tips.phases = from.phases;
    w.tips.changed = from.changed;
    w.tips.before = from.before;
    w.phases_changed();
    integrator_.method().restart();
    w.energy.load(from.energy, integrator_.method().observation_stride());
    restore_couplings(w.variator, from.couplings);
    w.heat.restart(scene_.parameters);
    if (!w.heat.load(from.heat)) throw SimulationError("the state contains malformed temperatures");
    w.warm();
    saved_ = std::move(from);
    needs_settling_ = saved_.settling;
    time_ = saved_.time;
    counters_ = saved_.counters;
}

const IntegrationState& RunPart::integration_state() const {
    if (!rest_known_ && controller_) {
        controller_->save(saved_);
        workspace_.heat.save(saved_.heat);
    }
    rest_known_ = true;
    return saved_;
}

void RunPart::inputs_changed() {
    workspace_.energy.inputs_changed(time_, true);
    if (saved_.started && !controller_) workspace_.energy.save(saved_.energy);
    rest_known_ = !controller_;
}

/// Its state is not saved.
void RunPart::forget_controller() noexcept {
    controller_.reset();
    rest_known_ = true;
}

}  // namespace cvtflow::tasks
