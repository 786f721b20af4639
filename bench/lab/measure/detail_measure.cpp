#include "bench/lab/measure/detail_measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <ranges>
#include <utility>
#include <variant>

#include "bench/lab/text/text.hpp"
#include "bench/study/state_file.hpp"
#include "model/observe/observation.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/units.hpp"
#include "tasks/tuning/point_measure.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

/// Columns of a variant, in order.
enum { tight, slack, tip, slip, speed_ratio, thrust_ratio };
const std::vector<tasks::TunedOutput>& shown() {
    static const auto outputs = tasks::tuned_outputs({"tight_tension", "slack_tension", "tips", "slip", "ratio", "thrust_ratio"}, true);
    return outputs;
}

/// Averages over both halves of a run.
struct Averager final : tasks::RunObserver {
    Averager(const tasks::Simulation& simulation, double from, double until)
        : observer(simulation.workspace().variator),
          middle(0.5 * (from + until)),
          first(simulation.workspace().variator, shown(), 0, from),
          second(simulation.workspace().variator, shown(), 0, middle) {}
    void output(double time, const tasks::Workspace& w, const tasks::Counters& counters) override {
        const model::Observation& now = w.observed_by(observer, time);
        watch.add(now, w);
        if (!begun) begin = {now.time, now.ratio};
        begun = true;
        end = {now.time, now.ratio};
        (time < middle ? first : second).output(time, w, counters);
    }
    void transition(const tasks::TransitionRecord&) override {}

    /// Mean of the columns over both halves.
    [[nodiscard]] double mean(int which) const {
        const auto at = static_cast<std::size_t>(which);
        return 0.5 * (first.values()[at] + second.values()[at]);
    }

    struct Ratio {
        double time = 0.0, ratio = 0.0;
    };
    model::Observer observer;
    double middle;
    tasks::OutputReader first, second;
    RunWatch watch;
    Ratio begin, end;
    bool begun = false;
};

/// Two integrations with separate energy balances: the first one contains the jolt of the converted state. Status: a fault, or the watch of
/// the second with the larger balance error of both.
void settle_and_average(tasks::Simulation& simulation, double settle, Averager& seen, double until, DetailOutcome& outcome) {
    tasks::SilentObserver silent;
    tasks::Fault fault = simulation.advance({.until = settle, .new_part = true}, silent, catch_interrupts());
    const double before = simulation.balance_error_ratio();
    if (!fault) fault = simulation.advance({.until = until, .new_part = true}, seen, catch_interrupts());
    outcome.watch = seen.watch.result(simulation.workspace().energy, before);
    outcome.status = outcome.watch.status(fault);
    outcome.fault = fault ? fault.message() : unreliable_remark(fault, outcome.watch);
    if (outcome.status == "unreliable") outcome.fault += "; use a shorter --step";
}

/// Minimum of several, because the machine may be busy.
double cost_of(const tasks::Simulation& simulation) {
    const tasks::Workspace& w = simulation.workspace();
    model::EvaluationScratch scratch(w.layout());
    std::vector<double> slope(static_cast<std::size_t>(w.layout().size()));
    double best = 1.0;
    for (int repetition = 0; repetition < 200; ++repetition) {
        const auto begin = std::chrono::steady_clock::now();
        for (int k = 0; k < 5; ++k) model::right_hand_side(w.variator, 0.0, w.state(), w.tips.phases.data(), slope.data(), scratch);
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() / 5.0);
    }
    return best;
}

tasks::Scene scene_of(const DetailArguments& arguments, const std::string& name, const DetailVariant& v, const std::string& until,
                      std::vector<std::string> more = {}) {
    SceneArguments scene;
    scene.scene = name;
    scene.settings = {v.plates == model::PlateDetail::each ? "detail.plates=each" : "detail.plates=lumped",
                      fmt::format("detail.joint_points={}", v.joint_points),
                      v.pulleys == model::PulleyDetail::elastic ? "detail.pulleys=elastic" : "detail.pulleys=rigid",
                      fmt::format("detail.pins={}", name_of(v.pins)),
                      fmt::format("detail.mass_scaling={}", v.mass_scaling),
                      "run.method=" + arguments.method,
                      "run.step=" + arguments.step,
                      "run.until=" + until,
                      "run.threads=1",
                      "run.schedule=serial"};
    scene.settings.insert(scene.settings.end(), arguments.settings.begin(), arguments.settings.end());
    scene.settings.insert(scene.settings.end(), more.begin(), more.end());
    return load_scene(scene).scene;
}

