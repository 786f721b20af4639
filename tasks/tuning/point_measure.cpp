#include "tasks/tuning/point_measure.hpp"

#include <fmt/format.h>
#include <ctime>
#include <set>

#include "tasks/run/saved_start.hpp"

namespace cvtflow::tasks {

namespace {

constexpr double neighbourhood = 0.05;  ///< relative change of constant inputs for unseen points

/// A key whose value is a table over time, and the ends of what it takes.
struct Input {
    const Parameter* key;
    double low, high, at_start;

    [[nodiscard]] bool varies() const noexcept { return low < high; }
};

model::TimeTable& table_of(const Parameter& key, Scene& scene) { return *std::get<model::TimeTable*>(key.member(scene)); }

/// Tables over time but for those of vehicle and cycle, which act by other ones.
std::vector<Input> inputs_of(const Scene& scene) {
    Scene copy = scene;
    std::vector<Input> inputs;
    for (const Parameter& key : parameter_table()) {
        if (key.kind() != Kind::time_table || key.section() == "vehicle" || key.section() == "cycle") continue;
        const model::TimeTable& table = table_of(key, copy);
        const auto [low, high] = std::minmax_element(table.value.begin(), table.value.end());
        inputs.push_back({&key, *low, *high, table.at(0.0)});
    }
    return inputs;
}

/// All inputs held at what they are at t = 0, for as long as a point takes. Starts as a run does: without a state that fits, every choice
/// settles by itself.
OperatingPoint at_start(const Scene& scene, const PointTimes& times, const std::string& name) {
    OperatingPoint point{name, scene, times.settle, times.settle + times.average};
    point.settles = scene.parameters.start.layout == model::StartLayout::belt && fitting_start(scene) == nullptr;
    if (point.settles) point.scene.state_file.clear();
    for (const Input& input : inputs_of(scene)) {
        if (input.varies()) table_of(*input.key, point.scene) = model::TimeTable(input.at_start);
    }
    point.scene.run.until = point.until;
    return point;
}

std::string named(const Input& input, double value) { return fmt::format("{} = {:.4g} {}", input.key->key, value, input.key->unit); }

}  // namespace

std::vector<OperatingPoint> points_of(const Scene& scene, const PointTimes& times) {
    const OperatingPoint start = at_start(scene, times, "start");
    std::vector<OperatingPoint> points{start};
    for (const Input& input : inputs_of(scene)) {
        for (const double value : {input.low, input.high}) {
            if (!input.varies() || value == input.at_start) continue;
            points.push_back(start);
            points.back().name = named(input, value);
            table_of(*input.key, points.back().scene) = model::TimeTable(value);
        }
    }
    return points;
}

std::vector<OperatingPoint> unseen_points(const Scene& scene, const PointTimes& times, int count, std::uint64_t seed) {
    const std::vector<Input> inputs = inputs_of(scene);
    const std::vector<double> where = random_samples(static_cast<std::size_t>(count), inputs.size(), seed);
    std::vector<OperatingPoint> points;
    for (std::size_t n = 0; n < static_cast<std::size_t>(count); ++n) {
        OperatingPoint& point = points.emplace_back(at_start(scene, times, ""));
        if (scene.parameters.detail.pulleys == model::PulleyDetail::absent) {  // a ring has no inputs, but a speed
            double& speed = point.scene.parameters.start.ring_speed;
            speed *= 1.0 + neighbourhood * (2.0 * where[n * inputs.size()] - 1.0);
            point.name = fmt::format("start.ring_speed = {:.4g} rad/s", speed);
            continue;
        }
        for (std::size_t i = 0; i < inputs.size(); ++i) {
            const Input& input = inputs[i];
            const bool near = input.key->section() == "load" || input.key->section() == "clamping";
            if (!input.varies() && (!near || input.at_start == 0.0)) continue;
            const double low = input.varies() ? input.low : input.at_start * (1.0 - neighbourhood);
            const double high = input.varies() ? input.high : input.at_start * (1.0 + neighbourhood);
            const double value = low + where[n * inputs.size() + i] * (high - low);
            table_of(*input.key, point.scene) = model::TimeTable(value);
            point.name += (point.name.empty() ? "" : ", ") + named(input, value);
        }
    }
    return points;
}

OperatingPoint point_of_case(const Sweep& sweep, long number) {
    OperatingPoint point{fmt::format("case {}", number), scene_of_case(sweep, number), sweep.from, 0.0};
    point.until = latest_end(point.scene);
    point.settles = point.scene.state_file.empty();
    return point;
}

namespace {

/// Rows of an axis in which one of its keys is lowest or highest; texts have their first and last row.
std::set<std::size_t> extreme_rows(const Axis& axis) {
    std::set<std::size_t> rows{0, axis.rows() - 1};
    for (std::size_t key = 0; key < axis.keys.size(); ++key) {
        std::size_t lowest = 0, highest = 0;
        for (std::size_t row = 0; row < axis.rows(); ++row) {
            const auto* value = std::get_if<double>(&axis.at(row, key));
            const auto *low = std::get_if<double>(&axis.at(lowest, key)), *high = std::get_if<double>(&axis.at(highest, key));
            if (value == nullptr || low == nullptr || high == nullptr) continue;
            if (*value < *low) lowest = row;
            if (*value > *high) highest = row;
        }
        rows.insert({lowest, highest});
    }
    return rows;
}

}  // namespace

std::vector<long> corner_cases(const Sweep& sweep, std::size_t most) {
    std::vector<long> corners{0};
    for (const Axis& axis : sweep.axes) {
        std::vector<long> more;
        for (const long before : corners) {
            for (const std::size_t row : extreme_rows(axis))
                more.push_back(before * static_cast<long>(axis.rows()) + static_cast<long>(row));
        }
        corners = std::move(more);
    }
    std::erase_if(corners, [&](long number) {
        Scene scene = sweep.scene;
        sweep.apply_case(number, scene);
        return !violations(scene).empty();
    });
    if (corners.size() <= most) return corners;
    std::vector<long> picked;
    for (std::size_t i = 0; i < most; ++i) picked.push_back(corners[i * (corners.size() - 1) / (most - 1)]);
    return picked;
}

namespace {

/// Processor time of this thread [s]: what others do on the machine does not count.
double processor_time() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::string percent_of(double share) { return fmt::format("{:.2g} %", 100.0 * share); }

/// Enters the cost of a run since it began.
void record_cost(const Simulation& simulation, double began, double simulated, PointRun& run) {
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
        if (balance_error_ratio_of(*settled_) > 1.0)
            throw SimulationError(point_.scene.state_file + " is unreliable: the energy balance did not close while settling");
        return;
    }
    settled_with_ = chosen_scene(point_.scene, {finest_, RunSettings{}.method}, 0.0);
    settled_with_.state_file.clear();
    Simulation simulation(settled_with_, Schedule{});
    SilentObserver silent;
    if (simulation.needs_settling()) {
        if (const Fault fault = advance(simulation, {.until = 0.0}, silent)) throw SimulationError("settling: " + fault.message());
        if (simulation.balance_error_ratio() > 1.0) throw SimulationError("settling: its energy balance does not close");
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
    run.step = choice.share * automatic_step(*simulation);
    geometric.run.step = scene.run.step = AutoNumber(run.step);
    simulation->reset(geometric, settled ? &state : nullptr);
    return simulation;
}

PointRun PointMeasure::run(const TuneChoice& choice, engine::SavedState* state) {
    PointRun run;
    Scene scene = chosen_scene(point_.scene, choice, 0.0);
    const std::unique_ptr<Simulation> simulation = begin(choice, scene, !point_.settles, run);
    OutputReader reader(simulation->workspace().variator, outputs_, scene.run.followed_pin, point_.from);
    SilentObserver silent;
    Fault fault;
    if (simulation->needs_settling()) fault = advance(*simulation, {.until = 0.0}, silent);
    if (!fault && point_.from > simulation->time()) fault = advance(*simulation, {.until = point_.from}, silent);
    const double before = simulation->balance_error_ratio();
    if (!fault && state != nullptr) *state = simulation->saved_state();
    const double began = processor_time(), begin = simulation->time();
    if (!fault) fault = advance(*simulation, {.until = point_.until, .new_part = true}, reader);
    record_cost(*simulation, began, std::max(simulation->time() - begin, 1e-9), run);
    run.values = reader.values();
    std::string notes;
    name_notes(reader.means(), simulation->workspace().energy.balance(), notes);
    run.unsteady = notes.find("unsteady") != std::string::npos;
    if (fault)
        run.objection = fault.message();
    else if (std::max(before, simulation->balance_error_ratio()) > 1.0)
        run.objection = "unreliable: its energy balance does not close";
    return run;
}

PointRun PointMeasure::trial(const TuneChoice& choice, double duration) {
    PointRun run;
    Scene scene = chosen_scene(point_.scene, choice, 0.0);
    const std::unique_ptr<Simulation> simulation = begin(choice, scene, true, run);
    Scene fixed = scene;  // estimates of the spectrum, frequent in the beginning, would count too much
    fixed.state_file.clear();
    fixed.run.step = AutoNumber(run.step > 0.0 ? run.step : automatic_step(*simulation));
    const engine::SavedState state = simulation->saved_state();
    simulation->reset(fixed, &state);
    SilentObserver silent;
    const double began = processor_time(), begin = simulation->time();
    const Fault fault = advance(*simulation, {.until = begin + duration}, silent);
    record_cost(*simulation, began, std::max(simulation->time() - begin, 1e-9), run);
    if (fault) run.objection = fault.message();
    run.hash = simulation->hash();
    return run;
}

std::vector<double> PointMeasure::errors(const PointRun& run, const PointRun& expected) const {
    std::vector<double> errors;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        const bool lost = !run.objection.empty() || run.values.size() != outputs_.size();
        errors.push_back(lost ? std::numeric_limits<double>::infinity() : outputs_[i].error(run.values[i], expected.values[i]));
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
