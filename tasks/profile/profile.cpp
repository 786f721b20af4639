#include "tasks/profile/profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "engine/executor/busy_neighbours.hpp"
#include "engine/executor/catalogue.hpp"
#include "engine/executor/stamp_recorder.hpp"
#include "tasks/scene/spelling.hpp"

namespace cvtflow::tasks {

namespace {

constexpr double cycle_seconds = 0.03;   // for a bare cycle or one of small tasks

struct Kind {
    const engine::ExecutorRow* row;
    AssemblyOptions assembly;
};

Kind kind_of(const std::string& name, const AssemblyOptions& usual) {
    const std::size_t colon = name.find(':');
    const std::string executor = name.substr(0, colon), assembly = colon == std::string::npos ? "" : name.substr(colon + 1);
    const engine::ExecutorRow* row = engine::find_executor(executor);
    if (row == nullptr) {
        std::vector<std::string> names;
        for (const engine::ExecutorRow& each : engine::executors()) names.emplace_back(each.name);
        throw SceneError(fmt::format("--schedules: there is no executor '{}'{} (cvtflow list executors)", executor, did_you_mean(closest(executor, names))));
    }
    if (colon == std::string::npos) return {row, usual};
    try {
        return {row, assembly_named(assembly)};
    } catch (const SceneError& error) {
        throw SceneError(fmt::format("--schedules: {}", error.what()));
    }
}

std::vector<Kind> kinds(const Scene& scene, const std::vector<std::string>& names) {
    std::vector<Kind> list;
    for (const std::string& name : names) list.push_back(kind_of(name, {scene.run.assembly}));
    if (!names.empty()) return list;
    for (const engine::ExecutorRow& row : engine::executors()) {
        for (const Assembly assembly : {Assembly::fused, Assembly::staged}) list.push_back({&row, {assembly}});
    }
    return list;
}

void add_once(std::vector<Schedule>& list, const Schedule& schedule) {
    const bool known = std::any_of(list.begin(), list.end(), [&](const Schedule& other) {
        return other.executor == schedule.executor && other.assembly == schedule.assembly && other.threads == schedule.threads &&
               other.segments == schedule.segments;
    });
    if (!known) list.push_back(schedule);
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
                if (number < 1 || parts < 0 || parts > links) throw SceneError(fmt::format("--threads {}, --segments {}: at least 1 thread and 1 to {} segments", number, parts, links));
                Schedule schedule;
                schedule.executor = std::string(kind.row->name);
                schedule.assembly = kind.assembly;
                schedule.threads = number;
                schedule.segments = !kind.row->parallel ? 1 : parts > 0 ? parts : std::min(number, links);
                schedule.balanced = scene.run.partition == PartitionKind::balanced;
                add_once(list, schedule);
            }
        }
    }
    return list;
}

namespace {

/// Adds the evaluation tasks of a recorded serial run with so many segments: median time of each.
void sample_segments(const Scene& scene, int segments, const MeasureOptions& options, std::vector<SegmentCost>& samples, ProfileModel& model) {
    Schedule schedule;
    schedule.segments = segments;
    engine::StampRecorder recorder(1, 200000);
    Trial trial(scene, schedule, &recorder);
    const double per_step = trial.run(4).per_step();
    recorder.clear();
    trial.run(std::min(500L, steps_within(options.round_seconds, per_step)));
    const engine::TaskGraph& graph = trial.simulation().graph();
    std::vector<std::vector<double>> times(static_cast<std::size_t>(graph.size()));
    for (const engine::Span& span : recorder.spans(0)) {
        if (span.what >= 0) times[static_cast<std::size_t>(span.what)].push_back(1e-9 * static_cast<double>(span.end - span.begin));
    }
    const Workspace& workspace = trial.simulation().workspace();
    model.touching.assign(static_cast<std::size_t>(workspace.layout().links), false);
    for (std::size_t tip = 0; tip < workspace.phases.size(); ++tip) {
        if (workspace.phases[tip] != model::Phase::free) model.touching[tip / model::tips_per_link] = true;
    }
    double detection = 0.0;
    for (int task = 0; task < graph.size(); ++task) {
        const engine::Task& each = graph.task(task);
        const double time = median(times[static_cast<std::size_t>(task)]);
        if (each.cycle == detect_cycle) detection += time;
        if (each.cycle != evaluate_cycle) continue;
        const Segment& segment = workspace.partition[each.item];
        const auto first = model.touching.begin() + segment.first, last = model.touching.begin() + segment.last;
        const int touching = static_cast<int>(std::count(first, last, true));
        samples.push_back({segment.size() - touching, touching, time});
    }
    model.costs.detect = detection / workspace.layout().links;
}

double median_controller(const Spans& spans) {
    std::vector<double> times;
    for (const auto& thread : spans) {
        for (const engine::Span& span : thread) {
            if (span.what == engine::span_controller) times.push_back(1e-9 * static_cast<double>(span.end - span.begin));
        }
    }
    return median(times);
}

/// Runnable threads of the whole machine, mean of the last minute; -1: unknown.
double load_average() {
    double load = 0.0;
    return getloadavg(&load, 1) == 1 ? load : -1.0;
}

}  // namespace