/// Averages over both halves of the time after settling.
void average(tasks::Simulation& simulation, double settle, double length, DetailOutcome& outcome) {
    const double settled = simulation.time() + settle, until = settled + length;
    Averager seen(simulation, settled, until);
    settle_and_average(simulation, settled, seen, until, outcome);
    if (!outcome.fault.empty()) return;
    outcome.tight = seen.mean(tight), outcome.slack = seen.mean(slack), outcome.tip = seen.mean(tip), outcome.slip = seen.mean(slip);
    outcome.ratio = seen.mean(speed_ratio);
    outcome.efficiency = outcome.watch.means.efficiency;
    outcome.shift = (seen.end.ratio / seen.begin.ratio - 1.0) / (seen.end.time - seen.begin.time);
    outcome.drift = seen.second.values()[tight] / seen.first.values()[tight] - 1.0;
    outcome.cost = cost_of(simulation);
}

}  // namespace

std::string DetailVariant::name() const {
    if (!preset.empty()) return fmt::format("{}{}", preset, share == 1.0 ? "" : fmt::format(", 1/{:g} of its step", 1.0 / share));
    const std::string slowed = mass_scaling == 1.0 ? "" : fmt::format(", mass x {:g}", mass_scaling);
    return fmt::format("{}{:6} {} pt {}{}", pins == model::PinDetail::halves ? std::string() : fmt::format("{} pins, ", name_of(pins)),
                       plates == model::PlateDetail::each ? "each" : "lumped", joint_points,
                       pulleys == model::PulleyDetail::elastic ? "elastic" : "rigid", slowed);
}

std::vector<DetailVariant> detail_variants(bool all) {
    using enum model::PlateDetail;
    using enum model::PulleyDetail;
    if (!all) {
        return {full_detail,
                {lumped, 8, elastic},
                {each, 3, elastic},
                {each, 1, elastic},
                {each, 8, rigid},
                {lumped, 3, elastic},
                {lumped, 1, rigid},
                {lumped, 1, elastic, model::PinDetail::rigid},
                {.plates = lumped, .joint_points = 3, .pulleys = elastic, .mass_scaling = 3.0}};
    }
    std::vector<DetailVariant> list{full_detail};
    for (const auto plates : {each, lumped}) {
        for (const int points : {8, 3, 1}) {
            for (const auto pulleys : {elastic, rigid}) {
                if (list.size() > 1 || plates != each || points != 8 || pulleys != elastic) list.push_back({plates, points, pulleys});
            }
        }
    }
    return list;
}

namespace {

/// The compared keys of detail must not be set: all variants would be equal.
void require_free_dials(const std::vector<std::string>& settings) {
    for (const std::string& setting : settings) {
        const std::string key = setting.substr(0, setting.find('='));
        for (const std::string_view dial : tasks::dial_keys()) {
            if (key == dial) throw UsageError(fmt::format("--set {}: {} is one of the compared keys", setting, key));
        }
    }
}

/// Simulation at the scene's start. A share other than 1 of the automatic step becomes a fixed step.
std::unique_ptr<tasks::Simulation> begin(tasks::Scene scene, double share) {
    auto simulation = std::make_unique<tasks::Simulation>(scene);
    if (share == 1.0) return simulation;
    scene.run.step = tasks::AutoNumber(share * automatic_step(*simulation));
    return std::make_unique<tasks::Simulation>(scene);
}

}  // namespace

DetailMeasure::DetailMeasure(DetailArguments arguments, std::string scene) : arguments_(std::move(arguments)), scene_(std::move(scene)) {
    require_free_dials(arguments_.settings);
    const tasks::Scene reference = scene_of(arguments_, scene_, full_detail, arguments_.settle);
    if (reference.state_file.empty()) throw tasks::SceneError(fmt::format("{}: has no settled state of full detail (start.state)", scene_));
    settled_ = engine::read_state(reference.state_file);
    reference_ = reference.parameters;
    try {
        const tasks::Simulation start(reference);  // refuses a state that does not fit, and names the differences
        if (start.balance_error_ratio() > 1.0)
            throw tasks::SimulationError(reference.state_file + " is unreliable: the energy balance of its settling did not close");
    } catch (const tasks::SimulationError& error) {
        throw tasks::SceneError(fmt::format("{}: variants start from a settled state of full detail: {}", scene_, error.what()));
    }
}

DetailOutcome DetailMeasure::measure(const DetailVariant& variant, double target) const {
    DetailOutcome outcome;
    outcome.variant = variant;
    tasks::Scene scene = scene_of(arguments_, scene_, variant, arguments_.settle);
    const double settle = scene.run.until, length = scene_of(arguments_, scene_, variant, arguments_.average).run.until;
    const StateFile start(tasks::convert_state(settled_, reference_, scene.parameters));
    scene.state_file = start.path();
    auto simulation = begin(scene, variant.share);
    outcome.coordinates = simulation->workspace().layout().coordinates();
    average(*simulation, settle, length, outcome);
    outcome.step = simulation->step();
    outcome.simulation = std::move(simulation);
    if (outcome.fault.empty()) find_thrust(variant, target > 0.0 ? target : outcome.ratio, outcome);
    return outcome;
}

