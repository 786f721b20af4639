#include "bench/study/profile/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "bench/executor/further_executors.hpp"
#include "engine/base/hash.hpp"
#include "engine/base/provenance.hpp"
#include "engine/thread/worker_threads.hpp"
#include "tasks/scene/csv.hpp"

namespace cvtflow::bench {

using namespace tasks;

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

}  // namespace

std::string compiler_flags() { return CVTFLOW_FLAGS; }

std::string profile_csv(const Scene& scene, const Profile& profile) {
    std::string text =
        "scene,schedule,executor,assembly,threads,segments,neighbours,step_us,step_lower_quartile_us,step_upper_quartile_us,evaluation_us,"
        "speed_up,"
        "cpu_per_wall,rounds,dropped,active_threads,synchronisation_us,cycle_cost_us,least_task_us,imbalance,recording_cost,hash,wait,"
        "pinned,omp_wait_policy,"
        "gomp_spincount,kmp_blocktime,cpu_us,burnt_us,bare_barrier_us,gain_near,rounds_near,gain_far,rounds_far,calibrated,commit,compiler,"
        "flags,tbb,openmp,cpu,cores,date\n";
    const engine::Provenance here = engine::current_provenance();
    const std::string provenance =
        fmt::format("{},{},{},{},{},{},{},{}", quoted(here.commit), quoted(here.compiler + " " + here.build_type), quoted(compiler_flags()),
                    quoted(engine::tbb_version()), quoted(openmp_version()), quoted(here.cpu), here.cores, quoted(here.date));
    for (const ScheduleResult& result : profile.results) {
        const RecordedPass& pass = result.recording.pass;
        const std::string alone = result.cycle.active == result.schedule.threads ? fmt::format("{:.4f}", 1e6 * result.cycle.seconds) : "";
        const PairedGain& paired = result.paired;
        const std::string gains =
            fmt::format("{:.4f},{},{:.4f},{}", paired.near.median, paired.near_rounds, paired.far.median, paired.far_rounds);
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
            text += fmt::format("{},{},{},{},{},{},{:.4f},{:.4f},{:.4f},{},{:.3f},{}\n", engine::hex(result.hash),
                                wait_name(result.schedule.wait), result.schedule.pin ? "yes" : "no", quoted(environment("OMP_WAIT_POLICY")),
                                quoted(environment("GOMP_SPINCOUNT")), quoted(environment("KMP_BLOCKTIME")), 1e6 * load.cpu,
                                1e6 * load.burnt, 1e6 * result.bare, gains, profile.calibrated, provenance);
        }
    }
    return text;
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
