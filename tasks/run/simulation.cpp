#include "tasks/run/simulation.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>

#include "engine/base/hash.hpp"
#include "engine/executor/cancellation.hpp"
#include "engine/record/run/state_file.hpp"
#include "model/start/start_state.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/saved_start.hpp"
#include "tasks/schedule/schedule.hpp"

namespace cvtflow::tasks {

namespace {

/// Rest of a budget that is used up: 0 would mean no budget [s].
constexpr double shortest_budget = 1e-9;

/// Couplings and hydraulics take over where a run begins: at t = 0 after settling, or at a start that needs none.
void couple(Workspace& w, double time) {
    if (w.layout().pulley_size == 0) return;
    double* const tail = w.state_to_set() + w.layout().pulley_begin();
    w.variator.pulleys().inputs().fill_cylinders(time, tail);
    w.variator.couple(time, tail);
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
    if (!needs_settling_) couple(w, time_);
    if (!scene_.run.step.automatic())
        choice_.reset();
    else if (choice_ == nullptr)
        choice_ = std::make_unique<AutoStep>(w.variator, scene_.parameters, integrator_.chosen_method());
    w.energy.restart(integrator_.method().observation_stride());
    w.heat.restart(scene_.parameters, scene_.run.until.automatic());
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

long RunPart::outputs_together() const noexcept {
    return integrator_.method().at_transition() == AtTransition::inside ? scene_.run.outputs_together() : 1;
}

StepSettings RunPart::settings_of(const Goal& goal) const {
    const RunSettings& run = scene_.run;
    StepSettings settings{.begin = time_,
                          .until = goal.until,
                          .step = run.step,
                          .output_interval = run.output_interval * static_cast<double>(goal.rows_between ? outputs_together() : 1),
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
        settings.output_interval = duration / std::max(1.0, std::ceil(duration / settings.output_interval * (1.0 - 1e-12)));
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
    const JudgedBalance judged = workspace_.energy.judged();
    begin(0.0, false, judged.ratio, judged.ratio > 1.0 ? judged.relative : workspace_.energy.balance().relative());
}

void RunPart::move_offset() {
    if (scene_.gains == ControlGains::given || workspace_.variator.pulleys().torques().held().sheave) return;
    const model::ChainLayout& at = workspace_.layout();
    const model::Control& control = scene_.parameters.control;
    const double* tail = workspace_.state() + at.pulley_begin();
    const double corrected =
        workspace_.variator.pulleys().inputs().at(time_, tail).clamping[0] - scene_.parameters.clamping.driving.at(time_);
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
    w.energy.restart(integrator_.method().observation_stride());
    w.heat.restart(scene_.parameters, scene_.run.until.automatic());
    read_sums(w, from.energy);
    w.variator.hold(from.held);
    w.warm();
    saved_ = std::move(from);
    needs_settling_ = saved_.settling;
    time_ = saved_.time;
    counters_ = saved_.counters;
}

const IntegrationState& RunPart::integration_state() const {
    if (!rest_known_ && controller_) controller_->save(saved_);
    rest_known_ = true;
    saved_.held = workspace_.variator.pulleys().torques().held();
    return saved_;
}

void RunPart::inputs_changed() {
    workspace_.energy.inputs_changed(time_, true);
    if (saved_.started && !controller_) write_sums(workspace_, saved_.energy);
    rest_known_ = !controller_;
}

/// Discards the controller without its state.
void RunPart::forget_controller() noexcept {
    controller_.reset();
    rest_known_ = true;
}

namespace {

std::unique_ptr<Integrator> integrator_of(const Scene& scene, const std::vector<Schedule>& candidates, const ChooserOptions& options,
                                          engine::StampRecorder* recorder) {
    std::unique_ptr<Integrator> integrator;
    try {
        integrator = std::make_unique<Integrator>(scene.parameters, scene.run.method, candidates, options, recorder);
    } catch (const MethodRefused& refused) {
        throw SimulationError(fmt::format("run.method: {}", refused.what()));
    }
    if (scene.run.step_control != StepControl::fixed && integrator->method().error_estimate().power == 0) {
        throw SimulationError(
            fmt::format("run.step_control: '{}' has no error estimate; only \"fixed\" steps are possible (cvtflow list methods --all)",
                        integrator->chosen_method().name()));
    }
    return integrator;
}

}  // namespace

Simulation::Simulation(const Scene& scene) : Simulation(scene, schedules_for(scene), ChooserOptions{}) {}

Simulation::Simulation(const Scene& scene, const Schedule& schedule, engine::StampRecorder* recorder, const model::StartState* start)
    : Simulation(scene, std::vector{schedule}, ChooserOptions{}, recorder, start) {}

Simulation::Simulation(const Scene& scene, const std::vector<Schedule>& candidates, const ChooserOptions& options,
                       engine::StampRecorder* recorder, const model::StartState* start)
    : scene_(scene),
      integrator_(integrator_of(scene_, candidates, options, recorder)),
      workspace_(&integrator_->workspace()),
      part_(scene_, *integrator_) {
    const auto saved = start != nullptr || scene_.state_file.empty() ? nullptr : saved_start(scene_);
    if (saved != nullptr) start_differences_ = tasks::start_differences(*saved, scene_);
    begin_with(saved.get(), start);
}

void Simulation::reset(const Scene& scene, const engine::SavedState* saved, const model::StartState* placed) {
    const bool same_machine = model::Variator::same_machine(scene_.parameters, scene.parameters);
    if (!same_machine) checked_start_.reset();
    part_.forget(same_machine);
    scene_ = scene;
    integrator_->adopt(scene_.parameters);
    start_differences_.clear();
    begin_with(saved, placed);
}

bool fits(const Simulation& simulation, const Scene& scene) {
    return method_of(scene) == simulation.method().name() && model::layout_of(scene.parameters) == simulation.workspace().layout();
}

namespace {

constexpr std::size_t ledger_size = model::loss_kinds + model::work_kinds;

/// The phase in terms of the present scene: without stick and slip a tip just touches; with them, a start finds which of both.
[[nodiscard]] model::Phase adopted(std::uint8_t saved, bool stick_slip) {
    const auto phase = static_cast<model::Phase>(saved);
    if (phase == model::Phase::free || (phase == model::Phase::touching) == !stick_slip) return phase;
    return stick_slip ? model::Phase::free : model::Phase::touching;
}

/// The numbers of a state behind its pulleys: integrals of up to two controllers, hydraulics, ledger.
struct SavedTail {
    std::size_t integrals, first_order;  ///< first_order: before the ledger
    bool ledger, fits;

    /// @param count of all numbers behind the pulleys
    explicit SavedTail(std::size_t count)
        : integrals(count % ledger_size % model::hydraulic_unknowns),
          first_order(count % ledger_size),
          ledger(count >= ledger_size),
          fits(integrals <= 2 && count < 2 * ledger_size) {}
};

/// Links and pulleys must fit; control and ledger, which a saved state may have or lack, continue, or begin at zero if they are new.
/// Cylinders begin with the clamping forces that act here (couple).
void take_state(Workspace& w, const Scene& scene, const engine::SavedState& saved, const std::vector<std::string>& differences) {
    const model::ChainLayout& at = w.layout();
    const std::size_t mechanical = static_cast<std::size_t>(at.control_begin());
    const SavedTail tail(saved.state.size() - std::min(saved.state.size(), mechanical));
    if (saved.state.size() < mechanical || !tail.fits || saved.phases.size() != w.tips.phases.size()) {
        std::string message = fmt::format("{}start.state: {} contains {} unknowns, this scene has {}", scene.state_place, scene.state_file,
                                          saved.state.size(), at.size());
        for (const std::string& line : differences) message += "\n  " + line;
        throw SimulationError(message);
    }
    if (std::any_of(saved.phases.begin(), saved.phases.end(),
                    [](std::uint8_t phase) { return phase > static_cast<std::uint8_t>(model::Phase::slip); })) {
        throw SimulationError(fmt::format("{}start.state: {} contains an invalid tip phase", scene.state_place, scene.state_file));
    }
    const auto behind = saved.state.begin() + static_cast<std::ptrdiff_t>(mechanical);
    std::fill_n(std::copy(saved.state.begin(), behind, w.state_to_set()), static_cast<std::size_t>(at.size()) - mechanical, 0.0);
    const std::size_t controllers = static_cast<std::size_t>(at.controls) % model::hydraulic_unknowns;
    std::copy_n(behind, std::min(tail.integrals, controllers), w.state_to_set() + at.control_begin());
    if (at.ledger && tail.ledger)
        std::copy_n(behind + static_cast<std::ptrdiff_t>(tail.first_order), ledger_size, w.state_to_set() + at.ledger_begin());
    const bool stick_slip = scene.parameters.detail.stick_slip;
    std::transform(saved.phases.begin(), saved.phases.end(), w.tips.phases.begin(),
                   [=](std::uint8_t phase) { return adopted(phase, stick_slip); });
}

}  // namespace

/// A state of another machine begins with a shock that no method resolves: the geometric start settles instead.
void Simulation::begin_with(const engine::SavedState* saved, const model::StartState* placed) {
    if (saved != nullptr) {
        const std::uint64_t hash = content_hash(*saved);
        if (!checked_start_ || checked_start_->hash != hash) checked_start_ = {hash, start_misfit(*saved, scene_)};
        if (checked_start_->misfit <= start_misfit_tolerance) {
            take_state(*workspace_, scene_, *saved, start_differences_);
            part_.begin(saved->time, false, saved->balance_error_ratio);  // inputs and the governor's angle continue from there
            return;
        }
        const std::string unfit = unfit_text(checked_start_->misfit);
        require_time_to_settle(scene_, unfit);
        start_differences_.push_back(unfit + ": the run settles again");
    }
    const model::StartState made = placed == nullptr ? model::start_state(scene_.parameters) : model::StartState{};
    const model::StartState& start = placed == nullptr ? made : *placed;
    std::copy(start.state.begin(), start.state.end(), workspace_->state_to_set());
    workspace_->tips.phases = start.phases;
    const bool settles = scene_.parameters.start.layout == model::StartLayout::belt && scene_.parameters.start.settling_time > 0.0;
    part_.begin(settles ? -scene_.parameters.start.settling_time : 0.0, settles);
}

std::uint64_t Simulation::hash() const noexcept {
    const std::vector<model::Phase>& phases = workspace_->tips.phases;
    engine::Hash hash;
    hash.add(std::span<const double>(workspace_->state(), static_cast<std::size_t>(workspace_->layout().size())));
    hash.add(std::span<const std::uint8_t>(reinterpret_cast<const std::uint8_t*>(phases.data()), phases.size()));
    return hash.value();
}

engine::SavedState Simulation::saved_state() const {
    engine::SavedState saved{head_of(scene_, std::string(method().name()))};
    saved.step = step();
    saved.balance_error_ratio = balance_error_ratio();
    saved.time = time();
    saved.state.assign(workspace_->state(), workspace_->state() + workspace_->layout().size());
    for (const model::Phase phase : workspace_->tips.phases) saved.phases.push_back(static_cast<std::uint8_t>(phase));
    return saved;
}

double automatic_step(const Simulation& simulation) {
    const Workspace& w = simulation.workspace();
    return AutoStep(w.variator, w.parameters, simulation.method()).longest(simulation.time(), w.state(), w.tips.phases.data());
}

LargestStep largest_step(const Simulation& simulation) {
    const Workspace& w = simulation.workspace();
    AutoStep step(w.variator, w.parameters, simulation.method());
    (void)step.longest(simulation.time(), w.state(), w.tips.phases.data());
    return step.largest();
}

PlainSlope::PlainSlope(const model::Variator& variator, const model::PhaseRule& rule)
    : variator_(variator),
      rule_(rule),
      scratch_(variator.layout()),
      phases_(static_cast<std::size_t>(model::tips_per_link * variator.layout().links), model::Phase::free) {}

void PlainSlope::operator()(double t, const double* x, double* out) noexcept {
    const model::ChainLayout& at = variator_.layout();
    if (at.pulley_size != 0) {
        variator_.pulleys().motions(x + at.pulley_begin(), scratch_.sheaves);
        for (int link = 0; link < at.links; ++link) {
            model::TipProbe probe;
            model::NeighbourWindow strip;
            variator_.chain().probe(strip.of(at, x, link), scratch_.sheaves, true, probe);
            for (int tip = 0; tip < model::tips_per_link; ++tip) {
                phases_[static_cast<std::size_t>(model::tips_per_link * link + tip)] =
                    rule_.next(model::Phase::free, {probe.depth[tip], probe.slip[tip]});
            }
        }
    }
    model::right_hand_side(variator_, t, x, phases_.data(), out, scratch_);
}

std::string unreliable_text(double balance_error_ratio, const AutoNumber& setting, double step) {
    const std::string advice = setting.automatic()
                                   ? fmt::format("run.step = \"auto\" is too long here; use {:.2g} s, half of the last step", 0.5 * step)
                                   : "use a shorter step, or run.step = \"auto\"";
    return fmt::format("unreliable: the residual of the energy balance is {:.2g} times the tolerance; {}", balance_error_ratio, advice);
}

std::string stable_text(const std::string& method, double step) {
    return fmt::format("{} is stable for steps up to about {:.2g} s here", method, step);
}

}  // namespace cvtflow::tasks