/// Mean over the last fifth of the time that ratio control has; gains as in scene `control`.
void DetailMeasure::find_thrust(const DetailVariant& variant, double target, DetailOutcome& outcome) const {
    const auto time = tasks::parse_quantity(arguments_.control);
    if (const auto* length = std::get_if<tasks::Quantity>(&time); length != nullptr && length->number == 0.0) return;
    tasks::Scene scene = scene_of(
        arguments_, scene_, variant, arguments_.control,
        {"control.enabled=true", fmt::format("control.ratio={:.6f}", target), "control.proportional=1 MN", "control.integral=5e7 N/s"});
    engine::SavedState settled = tasks::convert_state(settled_, reference_, scene.parameters);
    settled.state.resize(static_cast<std::size_t>(model::layout_of(scene.parameters).size()));  // the controller's integral begins at zero
    const StateFile start(settled);
    scene.state_file = start.path();
    const auto begun = begin(scene, variant.share);
    tasks::Simulation& simulation = *begun;
    const double found = simulation.time() + 0.8 * scene.run.until, until = simulation.time() + scene.run.until;
    Averager seen(simulation, found, until);
    DetailOutcome controlled;
    settle_and_average(simulation, found, seen, until, controlled);
    if (!controlled.fault.empty()) {
        outcome.status = controlled.status;
        outcome.fault = "under ratio control: " + controlled.fault;
        return;
    }
    outcome.thrust = seen.mean(thrust_ratio);
}

namespace {

constexpr int rounds = 7;
constexpr double round_length = 2e-3;  ///< [s]

/// Processor time of this thread [s]: other load on the machine does not count.
double processor_time() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Times all levels in turns, from the end of the averaging.
void time_in_turns(std::vector<DetailLevelResult>& levels) {
    std::vector<std::array<double, rounds>> times(levels.size());
    tasks::SilentObserver silent;
    for (std::size_t round = 0; round < rounds; ++round) {
        for (std::size_t k = 0; k < levels.size(); ++k) {
            tasks::Simulation& simulation = *levels[k].outcome.simulation;
            const double from = simulation.time(), began = processor_time();
            static_cast<void>(simulation.advance({.until = from + round_length}, silent, catch_interrupts()));
            times[k][round] = (processor_time() - began) / std::max(simulation.time() - from, 1e-9);
        }
    }
    for (std::size_t k = 0; k < levels.size(); ++k) {
        std::sort(times[k].begin(), times[k].end());
        levels[k].seconds = times[k][rounds / 2];
        levels[k].spread = (times[k].back() - times[k].front()) / levels[k].seconds;
    }
}

}  // namespace

std::vector<LadderPoint> ladder_points(const DetailArguments& arguments) {
    std::vector<LadderPoint> points;
    for (const std::string& scene : arguments.scenes) points.push_back({scene.substr(scene.find_last_of('/') + 1), scene, {}});
    if (!points.empty()) return points;
    for (const char* scene : {"baseline", "low", "overdrive"}) points.push_back({scene, scene, {}});
    points.push_back({"quarter_load", "baseline", {"load.torque=50 N*m"}});  // friction carries 199.7 N·m
    points.push_back({"near_slip", "baseline", {"load.torque=180 N*m"}});
    points.push_back({"shift", "baseline", {"clamping.driving=22 kN"}, false});
    tasks::Scene times;
    tasks::set_values(times, std::vector<std::string>{"start.settling_time=" + arguments.settle, "run.until=" + arguments.average});
    const double begin = times.parameters.start.settling_time, end = begin + times.run.until;
    points.push_back(
        {"load_ramp", "baseline", {fmt::format(R"(load.torque=[[{:.9g}, "150 N*m"], [{:.9g}, "230 N*m"]])", begin, end)}, false});
    return points;
}

DetailVariant level_variant(const tasks::DetailPreset& preset, double share) {
    return {preset.plates, preset.joint_points, preset.pulleys, preset.pins, preset.name, share, preset.mass_scaling};
}

Ladder measure_ladder(const DetailArguments& arguments, const LadderPoint& point) {
    DetailArguments here = arguments;
    here.settings.insert(here.settings.end(), point.settings.begin(), point.settings.end());
    if (!point.controlled) here.control = "0 s";
    const DetailMeasure measure(here, point.scene);
    const auto presets = tasks::detail_presets();
    Ladder ladder{point, measure.measure(level_variant(presets.back(), 0.25), 0.0), {}};
    if (!ladder.reference.fault.empty())
        throw tasks::SimulationError(fmt::format("{}: the reference, {}, {} {}", point.name, ladder.reference.variant.name(),
                                                 ladder.reference.status == "unreliable" ? "is" : "ended:", ladder.reference.fault));
    for (const tasks::DetailPreset& preset : std::views::reverse(presets)) {
        if (catch_interrupts().requested()) return ladder;
        ladder.levels.push_back({measure.measure(level_variant(preset, 1.0), ladder.reference.ratio)});
    }
    time_in_turns(ladder.levels);
    return ladder;
}

}  // namespace cvtflow::bench
