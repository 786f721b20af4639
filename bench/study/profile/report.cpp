#include "bench/study/profile/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "bench/executor/further_executors.hpp"
#include "engine/base/hash.hpp"
#include "engine/base/provenance.hpp"
#include "engine/thread/worker_threads.hpp"
#include "tasks/scene/csv.hpp"

namespace cvtflow::bench {

using namespace tasks;

using nlohmann::ordered_json;

namespace {

std::string quoted(const std::string& text) { return tasks::csv_cell(text, true, true); }

std::string_view wait_name(engine::Wait wait) {
    return wait == engine::Wait::spin ? "spin" : wait == engine::Wait::passive ? "passive" : "balanced";
}

/// Environment variable of the OpenMP runtimes, which read it when they are loaded.
std::string environment(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
}

ordered_json provenance_json() {
    const engine::Provenance here = engine::current_provenance();
    return {{"version", here.version},
            {"commit", here.commit},
            {"compiler", here.compiler},
            {"build_type", here.build_type},
            {"flags", compiler_flags()},
            {"instruction_set", here.instruction_set},
            {"tbb", engine::tbb_version()},
            {"openmp", openmp_version()},
            {"runtimes", bench::runtime_versions()},
            {"cpu", here.cpu},
            {"cores", here.cores},
            {"usable_threads", usable_threads()},
            {"os", here.os},
            {"date", here.date}};
}

ordered_json spread_json(const Spread& spread) {
    return {{"lower_quartile", spread.lower_quartile}, {"median", spread.median}, {"upper_quartile", spread.upper_quartile}};
}

ordered_json gain_json(const PairedGain& gain) {
    return {{"near", spread_json(gain.near)},
            {"near_rounds", gain.near_rounds},
            {"far", spread_json(gain.far)},
            {"far_rounds", gain.far_rounds}};
}

ordered_json load_json(const LoadResult& load) {
    return {{"neighbours", load.neighbours},
            {"step", spread_json(load.step)},
            {"evaluation", load.evaluation},
            {"cpu_per_wall", load.cpu_per_wall},
            {"cpu", load.cpu},
            {"burnt", load.burnt},
            {"speed_up", load.speed_up},
            {"rounds", load.rounds},
            {"dropped", load.dropped}};
}

ordered_json recording_json(const Recording& recording, const StageTable& stages) {
    const RecordedPass& pass = recording.pass;
    ordered_json threads = ordered_json::array();
    for (const ThreadTimes& thread : pass.threads) {
        ordered_json times = ordered_json::object();
        for (std::size_t row = 0; row < stages.size(); ++row) times[stages.rows()[row].name] = thread.at(row);
        threads.push_back(times);
    }
    return {{"steps", recording.steps},
            {"wall", pass.wall},
            {"cycles", pass.cycles},
            {"levels", pass.levels},
            {"tasks", pass.task_count},
            {"lost_stamps", recording.lost},
            {"recording_cost", recording.cost},
            {"synchronisation_per_cycle", pass.synchronisation()},
            {"least_task", pass.min_task()},
            {"active_threads", pass.active()},
            {"imbalance", pass.imbalance()},
            {"threads", threads}};
}

ordered_json result_json(const ScheduleResult& result, const StageTable& stages) {
    ordered_json loads = ordered_json::array();
    for (const LoadResult& load : result.loads) loads.push_back(load_json(load));
    ordered_json json{{"schedule", result.name},
                      {"executor", result.schedule.executor},
                      {"assembly", assembly_name(result.schedule.assembly)},
                      {"threads", result.schedule.threads},
                      {"segments", result.schedule.segments},
                      {"hash", engine::hex(result.hash)},
                      {"hash_steps", result.hash_steps},
                      {"cycle_cost", result.cycle.seconds},
                      {"cycle_active_threads", result.cycle.active},
                      {"bare_barrier", result.bare},
                      {"paired_gain", gain_json(result.paired)},
                      {"wait", wait_name(result.schedule.wait)},
                      {"pinned", result.schedule.pin},
                      {"loads", loads}};
    json["recording"] = recording_json(result.recording, stages);
    return json;
}

ordered_json thread_costs(const std::vector<ThreadCost>& costs) {
    ordered_json list = ordered_json::array();
    for (const ThreadCost& cost : costs) list.push_back({{"threads", cost.threads}, {"seconds", cost.seconds}});
    return list;
}

}  // namespace

std::string compiler_flags() { return CVTFLOW_FLAGS; }

std::string profile_csv(const Scene& scene, const Profile& profile) {
    std::string text =
        "scene,schedule,executor,assembly,threads,segments,neighbours,step_us,step_lower_quartile_us,step_upper_quartile_us,evaluation_us,"
        "speed_up,"
        "cpu_per_wall,rounds,dropped,active_threads,synchronisation_us,cycle_cost_us,least_task_us,imbalance,recording_cost,hash,wait,"
        "pinned,omp_wait_policy,"
        "gomp_spincount,kmp_blocktime,cpu_us,burnt_us,bare_barrier_us,commit,compiler,flags,tbb,openmp,cpu,cores,date\n";
    const engine::Provenance here = engine::current_provenance();
    const std::string provenance =
        fmt::format("{},{},{},{},{},{},{},{}", quoted(here.commit), quoted(here.compiler + " " + here.build_type), quoted(compiler_flags()),
                    quoted(engine::tbb_version()), quoted(openmp_version()), quoted(here.cpu), here.cores, quoted(here.date));
    for (const ScheduleResult& result : profile.results) {
        const RecordedPass& pass = result.recording.pass;
        const std::string alone = result.cycle.active == result.schedule.threads ? fmt::format("{:.4f}", 1e6 * result.cycle.seconds) : "";
        for (const LoadResult& load : result.loads) {
            text +=
                fmt::format("{},{},{},{},{},{},{},", quoted(scene.name), result.name, result.schedule.executor,
                            assembly_name(result.schedule.assembly), result.schedule.threads, result.schedule.segments, load.neighbours);
            text += fmt::format("{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.3f},{},{},", 1e6 * load.step.median, 1e6 * load.step.lower_quartile,
                                1e6 * load.step.upper_quartile, 1e6 * load.evaluation, load.speed_up, load.cpu_per_wall, load.rounds,
                                quoted(load.dropped));
            text += pass.active() == 0 ? fmt::format(",,{},,,,", alone)
                                       : fmt::format("{},{:.4f},{},{:.4f},{:.4f},{:.4f},", pass.active(), 1e6 * pass.synchronisation(),
                                                     alone, 1e6 * pass.min_task(), pass.imbalance(), result.recording.cost);
            text += fmt::format("{},{},{},{},{},{},{:.4f},{:.4f},{:.4f},{}\n", engine::hex(result.hash), wait_name(result.schedule.wait),
                                result.schedule.pin ? "yes" : "no", quoted(environment("OMP_WAIT_POLICY")),
                                quoted(environment("GOMP_SPINCOUNT")), quoted(environment("KMP_BLOCKTIME")), 1e6 * load.cpu,
                                1e6 * load.burnt, 1e6 * result.bare, provenance);
        }
    }
    return text;
}

std::string profile_json(const Scene& scene, const MeasureOptions& options, const Profile& profile) {
    ordered_json results = ordered_json::array();
    for (const ScheduleResult& result : profile.results) results.push_back(result_json(result, profile.stages));
    ordered_json json{{"scene", scene.name}, {"provenance", provenance_json()}};
    json["options"] = {
        {"rounds", options.rounds}, {"round_seconds", options.round_seconds}, {"steps", options.steps}, {"patience", options.timeout}};
    json["environment"] = {{"OMP_WAIT_POLICY", environment("OMP_WAIT_POLICY")},
                           {"GOMP_SPINCOUNT", environment("GOMP_SPINCOUNT")},
                           {"KMP_BLOCKTIME", environment("KMP_BLOCKTIME")}};
    json["load_average"] = {{"before", profile.load_before}, {"after", profile.load_after}};
    json["crowded"] = profile.crowded();
    json["processors"] = {
        {"requested", profile.processors_requested()}, {"got_by_schedules", profile.processors_got()}, {"calibrated", profile.calibrated}};
    json["schedules"] = results;
    json["bare_barrier"] = thread_costs(profile.bare);
    json["independent_runs"] = ordered_json::array();
    for (const CopiesGain& copies : profile.copies)
        json["independent_runs"].push_back({{"threads", copies.threads}, {"paired_gain", gain_json(copies.paired)}});
    json["hash_differences"] = profile.differences;
    return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string profile_stages_csv(const Scene& scene, const Profile& profile) {
    std::string text = "scene,schedule,threads,segments,thread,stage,seconds,share,per_step_us\n";
    for (const ScheduleResult& result : profile.results) {
        const auto& threads = result.recording.pass.threads;
        for (std::size_t thread = 0; thread < threads.size(); ++thread) {
            for (std::size_t row = 0; row < profile.stages.size(); ++row) {
                const double seconds = threads[thread].at(row), total = threads[thread].total();
                text += fmt::format("{},{},{},{},{},{},{:.9f},{:.5f},{:.4f}\n", quoted(scene.name), result.name, result.schedule.threads,
                                    result.schedule.segments, thread, quoted(profile.stages.rows()[row].name), seconds,
                                    total > 0.0 ? seconds / total : 0.0,
                                    result.recording.steps > 0 ? 1e6 * seconds / static_cast<double>(result.recording.steps) : 0.0);
            }
        }
    }
    return text;
}

namespace {

std::string span_name(const Recording& recording, int what) {
    if (what >= 0) return recording.tasks[static_cast<std::size_t>(what)];
    switch (what) {
        case engine::span_controller: return "controller";
        case engine::span_enter: return "enter";
        case engine::span_exit: return "exit";
        default: return "wait";
    }
}

}  // namespace

std::string profile_trace(const Profile& profile) {
    std::string text = "{\"displayTimeUnit\": \"ns\", \"traceEvents\": [";
    std::string separator = "\n";
    int process = 0;
    for (const ScheduleResult& result : profile.results) {
        text += fmt::format(
            "{}{{\"name\": \"process_name\", \"ph\": \"M\", \"pid\": {}, \"args\": {{\"name\": \"{}, {} threads, {} segments\"}}}}",
            separator, ++process, result.name, result.schedule.threads, result.schedule.segments);
        separator = ",\n";
        std::int64_t begin = INT64_MAX;
        for (const auto& thread : result.recording.spans) begin = thread.empty() ? begin : std::min(begin, thread.front().begin);
        for (std::size_t thread = 0; thread < result.recording.spans.size(); ++thread) {
            for (const Span& span : result.recording.spans[thread]) {
                text += fmt::format("{}{{\"name\": \"{}\", \"ph\": \"X\", \"pid\": {}, \"tid\": {}, \"ts\": {:.3f}, \"dur\": {:.3f}}}",
                                    separator, span_name(result.recording, span.what), process, thread,
                                    1e-3 * static_cast<double>(span.begin - begin), 1e-3 * static_cast<double>(span.end - span.begin));
            }
        }
    }
    return text + "\n]}\n";
}

}  // namespace cvtflow::bench
