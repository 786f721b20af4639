/// cvtflow-lab profile: schedules against each other.

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/lab/command/command.hpp"
#include "bench/lab/command/schedule/runtimes.hpp"
#include "bench/lab/show.hpp"
#include "bench/study/profile/other_load.hpp"
#include "bench/study/profile/profile.hpp"
#include "bench/study/profile/trace.hpp"
#include "engine/base/hash.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

/// Variable that OpenMP's runtimes read when they are loaded.
std::string environment(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
}

/// Rows of profile.csv without the machine's columns, one for each load.
Json rows_of(const std::string& scene, const ScheduleResult& result, double calibrated) {
    const tasks::Schedule& schedule = result.schedule;
    const RecordedPass& pass = result.recording.pass;
    const auto if_recorded = [&](double value) { return pass.active() > 0 ? Json(value) : Json(); };
    const std::string wait = schedule.wait == engine::Wait::spin ? "spin" : schedule.wait == engine::Wait::passive ? "passive" : "balanced";
    Json rows = Json::array();
    for (const LoadResult& load : result.loads)
        rows.push_back(named(
            "scene,schedule,executor,assembly,threads,segments,neighbours,step_us,step_lower_quartile_us,step_upper_quartile_us,"
            "evaluation_us,speed_up,cpu_per_wall,rounds,dropped,active_threads,synchronisation_us,cycle_cost_us,least_task_us,imbalance,"
            "recording_cost,hash,wait,pinned,omp_wait_policy,gomp_spincount,kmp_blocktime,cpu_us,burnt_us,bare_barrier_us,gain_near,"
            "rounds_near,gain_far,rounds_far,calibrated",
            {scene,
             result.name,
             schedule.executor,
             assembly_name(schedule.assembly),
             schedule.threads,
             schedule.segments,
             load.neighbours,
             1e6 * load.step.median,
             1e6 * load.step.lower_quartile,
             1e6 * load.step.upper_quartile,
             1e6 * load.evaluation,
             load.speed_up,
             load.cpu_per_wall,
             load.rounds,
             load.dropped,
             pass.active() > 0 ? Json(pass.active()) : Json(),
             if_recorded(1e6 * pass.synchronisation()),
             result.cycle.active == schedule.threads ? Json(1e6 * result.cycle.seconds) : Json(),
             if_recorded(1e6 * pass.min_task()),
             if_recorded(pass.imbalance()),
             if_recorded(result.recording.cost),
             engine::hex(result.hash),
             wait,
             schedule.pin ? "yes" : "no",
             environment("OMP_WAIT_POLICY"),
             environment("GOMP_SPINCOUNT"),
             environment("KMP_BLOCKTIME"),
             1e6 * load.cpu,
             1e6 * load.burnt,
             1e6 * result.bare,
             result.paired.near.median,
             result.paired.near_rounds,
             result.paired.far.median,
             result.paired.far_rounds,
             calibrated}));
    return rows;
}

/// [[lower quartile, median, upper quartile, rounds] near, the same far]
Json gains_of(const PairedGain& gain) {
    const auto of = [](const Spread& spread, int rounds) {
        return Json::array({spread.lower_quartile, spread.median, spread.upper_quartile, rounds});
    };
    return Json::array({of(gain.near, gain.near_rounds), of(gain.far, gain.far_rounds)});
}

/// A schedule: "cells" that name it, "seconds" of its recorded pass, [thread][stage].
Json schedule_json(const std::string& scene, const ScheduleResult& result, const Profile& profile) {
    Json seconds = Json::array();
    for (const ThreadTimes& thread : result.recording.pass.threads) {
        Json& row = seconds.emplace_back(Json::array());
        for (std::size_t stage = 0; stage < profile.stages.size(); ++stage) row.push_back(thread.at(stage));
    }
    return named("cells,rows,gains,seconds,steps",
                 {Json::array({result.name, result.schedule.threads, result.schedule.segments}), rows_of(scene, result, profile.calibrated),
                  gains_of(result.paired), std::move(seconds), std::max(1L, result.recording.steps)});
}

