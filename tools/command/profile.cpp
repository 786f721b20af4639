#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <memory>

#include "engine/base/provenance.hpp"
#include "engine/executor/runtimes.hpp"
#include "tasks/profile/report.hpp"
#include "tools/command.hpp"
#include "tools/profile_text.hpp"
#include "tools/scene_arguments.hpp"
#include "tools/text.hpp"

namespace cvtflow::tools {

namespace {

struct ProfileArguments {
    SceneArguments scene;
    tasks::ScheduleChoice choice;
    tasks::MeasureOptions measure;
    double round_milliseconds = 60.0;
    std::string csv, json, trace;
    bool quiet = false;
};

void write_file(const std::string& path, const std::string& text) {
    if (path.empty()) return;
    std::ofstream file(path, std::ios::binary);
    file << text;
    file.close();
    if (!file) throw std::runtime_error(path + ": cannot write");
}

std::string machine_text(const tasks::Profile& result) {
    const engine::Provenance here = engine::current_provenance();
    return field("machine", fmt::format("{}, {}, {} usable", here.cpu, plural(here.cores, "core"), plural(tasks::usable_threads(), "thread"))) +
           field("program", fmt::format("cvtflow {} ({}), {} {}", here.version, here.commit, here.compiler, here.build_type)) +
           field("flags", tasks::compiler_flags()) + field("libraries", fmt::format("oneTBB {}; OpenMP {}", engine::tbb_version(), engine::openmp_version())) +
           field("load average", fmt::format("{:.2f} before, {:.2f} after", result.load_before, result.load_after)) +
           (result.crowded() ? field("crowded", fmt::format("got {:.2f} of {} at most: others are busy, compare with care", result.processors_got(),
                                                            plural(result.processors_wanted(), "processor")))
                             : "");
}

tasks::MeasureOptions options_of(const ProfileArguments& arguments) {
    tasks::MeasureOptions options = arguments.measure;
    options.round_seconds = 1e-3 * arguments.round_milliseconds;
    std::vector<int>& loads = options.neighbours;
    loads.push_back(0);
    std::sort(loads.begin(), loads.end());
    loads.erase(std::unique(loads.begin(), loads.end()), loads.end());
    return options;
}

ExitStatus profile(const ProfileArguments& arguments) {
    const LoadedScene loaded = load_scene(arguments.scene);
    if (!loaded.notice.empty() && !arguments.quiet) fmt::print(stderr, "cvtflow: {}\n", loaded.notice);
    const tasks::Scene& scene = loaded.scene;
    const tasks::MeasureOptions options = options_of(arguments);
    const auto schedules = tasks::chosen_schedules(scene, arguments.choice);
    const auto progress = [&](const std::string& line) {
        if (!arguments.quiet) fmt::print(stderr, "cvtflow: {}\n", line);
    };
    const tasks::Profile result = tasks::profile_schedules(scene, schedules, options, progress);
    fmt::print("{}: {}, alternating, medians of {}\n{}", scene.name, plural(static_cast<long>(schedules.size()), "schedule"), plural(options.rounds, "round"), machine_text(result));
    for (const std::string& part : {timing_text(result), neighbours_text(result), stages_text(result), serial_text(result), model_text(result)}) {
        if (!part.empty()) fmt::print("\n{}", part);
    }
    write_file(arguments.csv, tasks::profile_csv(scene, result));
    write_file(arguments.json, tasks::profile_json(scene, options, result));
    if (!arguments.trace.empty()) write_file(arguments.trace, tasks::profile_trace(result));
    for (const std::string& line : result.differences) fmt::print(stderr, "cvtflow: states differ: {}\n", line);
    return result.differences.empty() ? ExitStatus::finished : ExitStatus::error;
}

constexpr const char* explanation =
    "All schedules run in one process, in turns; serial:fused is always among them and is what speed-ups refer to.\n"
    "States are compared bit by bit after the same steps; a difference is an error (exit status 1).\n"
    "Columns:\n"
    "  evaluation   time per evaluation of the right-hand side, detection and control included [us]\n"
    "  cpu/wall     processor time of the process over wall time\n"
    "  active       threads that ran tasks in the recorded pass\n"
    "  sync         loss of a thread per cycle [us], from a recorded pass apart from the timing:\n"
    "               (waits of the n active threads - (n - 1) x controller) / (n x cycles), that is\n"
    "               (n x (time - controller) - task times) / (n x cycles) without entering and leaving\n"
    "  alone        a cycle of one task of 2 us per thread, above the time of that task [us]; absent: a thread never came\n"
    "  least task   task length at which half the time is lost: the loss per level of the graph [us]\n"
    "  imbalance    longest over mean task time of the threads\n"
    "  recording    what recording added to the step time in its own pass\n"
    "The critical path takes of every cycle the slowest segment, the controller and the synchronisation a + b M.";

}  // namespace

Action declare_profile(CLI::App& app) {
    const auto arguments = std::make_shared<ProfileArguments>();
    tasks::MeasureOptions& measure = arguments->measure;
    declare_scene(app, arguments->scene);
    app.add_option("--schedules", arguments->choice.names, "EXECUTOR[:ASSEMBLY], separated by commas (default: all, fused and staged; staged-serial-cholesky, -transition, -both leave parts in one task)")
        ->type_name("LIST")
        ->delimiter(',');
    app.add_option("--threads", arguments->choice.threads, "Numbers of threads (default: all usable)")->type_name("LIST")->delimiter(',')->check(CLI::Range(1, 1024));
    app.add_option("--segments", arguments->choice.segments, "Numbers of segments; 0: as many as threads (default)")
        ->type_name("LIST")
        ->delimiter(',')
        ->check(CLI::NonNegativeNumber);
    app.add_option("--steps", measure.steps, "Steps of a round (default: as many as fit)")->type_name("N")->check(CLI::Range(1L, 10000000L));
    app.add_option("--rounds", measure.rounds, "Rounds that count")->type_name("N")->check(CLI::Range(1, 10000))->capture_default_str();
    app.add_option("--round-ms", arguments->round_milliseconds, "Time of a round; a schedule with one over 2 s is dropped")
        ->type_name("MS")
        ->check(CLI::Range(1.0, 2000.0))
        ->capture_default_str();
    app.add_option("--neighbours", measure.neighbours, "Busy threads beside, each measured again; 0 always is")
        ->type_name("LIST")
        ->delimiter(',')
        ->check(CLI::Range(0, 1024))
        ->default_str("0,1,2");
    app.add_option("--csv", arguments->csv, "Table to write, one row per schedule and load")->type_name("FILE");
    app.add_option("--json", arguments->json, "Everything, with provenance")->type_name("FILE");
    app.add_option("--trace", arguments->trace, "Recorded passes for chrome://tracing or ui.perfetto.dev")->type_name("FILE");
    app.add_flag("-q,--quiet", arguments->quiet, "No progress");
    app.footer(explanation);
    return [arguments] { return profile(*arguments); };
}

}  // namespace cvtflow::tools
