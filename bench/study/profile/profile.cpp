#include "bench/study/profile/profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "bench/study/profile/other_load.hpp"
#include "engine/base/text.hpp"
#include "engine/executor/catalogue.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

struct Kind {
    const engine::ExecutorRow* row;
    AssemblyOptions assembly;
};

AssemblyOptions assembly_named(const std::string& name) {
    std::string names;
    for (const auto& [known, options] : assemblies()) {
        if (name == known) return options;
        names += (names.empty() ? "" : ", ") + std::string(known);
    }
    throw SceneError(fmt::format("--schedules: unknown assembly '{}': {}", name, names));
}

Kind kind_of(const std::string& name, const AssemblyOptions& usual) {
    const std::size_t colon = name.find(':');
    const std::string executor = name.substr(0, colon), assembly = colon == std::string::npos ? "" : name.substr(colon + 1);
    const engine::ExecutorRow* row = engine::find_executor(executor);
    if (row == nullptr) {
        throw SceneError(
            fmt::format("--schedules: there is no executor '{}'{} (cvtflow-lab executors)", executor, engine::missing_executor(executor)));
    }
    if (colon == std::string::npos) return {row, usual};
    return {row, assembly_named(assembly)};
}

std::vector<Kind> kinds(const Scene& scene, const std::vector<std::string>& names) {
    std::vector<Kind> list;
    for (const std::string& name : names) list.push_back(kind_of(name, {scene.run.assembly}));
    if (!names.empty()) return list;
    for (const engine::ExecutorRow& row : engine::executors()) {
        list.push_back({&row, {Assembly::fused}});
        if (scene.parameters.detail.pins == model::PinDetail::halves) list.push_back({&row, {Assembly::staged}});
    }
    return list;
}

void add_once(std::vector<Schedule>& list, const Schedule& schedule) {
    if (std::find(list.begin(), list.end(), schedule) == list.end()) list.push_back(schedule);
}

}  // namespace

std::vector<Schedule> chosen_schedules(const Scene& scene, const ScheduleChoice& choice) {
    const int links = scene.parameters.chain.pins;
    const std::vector<int> threads = choice.threads.empty() ? std::vector<int>{usable_threads()} : choice.threads;
    const std::vector<int> segments = choice.segments.empty() ? std::vector<int>{0} : choice.segments;
    std::vector<Schedule> list{Schedule{}};
    for (const Kind& kind : kinds(scene, choice.names)) {
        for (const int number : kind.row->parallel ? threads : std::vector<int>{1}) {
            for (const int parts : segments) {
                if (number < 1 || parts < 0 || parts > links)
                    throw SceneError(
                        fmt::format("--threads {}, --segments {}: at least 1 thread and 1 to {} segments", number, parts, links));
                Schedule schedule;
                schedule.executor = std::string(kind.row->name);
                schedule.assembly = kind.assembly;
                schedule.threads = number;
                schedule.segments = !kind.row->parallel ? 1 : parts > 0 ? parts : std::min(number, links);
                schedule.balanced = kind.row->parallel && scene.run.partition == PartitionKind::balanced;
                if (kind.row->parallel) schedule.wait = choice.wait, schedule.pin = choice.pin;
                add_once(list, schedule);
            }
        }
    }
    return list;
}

namespace {

/// Runnable threads of the whole machine, mean of the last minute; -1: unknown.
double load_average() {
    double load = 0.0;
    return getloadavg(&load, 1) == 1 ? load : -1.0;
}

}  // namespace

double Profile::processors_got() const noexcept {
    double most = 0.0;
    for (const ScheduleResult& result : results) most = std::max(most, result.loads.front().cpu_per_wall);
    return most;
}

int Profile::processors_requested() const noexcept {
    int most = 1;
    for (const ScheduleResult& result : results) most = std::max(most, std::min(result.schedule.threads, usable_threads()));
    return most;
}

bool Profile::crowded() const noexcept {
    const double needed = crowded_below * processors_requested();
    return processors_got() < needed || (calibrated >= 0.0 && calibrated < needed);
}

namespace {

constexpr double calibration_seconds = 0.05;

/// Keeps the least of all calibrations.
void calibrate(Profile& profile, int threads) {
    const double got = bench::processors_got(threads, calibration_seconds);
    profile.calibrated = profile.calibrated < 0.0 ? got : std::min(profile.calibrated, got);
}

int max_threads(const std::vector<Schedule>& schedules) {
    int most = 1;
    for (const Schedule& schedule : schedules) most = std::max(most, std::min(schedule.threads, usable_threads()));
    return most;
}

/// Costs of a bare barrier by number of threads, median over the results.
std::vector<ThreadCost> bare_barriers(const std::vector<ScheduleResult>& results) {
    std::map<int, std::vector<double>> costs;
    for (const ScheduleResult& result : results) {
        if (result.bare > 0.0) costs[result.schedule.threads].push_back(result.bare);
    }
    std::vector<ThreadCost> bare;
    for (const auto& [threads, seconds] : costs) bare.push_back({threads, median(seconds)});
    return bare;
}

}  // namespace

Profile profile_schedules(const Scene& scene, const std::vector<Schedule>& schedules, const MeasureOptions& options,
                          const std::function<void(const std::string&)>& progress) {
    const auto say = [&](const std::string& line) {
        if (progress) progress(line);
    };
    Profile profile;
    const int threads = max_threads(schedules);
    profile.load_before = load_average();
    calibrate(profile, threads);
    say("starting, comparing states");
    std::uint64_t short_hash = 0;
    std::vector<ScheduleTrial> lanes = start_lanes(scene, schedules, options.timeout, short_hash);
    std::vector<CopiesTrial> copies = start_copies(scene, schedules);
    profile.stages = stages_of(lanes);
    for (const int neighbours : options.neighbours) {
        say(fmt::format("timing beside {} busy neighbours", neighbours));
        measure_load(lanes, copies, options, neighbours);
        if (neighbours != options.neighbours.front()) continue;
        calibrate(profile, threads);
        say("recording stages");
        for (ScheduleTrial& lane : lanes) record_lane(scene, lane, options, profile.stages);
    }
    calibrate(profile, threads);
    for (ScheduleTrial& lane : lanes) profile.results.push_back(std::move(lane.result));
    for (const CopiesTrial& each : copies) profile.copies.push_back(each.result);
    profile.bare = bare_barriers(profile.results);
    profile.load_after = load_average();
    profile.differences = hash_differences(profile.results, short_hash);
    return profile;
}

}  // namespace cvtflow::bench
