#include "tasks/tuning/dial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <limits>
#include <sstream>

#include "tasks/batch/case_engine.hpp"
#include "tasks/run/saved_start.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::tasks {

std::string TuneChoice::text() const {
    const std::string steps = step > 0.0     ? fmt::format("step {} s", number_text(step))
                              : share == 1.0 ? "automatic step"
                                             : fmt::format("1/{:g} of the automatic step", 1.0 / share);
    return fmt::format("{}, {}, {}", detail.empty() ? "own detail" : detail, method, steps);
}

Scene chosen_scene(const Scene& scene, const TuneChoice& choice, double step) {
    Scene chosen = scene;
    std::istringstream words(choice.detail);
    std::string word;
    if (std::getline(words, word, ' ')) apply_detail(chosen, word);
    while (std::getline(words, word, ' ')) set_value(chosen, word);
    chosen.run.method = choice.method;
    chosen.run.step = AutoNumber(step);
    chosen.run.step_control = StepControl::fixed;
    return chosen;
}

double largest(const std::vector<double>& errors) noexcept {
    return errors.empty() ? 0.0 : *std::max_element(errors.begin(), errors.end());
}

namespace {

/// Processor time of this thread [s]: what others do on the machine does not count.
double processor_time() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

TuneChoice finest(double share) { return {std::string(detail_presets().back().name), RunSettings{}.method, share}; }

}  // namespace

DialSweep::DialSweep(OperatingPoints points, const engine::Cancellation& cancel)
    : points_(std::move(points)), cancel_(cancel), references_(points_.cases.size()) {
    Sweep& sweep = points_.sweep;
    sweep.records = false;
    sweep.scene.run.schedule = "serial";
    sweep.scene.run.threads = 1;
    sweep.scene.run.max_steps = 0;
    sweep.scene.run.max_wall = 0.0;
}

void DialSweep::begin_budget(double seconds) noexcept {
    limited_ = seconds > 0.0;
    end_ = std::chrono::steady_clock::now() +
           std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(std::min(seconds, 1e9)));
}

double DialSweep::left() const noexcept {
    return limited_ ? std::max(1e-9, std::chrono::duration<double>(end_ - std::chrono::steady_clock::now()).count()) : 0.0;
}

Scene DialSweep::scene_at(const TuneChoice& choice, double step, std::size_t point) const {
    Scene scene = chosen_scene(points_.sweep.scene, choice, step);
    scene.state_file.clear();
    points_.sweep.apply_case(points_.cases[point], scene);
    return scene;
}

/// State of the scene as a choice begins with it; nullptr: the choice settles by itself.
StartStates::State DialSweep::start_of(const Scene& chosen, std::size_t point) const {
    const Scene scene = scene_of_case(points_.sweep, points_.cases[point]);
    if (scene.state_file.empty()) return nullptr;
    StartStates::State saved = saved_start(scene);
    if (balance_error_ratio_of(*saved) > 1.0)
        throw SimulationError(scene.state_file + " is unreliable: the energy balance did not close while settling");
    const model::Parameters settled = settled_parameters(*saved, scene);
    if (model::layout_of(settled) == model::layout_of(chosen.parameters)) return saved;
    return std::make_shared<const engine::SavedState>(convert_state(*saved, settled, chosen.parameters));
}

std::unique_ptr<Simulation> DialSweep::begin(const TuneChoice& choice, double step, std::size_t point) const {
    const Scene scene = scene_at(choice, step, point);
    auto simulation = std::make_unique<Simulation>(scene, Schedule{});
    if (const StartStates::State state = start_of(scene, point)) simulation->reset(scene, state.get());
    return simulation;
}

/// Advances up to the end of the budget. @throws BudgetUsedUp, SimulationError: interrupted
Fault DialSweep::advance(Simulation& simulation, Goal goal) const {
    goal.max_wall = left();
    SilentObserver silent;
    const Fault fault = simulation.advance(goal, silent, cancel_);
    if (fault.kind == FaultKind::max_wall) throw BudgetUsedUp();
    if (cancel_.requested()) throw SimulationError("interrupted");
    return fault;
}

PointRun DialSweep::run(const TuneChoice& choice, double step, std::size_t point) {
    Sweep sweep = points_.sweep;
    sweep.scene = chosen_scene(sweep.scene, choice, step);
    sweep.scene.state_file.clear();
    sweep.scene.run.max_wall = left();
    sweep.start = StartMode::scene;
    StartStates starts(sweep, {}, start_of(scene_at(choice, step, point), point));
    BatchControl control(0.0, cancel_);
    CaseEngine engine(sweep, starts, control, {});
    const CaseResult& result = engine.run_from_own_start(points_.cases[point]);
    if (cancel_.requested()) throw SimulationError("interrupted");
    if (result.status == CaseStatus::budget) throw BudgetUsedUp();
    PointRun run{result.scalars, result.error, result.notes.find("unsteady") != std::string::npos};
    if (result.status == CaseStatus::unreliable) run.objection = "unreliable: its energy balance does not close";
    return run;
}