ProfileModel measure_model(const Scene& scene, const Recording& serial, const MeasureOptions& options) {
    ProfileModel model;
    const int links = scene.parameters.chain.pins;
    std::vector<SegmentCost> samples;
    for (const int segments : {24, 7}) sample_segments(scene, std::min(links, segments), options, samples, model);
    fit_links(samples, model.costs);
    model.costs.controller = median_controller(serial.spans);
    model.serial_share = serial.pass.serial_share();
    for (int threads = 1; threads <= usable_threads(); threads *= 2) {
        Schedule flow;
        flow.executor = "flow";
        flow.threads = threads;
        const CycleCost cost = cycle_cost(flow, cycle_seconds);
        if (cost.active == threads) model.synchronisation.push_back({threads, cost.seconds});
    }
    model.assumed = model.synchronisation.empty() || model.synchronisation.back().threads == 1;
    if (model.assumed) model.synchronisation = {{2, assumed_synchronisation}};
    fit_synchronisation(model.synchronisation, model.costs);
    return model;
}

double Profile::processors_got() const noexcept {
    double most = 0.0;
    for (const ScheduleResult& result : results) most = std::max(most, result.loads.front().cpu_per_wall);
    return most;
}

int Profile::processors_wanted() const noexcept {
    int most = 1;
    for (const ScheduleResult& result : results) most = std::max(most, std::min(result.schedule.threads, usable_threads()));
    return most;
}

Profile profile_schedules(const Scene& scene, const std::vector<Schedule>& schedules, const MeasureOptions& options,
                          const std::function<void(const std::string&)>& progress) {
    const auto say = [&](const std::string& line) {
        if (progress) progress(line);
    };
    Profile profile;
    profile.load_before = load_average();
    say("starting, comparing states");
    std::uint64_t short_hash = 0;
    std::vector<Lane> lanes = start_lanes(scene, schedules, options.patience, short_hash);
    for (const int neighbours : options.neighbours) {
        say(fmt::format("timing beside {} busy neighbours", neighbours));
        measure_load(lanes, options, neighbours);
        if (neighbours != options.neighbours.front()) continue;
        say("recording stages");
        for (Lane& lane : lanes) record_lane(scene, lane, options);
    }
    say("synchronisation and model");
    for (Lane& lane : lanes) {
        lane.result.cycle = cycle_cost(lane.result.schedule, cycle_seconds);
        const int threads = lane.result.schedule.threads;
        const bool known = std::any_of(profile.bare.begin(), profile.bare.end(), [=](const ThreadCost& cost) { return cost.threads == threads; });
        if (!known) profile.bare.push_back({threads, engine::bare_barrier_cycle(threads, cycle_seconds)});
        profile.results.push_back(std::move(lane.result));
    }
    profile.model = measure_model(scene, profile.results.front().recording, options);
    const LoadResult& serial = profile.results.front().loads.front();
    profile.model.costs.evaluations = serial.step.median / serial.evaluation;
    profile.model.curves = speed_up_curves(profile.model.costs, profile.model.serial_share, profile.model.touching);
    profile.load_after = load_average();
    profile.differences = hash_differences(profile.results, short_hash);
    return profile;
}

}  // namespace cvtflow::tasks