Json profile_json(const std::string& scene, const Profile& profile, int rounds) {
    Json stages = Json::array(), schedules = Json::array(), bare = Json::array(), copies = Json::array();
    for (const StageRow& row : profile.stages.rows()) stages.push_back({row.name, std::string(1, row.letter)});
    for (const ScheduleResult& result : profile.results) schedules.push_back(schedule_json(scene, result, profile));
    for (const ThreadCost& cost : profile.bare) bare.push_back(Json::array({cost.threads, cost.seconds}));
    for (const CopiesGain& each : profile.copies) copies.push_back({{"threads", each.threads}, {"gains", gains_of(each.paired)}});
    Json json = named(
        "scene,rounds,machine,load_before,load_after,calibrated,requested,got,needed,crowded,meeting,serial_share,stages,schedules,bare,"
        "copies",
        {scene, rounds, machine_json(), profile.load_before, profile.load_after, profile.calibrated, profile.processors_requested(),
         profile.processors_got(), crowded_below * profile.processors_requested(), profile.crowded(), near_meeting,
         profile.results.front().recording.pass.serial_share(), stages, schedules, bare, copies});
    for (const std::string& line : profile.differences) json["complaints"].push_back("states differ: " + line);
    return json;
}

struct ProfileArguments {
    SceneArguments scene;
    ScheduleChoice choice;
    MeasureOptions measure;
    double round_milliseconds = 60.0;
    std::string trace;
    OutputArguments output;
    std::string wait = "balanced";
    bool runtimes = false;
    std::vector<std::string> openmp;
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

MeasureOptions options_of(const ProfileArguments& arguments) {
    MeasureOptions options = arguments.measure;
    options.round_seconds = 1e-3 * arguments.round_milliseconds;
    std::vector<int>& loads = options.neighbours;
    loads.push_back(0);
    std::sort(loads.begin(), loads.end());
    loads.erase(std::unique(loads.begin(), loads.end()), loads.end());
    return options;
}

/// What `--runtimes` compares, if other schedules are not requested.
void choose_for_runtimes(ProfileArguments& arguments) {
    if (arguments.choice.names.empty()) arguments.choice.names = {"flow:fused", "omp_region:fused", "omp_fork:fused", "omp_tasks:fused"};
    arguments.measure.neighbours = {0};
}

ExitStatus profile(ProfileArguments& arguments) {
    if (arguments.runtimes && !is_runtime_child()) show("runtimes", profiles_by_runtime(arguments.openmp), arguments.output);
    if (arguments.runtimes) choose_for_runtimes(arguments);
    const LoadedScene loaded = load_scene(arguments.scene);
    say(arguments.quiet, loaded.notice);
    const tasks::Scene& scene = loaded.scene;
    engine::require_no_input(arguments.trace, input_files(scene));
    const MeasureOptions options = options_of(arguments);
    ScheduleChoice choice = arguments.choice;
    choice.wait = waits.at(arguments.wait);
    const auto schedules = chosen_schedules(scene, choice);
    const auto progress = [&](const std::string& line) { say(arguments.quiet, line); };
    const Profile result = profile_schedules(scene, schedules, options, progress);
    if (!arguments.trace.empty()) write_file(arguments.trace, profile_trace(result));
    Json json = profile_json(scene.name, result, options.rounds);
    if (!is_runtime_child()) show("profile", std::move(json), arguments.output);
    hand_back(json);
    return ExitStatus::finished;
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
    CLI::Option* runtimes = app.add_flag("--runtimes", arguments.runtimes,
                                         "OpenMP's runtimes by wait policy beside flow and serial, each in a process of its own");
    app.add_option("--openmp", arguments.openmp, "Libraries of --runtimes beside the linked one (default: LLVM's libomp.so.5)")
        ->type_name("FILES")
        ->delimiter(',')
        ->needs(runtimes);
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
