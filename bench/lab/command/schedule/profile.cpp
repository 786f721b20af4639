/// cvtflow-lab profile: schedules against each other.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/executor/further_executors.hpp"
#include "bench/lab/command/command.hpp"
#include "bench/lab/report/profile_report.hpp"
#include "bench/study/profile/report.hpp"
#include "engine/base/provenance.hpp"
#include "engine/executor/catalogue.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

struct ProfileArguments {
    SceneArguments scene;
    ScheduleChoice choice;
    MeasureOptions measure;
    double round_milliseconds = 60.0;
    std::string trace;
    OutputArguments output;
    std::string wait = "balanced";
    bool quiet = false;
};

const std::map<std::string, engine::Wait> waits{
    {"spin", engine::Wait::spin}, {"balanced", engine::Wait::balanced}, {"passive", engine::Wait::passive}};

void write_file(const std::string& path, const std::string& text) {
    std::ofstream file(path, std::ios::binary);
    file << text;
    file.close();
    if (!file) throw std::runtime_error(path + ": cannot write");
}

std::string machine_text(const Profile& result) {
    const engine::Provenance here = engine::current_provenance();
    return field("machine",
                 fmt::format("{}, {}, {} usable", here.cpu, plural(here.cores, "core"), plural(tasks::usable_threads(), "thread"))) +
           field("program", fmt::format("cvtflow {} ({}), {} {}", here.version, here.commit, here.compiler, here.build_type)) +
           field("flags", compiler_flags()) + field("libraries", bench::runtime_versions()) +
           field("load average", fmt::format("{:.2f} before, {:.2f} after", result.load_before, result.load_after)) +
           field(result.crowded() ? "crowded" : "quiet",
                 crowding_text(result) + (result.crowded() ? ": other processes are busy, so comparisons are unreliable" : ""));
}

MeasureOptions options_of(const ProfileArguments& arguments) {
    MeasureOptions options = arguments.measure;
    options.round_seconds = 1e-3 * arguments.round_milliseconds;
    std::vector<int>& loads = options.neighbours;
    loads.push_back(0);
    std::sort(loads.begin(), loads.end());
    loads.erase(std::unique(loads.begin(), loads.end()), loads.end());
    return options;
}

/// @return written() of the folder of -o
std::string write_files(const ProfileArguments& arguments, const tasks::Scene& scene, const Profile& result) {
    if (!arguments.trace.empty()) write_file(arguments.trace, profile_trace(result));
    OutputFolder folder(arguments.output);
    folder.write("profile.csv", profile_csv(scene, result));
    folder.write("stages.csv", profile_stages_csv(scene, result));
    folder.write("stages.svg", svg(stages_plot(scene.name, result)));
    folder.write("loads.svg", svg(loads_plot(scene.name, result)));
    return folder.written();
}

ExitStatus profile(const ProfileArguments& arguments) {
    const LoadedScene loaded = load_scene(arguments.scene);
    if (!loaded.notice.empty() && !arguments.quiet) print_error(loaded.notice);
    const tasks::Scene& scene = loaded.scene;
    engine::require_no_input(arguments.trace, input_files(scene));
    const MeasureOptions options = options_of(arguments);
    ScheduleChoice choice = arguments.choice;
    choice.wait = waits.at(arguments.wait);
    const auto schedules = chosen_schedules(scene, choice);
    const auto progress = [&](const std::string& line) {
        if (!arguments.quiet) print_error(line);
    };
    const Profile result = profile_schedules(scene, schedules, options, progress);
    fmt::print("{}: {}, alternating, medians of {}\n{}", scene.name, plural(static_cast<long>(schedules.size()), "schedule"),
               plural(options.rounds, "round"), machine_text(result));
    for (const std::string& part :
         {timing_text(result), gains_text(result), neighbours_text(result), stages_text(result), serial_text(result)}) {
        if (!part.empty()) fmt::print("\n{}", part);
    }
    fmt::print("{}", write_files(arguments, scene, result));
    for (const std::string& line : result.differences) print_error(fmt::format("states differ: {}", line));
    return result.differences.empty() ? ExitStatus::finished : ExitStatus::error;
}

