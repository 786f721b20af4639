#include "tasks/tuning/point_measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "tasks/run/saved_start.hpp"
#include "tasks/tuning/detail_state.hpp"

namespace cvtflow::tasks {

namespace {

/// Processor time of this thread [s]: what others do on the machine does not count.
double processor_time() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::string percent_of(double share) { return fmt::format("{:.2g} %", 100.0 * share); }

/// What a run cost since it began.
void book(const Simulation& simulation, double began, double simulated, PointRun& run) {
    run.seconds = (processor_time() - began) / simulated;
    run.work = static_cast<double>(simulation.counters().evaluations) * simulation.workspace().layout().size() / simulated;
}

}  // namespace

std::string TuneChoice::text() const {
    const std::string step = share == 1.0 ? "automatic step" : fmt::format("1/{:g} of the automatic step", 1.0 / share);
    return fmt::format("{}, {}, {}", detail.empty() ? "own detail" : detail, method, step);
}

Scene chosen_scene(const Scene& scene, const TuneChoice& choice, double step) {
    Scene chosen = scene;
    if (!choice.detail.empty()) apply_detail(chosen, choice.detail);
    chosen.run.method = choice.method;
    chosen.run.step = AutoNumber(step);
    chosen.run.step_control = StepControl::fixed;
    return chosen;
}

double largest(const std::vector<double>& errors) noexcept {
    return errors.empty() ? 0.0 : *std::max_element(errors.begin(), errors.end());
}

PointMeasure::PointMeasure(OperatingPoint point, std::string finest, std::span<const TunedOutput> outputs,
                           const engine::Cancellation& cancel, const Deadline& deadline)
    : point_(std::move(point)), finest_(std::move(finest)), outputs_(outputs), cancel_(cancel), deadline_(deadline) {
    point_.scene.run.schedule = "serial";
    point_.scene.run.threads = 1;
    point_.scene.run.max_steps = 0;
    point_.scene.run.max_wall = 0.0;
}

Fault PointMeasure::advance(Simulation& simulation, Goal goal, RunObserver& observer) {
    goal.max_wall = deadline_.left();
    const Fault fault = simulation.advance(goal, observer, cancel_);
    if (fault.kind == FaultKind::max_wall) throw BudgetUsedUp();
    return fault;
}

/// The scene's state if it fits, else that of its finest detail after settling with automatic steps.
void PointMeasure::settle_finest() {
    if (settled_) return;
    if (const auto saved = fitting_start(point_.scene)) {
        settled_ = *saved;
        settled_with_ = point_.scene;
        settled_with_.parameters = settled_parameters(*saved, point_.scene);
        if (suspicion_of(*settled_) > 1.0)
            throw SimulationError(point_.scene.state_file + " is unreliable: the energy balance did not close while settling");
        return;
    }
    settled_with_ = chosen_scene(point_.scene, {finest_, RunSettings{}.method}, 0.0);
    settled_with_.state_file.clear();
    Simulation simulation(settled_with_, Schedule{});
    SilentObserver nobody;
    if (simulation.needs_settling()) {
        if (const Fault fault = advance(simulation, {.until = 0.0}, nobody)) throw SimulationError("settling: " + fault.message());
        if (simulation.suspicion() > 1.0) throw SimulationError("settling: its energy balance does not close");
    }
    settled_ = simulation.saved_state();
}

engine::SavedState PointMeasure::start(const Scene& scene) {
    settle_finest();
    if (model::layout_of(settled_with_.parameters) == model::layout_of(scene.parameters)) return *settled_;
    engine::SavedState state = convert_state(*settled_, settled_with_.parameters, scene.parameters);
    state.attributes.clear();
    return state;
}

/// A simulation at its start, with the step that the choice means there. A start that does not settle by itself is the common one.
std::unique_ptr<Simulation> PointMeasure::begin(const TuneChoice& choice, Scene& scene, bool settled, PointRun& run) {
    Scene geometric = scene;
    geometric.state_file.clear();
    auto simulation = std::make_unique<Simulation>(geometric, Schedule{});
    const engine::SavedState state = settled ? start(scene) : engine::SavedState{};
    if (settled) simulation->reset(geometric, &state);
    if (choice.share == 1.0) return simulation;
    run.step = choice.share * simulation->automatic_step();
    geometric.run.step = scene.run.step = AutoNumber(run.step);
    simulation->reset(geometric, settled ? &state : nullptr);
    return simulation;
}

PointRun PointMeasure::run(const TuneChoice& choice) { return measured(choice, !point_.settles, nullptr); }
PointRun PointMeasure::run(const TuneChoice& choice, engine::SavedState& state) { return measured(choice, !point_.settles, &state); }

PointRun PointMeasure::measured(const TuneChoice& choice, bool settled, engine::SavedState* state) {
    PointRun run;
    Scene scene = chosen_scene(point_.scene, choice, 0.0);
    const std::unique_ptr<Simulation> simulation = begin(choice, scene, settled, run);
    OutputReader reader(simulation->variator(), outputs_, scene.run.followed_pin, point_.from);
    SilentObserver nobody;
    Fault fault;
    if (simulation->needs_settling()) fault = advance(*simulation, {.until = 0.0}, nobody);
    if (!fault && point_.from > simulation->time()) fault = advance(*simulation, {.until = point_.from}, nobody);
    const double before = simulation->suspicion();
    if (!fault && state != nullptr) *state = simulation->saved_state();
    const double began = processor_time(), begin = simulation->time();
    if (!fault) fault = advance(*simulation, {.until = point_.until, .anew = true}, reader);
    book(*simulation, began, std::max(simulation->time() - begin, 1e-9), run);
    run.values = reader.values();
    std::string notes;
    reader.watch().means().name_notes(simulation->energy().balance(), notes);
    run.unsteady = notes.find("unsteady") != std::string::npos;
    if (fault)
        run.objection = fault.message();
    else if (std::max(before, simulation->suspicion()) > 1.0)
        run.objection = "unreliable: its energy balance does not close";
    return run;
}

PointRun PointMeasure::trial(const TuneChoice& choice, double duration) {
    PointRun run;
    Scene scene = chosen_scene(point_.scene, choice, 0.0);
    const std::unique_ptr<Simulation> simulation = begin(choice, scene, true, run);
    Scene fixed = scene;  // looking at the spectrum, often in the beginning, would count too much
    fixed.state_file.clear();
    fixed.run.step = AutoNumber(run.step > 0.0 ? run.step : simulation->automatic_step());
    const engine::SavedState state = simulation->saved_state();
    simulation->reset(fixed, &state);
    SilentObserver nobody;
    const double began = processor_time(), begin = simulation->time();
    const Fault fault = advance(*simulation, {.until = begin + duration}, nobody);
    book(*simulation, began, std::max(simulation->time() - begin, 1e-9), run);
    if (fault) run.objection = fault.message();
    run.hash = simulation->hash();
    return run;
}

std::vector<double> PointMeasure::errors(const PointRun& run, const PointRun& should) const {
    std::vector<double> errors;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        const bool lost = !run.objection.empty() || run.values.size() != outputs_.size();
        errors.push_back(lost ? std::numeric_limits<double>::infinity() : outputs_[i].error(run.values[i], should.values[i]));
    }
    return errors;
}

