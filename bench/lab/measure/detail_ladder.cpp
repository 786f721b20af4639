#include "bench/lab/measure/detail_ladder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ctime>

#include "tasks/scene/parameter_table.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

constexpr int rounds = 7;
constexpr double round_length = 2e-3;  ///< [s]

/// Processor time of this thread [s]: other load on the machine does not count.
double processor_time() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// From where the averaging ended.
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
        {"load_ramp", "baseline", {fmt::format("load.torque=[[{:.9g}, \"150 N*m\"], [{:.9g}, \"230 N*m\"]]", begin, end)}, false});
    return points;
}

DetailVariant level_variant(const tasks::DetailPreset& preset, double share) {
    return {preset.order, preset.plates, preset.joint_points, preset.pulleys, preset.pins, preset.name, share, preset.mass_scaling};
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
    for (auto preset = presets.rbegin(); preset != presets.rend(); ++preset) {
        if (catch_interrupts().requested()) return ladder;
        ladder.levels.push_back({measure.measure(level_variant(*preset, 1.0), ladder.reference.ratio)});
    }
    time_in_turns(ladder.levels);
    return ladder;
}

}  // namespace cvtflow::bench