double DialSweep::step_of(const TuneChoice& choice) {
    if (choice.step > 0.0 || choice.share == 1.0) return choice.step;
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t point = 0; point < size(); ++point) shortest = std::min(shortest, automatic_step(*begin(choice, 0.0, point)));
    return choice.share * shortest;
}

PointCost DialSweep::cost(const TuneChoice& choice, std::size_t point) {
    constexpr long before = 100, counted = 300;  // steps: in the beginning many tips first touch
    const double step = choice.step > 0.0 ? choice.step : automatic_step(*begin(choice, 0.0, point));
    const std::unique_ptr<Simulation> simulation = begin(choice, step, point);  // estimates of the spectrum would count too much
    Fault fault = advance(*simulation, {.steps = before, .new_part = true});
    const long first = fault ? simulation->counters().steps : 0;  // else settling has ended, and the next steps count anew
    const double began = processor_time();
    if (!fault || fault.kind == FaultKind::max_steps) fault = advance(*simulation, {.steps = counted});
    const double seconds = processor_time() - began, all = static_cast<double>(simulation->counters().steps);
    if (fault && fault.kind != FaultKind::max_steps) throw SimulationError(fault.message());
    const double unknowns = simulation->workspace().layout().size();
    return {seconds / (std::max(1.0, all - static_cast<double>(first)) * step),
            static_cast<double>(simulation->counters().evaluations) * unknowns / (std::max(1.0, all) * step)};
}

engine::SavedState DialSweep::settled_state(const TuneChoice& choice, double step) {
    const std::unique_ptr<Simulation> simulation = begin(choice, step, 0);
    Fault fault;
    if (simulation->needs_settling()) fault = advance(*simulation, {.until = 0.0});
    if (!fault) fault = advance(*simulation, {.until = points_.sweep.from});
    if (fault) throw SimulationError(fault.message());
    engine::SavedState state = simulation->saved_state();
    const model::Parameters& parameters = simulation->workspace().parameters;
    // the run begins at t = 0, and so do governor and ledger
    turn_shaft(state.state.data(), parameters, 0, -parameters.drive.speed.integral(points_.sweep.from));
    state.time = 0.0;
    state.state.resize(static_cast<std::size_t>(model::layout_of(parameters).ledger_begin()));
    return state;
}

std::vector<double> DialSweep::errors(const PointRun& run, const PointRun& expected) const {
    std::vector<double> errors;
    for (std::size_t i = 0; i < points_.outputs.size(); ++i)
        errors.push_back(run.objection.empty() && !run.values.empty() ? points_.outputs[i].error(run.values[i], expected.values[i])
                                                                      : std::numeric_limits<double>::infinity());
    return errors;
}

const DialSweep::Reference& DialSweep::reference(std::size_t point, double agreement, const std::function<void(double)>& before) {
    Reference& found = references_[point];
    if (found.run != nullptr && found.agreement <= agreement) return found;
    try {
        refine(point, agreement, before);
    } catch (const std::exception& error) {
        if (cancel_.requested()) throw;
        found.run = nullptr;
        found.text = error.what();
    }
    return found;
}

void DialSweep::refine(std::size_t point, double agreement, const std::function<void(double)>& before) {
    Reference& found = references_[point];
    const std::string name = finest(1.0).detail;
    double off = 0.0;
    for (const double share : {0.5, 0.25, 0.125, 0.0625}) {
        if (!found.runs.contains(share)) {
            if (before) before(share);
            found.runs[share] = run(finest(share), share * automatic_step(*begin(finest(1.0), 0.0, point)), point);
        }
        const PointRun& now = found.runs[share];
        if (!now.objection.empty())
            throw SimulationError(fmt::format("the reference ({} at {:g} of its automatic step): {}", name, share, now.objection));
        if (share == 0.5) continue;
        off = largest(errors(found.runs[2.0 * share], now));
        if (!(off <= agreement)) continue;
        found.run = &now;
        found.share = share;
        found.agreement = off;
        found.text = fmt::format("{}, {} at {:g} of its automatic step; twice that step has errors of {:.2g} %{}", name,
                                 method_of(scene_at(finest(share), 0.0, point)), share, 100.0 * off,
                                 now.unsteady ? "; unsteady: its means still change (--settling, --average)" : "");
        return;
    }
    throw SimulationError(
        fmt::format("{} has not converged at a sixteenth of its automatic step: twice that step has errors of {:.2g} %, above {:.2g} %",
                    name, 100.0 * off, 100.0 * agreement));
}

}  // namespace cvtflow::tasks