const PointRun* PointMeasure::reference(double agreement, const std::function<void(double)>& before) {
    if (reference_ != nullptr && agreement_ <= agreement) return reference_;
    if (!objection_.empty() && references_.empty()) return nullptr;
    double off = 0.0;
    for (const double share : {0.5, 0.25, 0.125, 0.0625}) {
        if (!references_.contains(share)) {
            if (before) before(share);
            try {
                references_[share] = run({finest_, RunSettings{}.method, share});
            } catch (const SimulationError& error) {
                objection_ = error.what();
                return nullptr;
            }
        }
        const PointRun& now = references_[share];
        if (!now.objection.empty()) {
            objection_ = fmt::format("the reference ({} at {:g} of its automatic step): {}", finest_, share, now.objection);
            return nullptr;
        }
        if (share == 0.5) continue;
        off = largest(errors(references_[2.0 * share], now));
        if (!(off <= agreement)) continue;
        agreement_ = off;
        reference_text_ = fmt::format("{}, {} at {:g} of its automatic step; twice that step has errors of {}{}", finest_,
                                      method_of(chosen_scene(point_.scene, {finest_, RunSettings{}.method}, 0.0)), share, percent_of(off),
                                      now.unsteady ? "; unsteady: its means still change (--settling, --average)" : "");
        objection_.clear();
        return reference_ = &now;
    }
    objection_ = fmt::format("{} has not converged at a sixteenth of its automatic step: twice that step has errors of {}, above {}",
                             finest_, percent_of(off), percent_of(agreement));
    return nullptr;
}

}  // namespace cvtflow::tasks