constexpr const char* profile_explanation =
    "Stages are the names of the graph's tasks; a method with further cycles adds its own.\n"
    "All schedules run in one process, in alternating rounds. Speed-ups refer to serial:fused, which is always included.\n"
    "States are compared bitwise after the same steps; a difference is an error (exit status 1).\n"
    "Columns:\n"
    "  evaluation   time per evaluation of the right-hand side, detection and control included [us]\n"
    "  cpu/wall     processor time of the process over wall time\n"
    "  active       threads that ran tasks in the recorded pass\n"
    "  sync         loss of a thread per cycle [us], from a recorded pass apart from the timing:\n"
    "               (waits of the n active threads - (n - 1) x controller) / (n x cycles), that is\n"
    "               (n x (time - controller) - task times) / (n x cycles) without entering and leaving\n"
    "  alone        a cycle of one task of 2 us per thread, above the time of that task [us]; absent: a thread never ran\n"
    "  bare         a bare barrier of as many threads, in turn with `alone` [us]\n"
    "  burnt        processor time per step above that of serial under the same load [us]: spinning threads\n"
    "  min task     METG: task length with an efficiency of 50 %: the loss per level of the graph [us]\n"
    "  imbalance    longest over mean task time of the threads\n"
    "  recording    increase of the step time by recording, in its own pass\n"
    "Speed-ups against serial's turn of the same round are kept apart by the bare barrier just before the turn, near and far.\n"
    "Independent runs, as many serial ones at once as threads, show what the processors give without any synchronisation.\n"
    "Figures require a quiet machine: calibrations before, during and after (each thread counts arithmetic for 50 ms) and the schedules\n"
    "must obtain nine tenths of the processors. -o writes profile.csv, stages.csv, stages.svg, loads.svg.\n"
    "OpenMP's runtimes read OMP_WAIT_POLICY, GOMP_SPINCOUNT and KMP_BLOCKTIME when they are loaded; rows of tables state them.";

void declare_waits_and_files(CLI::App& app, ProfileArguments& arguments) {
    app.add_option("--wait", arguments.wait, "Wait policy of flow and barrier: spin, balanced or passive")
        ->type_name("POLICY")
        ->check(CLI::IsMember({"spin", "balanced", "passive"}))
        ->capture_default_str();
    app.add_flag("--pin", arguments.choice.pin, "Pin each thread to a processor");
    declare_output(app, arguments.output);
    app.add_option("--trace", arguments.trace, "Trace of the recorded passes, for chrome://tracing or ui.perfetto.dev")->type_name("FILE");
}

}  // namespace

Action declare_profile(CLI::App& app) {
    const auto arguments = std::make_shared<ProfileArguments>();
    MeasureOptions& measure = arguments->measure;
    declare_scene(app, arguments->scene);
    declare_shortcut(app, arguments->scene, "--method", "run.method", "NAME");
    declare_shortcut(app, arguments->scene, "--step", "run.step", "TIME");
    app.add_option("--schedules", arguments->choice.names,
                   "EXECUTOR[:ASSEMBLY], separated by commas (default: all, fused and staged; staged-serial-cholesky, -transition, -both "
                   "leave parts in one task)")
        ->type_name("LIST")
        ->delimiter(',');
    app.add_option("--threads", arguments->choice.threads, "Numbers of threads (default: all usable)")
        ->type_name("LIST")
        ->delimiter(',')
        ->check(CLI::Range(1, 1024));
    app.add_option("--segments", arguments->choice.segments, "Numbers of segments; 0: as many as threads (default)")
        ->type_name("LIST")
        ->delimiter(',')
        ->check(CLI::NonNegativeNumber);
    app.add_option("--steps", measure.steps, "Steps per round (default: chosen by --round-ms)")
        ->type_name("N")
        ->check(CLI::Range(1L, 10000000L));
    app.add_option("--rounds", measure.rounds, "Timed rounds")->type_name("N")->check(CLI::Range(1, 10000))->capture_default_str();
    app.add_option("--round-ms", arguments->round_milliseconds, "Time per round; schedules with a round over 2 s are dropped")
        ->type_name("MS")
        ->check(CLI::Range(1.0, 2000.0))
        ->capture_default_str();
    app.add_option("--neighbours", measure.neighbours, "Numbers of busy threads of other load, each measured; 0 always is")
        ->type_name("LIST")
        ->delimiter(',')
        ->check(CLI::Range(0, 1024))
        ->default_str("0,1,2");
    declare_waits_and_files(app, *arguments);
    app.add_flag("-q,--quiet", arguments->quiet, "No progress; results are printed all the same");
    app.footer(profile_explanation);
    return [arguments] { return profile(*arguments); };
}

}  // namespace cvtflow::bench
