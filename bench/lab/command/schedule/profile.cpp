/// cvtflow-lab profile: schedules against each other.

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/executor/further_executors.hpp"
#include "bench/lab/command/command.hpp"
#include "bench/lab/plot/plot.hpp"
#include "bench/study/profile/other_load.hpp"
#include "bench/study/profile/profile.hpp"
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

std::string microseconds(double seconds) { return fmt::format("{:.2f}", 1e6 * seconds); }

std::string factor(double value) { return value >= 0.1 ? fmt::format("{:.2f}", value) : fmt::format("{:.2g}", value); }

Table::Column right(std::string heading) { return {std::move(heading), Align::right}; }

std::vector<std::string> schedule_cells(const ScheduleResult& result) {
    return {result.name, fmt::format("{}", result.schedule.threads), fmt::format("{}", result.schedule.segments)};
}

bool recorded(const ScheduleResult& result) { return result.recording.pass.active() > 0; }

std::string bare_text(const Profile& profile) {
    std::string text = "bare barrier, time per cycle:";
    for (const ThreadCost& cost : profile.bare)
        text += fmt::format(" {} us ({})", microseconds(cost.seconds), plural(cost.threads, "thread"));
    return text + "\n";
}

/// Step and evaluation times, speed-ups, synchronisation: a row per schedule.
std::string timing_text(const Profile& profile) {
    Table table({{"schedule"},
                 right("threads"),
                 right("segments"),
                 right("step [us]"),
                 right("quartiles"),
                 right("evaluation"),
                 right("speed-up"),
                 right("cpu/wall"),
                 right("active"),
                 right("sync"),
                 right("alone"),
                 right("bare"),
                 right("min task"),
                 right("imbalance"),
                 right("recording"),
                 {""}});
    for (const ScheduleResult& result : profile.results) {
        const LoadResult& load = result.loads.front();
        const RecordedPass& pass = result.recording.pass;
        std::vector<std::string> cells = schedule_cells(result);
        cells.insert(cells.end(), {microseconds(load.step.median),
                                   fmt::format("{} .. {}", microseconds(load.step.lower_quartile), microseconds(load.step.upper_quartile)),
                                   microseconds(load.evaluation), factor(load.speed_up), fmt::format("{:.2f}", load.cpu_per_wall)});
        const bool known = recorded(result);
        const bool came = result.cycle.active == result.schedule.threads;
        cells.insert(cells.end(), {known ? fmt::format("{}", pass.active()) : "", known ? microseconds(pass.synchronisation()) : "",
                                   came ? microseconds(result.cycle.seconds) : "absent", microseconds(result.bare),
                                   known ? microseconds(pass.min_task()) : "", known ? fmt::format("{:.2f}", pass.imbalance()) : "",
                                   known ? fmt::format("{:+.0f} %", 100.0 * result.recording.cost) : "", load.dropped});
        table.add(cells);
    }
    return table.text() + bare_text(profile);
}

/// Gains over serial's turns, near and far rounds apart, and those of independent runs; nothing without threads.
std::string gains_text(const Profile& profile) {
    if (profile.processors_requested() < 2) return {};
    Table table({{"schedule"},
                 right("threads"),
                 right("segments"),
                 right("near"),
                 right("quartiles"),
                 right("rounds"),
                 right("far"),
                 right("quartiles"),
                 right("rounds")});
    const auto add = [&](std::vector<std::string> cells, const PairedGain& gain) {
        for (const auto& [spread, rounds] : {std::pair{gain.near, gain.near_rounds}, std::pair{gain.far, gain.far_rounds}}) {
            const bool known = rounds > 0;
            cells.insert(cells.end(), {known ? factor(spread.median) : "",
                                       known ? fmt::format("{} .. {}", factor(spread.lower_quartile), factor(spread.upper_quartile)) : "",
                                       fmt::format("{}", rounds)});
        }
        table.add(cells);
    };
    for (const ScheduleResult& result : profile.results)
        if (result.schedule.threads > 1) add(schedule_cells(result), result.paired);
    for (const CopiesGain& copies : profile.copies) add({"independent runs", fmt::format("{}", copies.threads), ""}, copies.paired);
    return fmt::format(
               "Speed-up against serial's turn of the same round, near: threads had just met within {} us, far: not; independent runs: as\n"
               "many serial ones at once, which share nothing\n",
               microseconds(bench::near_meeting)) +
           table.text();
}

/// Medians beside busy neighbours and factors against serial under the same load; empty if there were none.
std::string neighbours_text(const Profile& profile) {
    const std::vector<LoadResult>& loads = profile.results.front().loads;
    if (loads.size() < 2) return {};
    std::vector<Table::Column> columns{{"schedule"}, right("threads"), right("segments")};
    for (const LoadResult& load : loads) {
        columns.push_back(right(fmt::format("{} busy [us]", load.neighbours)));
        columns.push_back(right("factor"));
        columns.push_back(right("burnt"));
    }
    Table table(columns);
    for (const ScheduleResult& result : profile.results) {
        std::vector<std::string> cells = schedule_cells(result);
        for (const LoadResult& load : result.loads) {
            const bool known = load.rounds > 0;
            cells.push_back(known ? microseconds(load.step.median) : "dropped");
            cells.push_back(known ? fmt::format("{}{}", factor(load.speed_up), load.dropped.empty() ? "" : "*") : "");
            cells.push_back(known ? microseconds(load.burnt) : "");
        }
        table.add(cells);
    }
    return "Beside busy neighbours: time per step, speed-up against serial under the same load (*: dropped after that round), processor "
           "time per step beyond serial's [us]\n" +
           table.text();
}

/// "CCCCHHHH..": shares of a thread's time as letters, largest remainders filled up to exactly `width`.
std::string stage_bar(const ThreadTimes& times, const std::vector<StageRow>& rows, int width) {
    std::vector<int> cells(rows.size());
    std::vector<double> rest(rows.size());
    const double total = times.total();
    if (total <= 0.0) return std::string(static_cast<std::size_t>(width), ' ');
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const double exact = width * times.at(k) / total;
        cells[k] = static_cast<int>(std::floor(exact));
        rest[k] = exact - cells[k];
    }
    for (int left = width - std::accumulate(cells.begin(), cells.end(), 0); left > 0; --left) {
        const auto most = std::max_element(rest.begin(), rest.end());
        ++cells[static_cast<std::size_t>(most - rest.begin())];
        *most = 0.0;
    }
    std::string bar;
    for (std::size_t k = 0; k < rows.size(); ++k) bar += std::string(static_cast<std::size_t>(cells[k]), rows[k].letter);
    return bar;
}

/// A bar per thread and schedule, divided by stages.
std::string stages_text(const Profile& profile) {
    std::string text = "Stages by thread:";
    for (const StageRow& row : profile.stages.rows()) text += fmt::format(" {} {},", row.letter, row.name);
    text.back() = '\n';
    for (const ScheduleResult& result : profile.results) {
        const auto& threads = result.recording.pass.threads;
        for (std::size_t thread = 0; recorded(result) && thread < threads.size(); ++thread) {
            const std::string name = thread == 0 ? fmt::format("{} M={}", result.name, result.schedule.segments) : "";
            text += fmt::format("  {:<26} {:>2} |{}|", name, thread, stage_bar(threads[thread], profile.stages.rows(), 60));
            for (std::size_t row = 0; row < profile.stages.size(); ++row) {
                const double share = threads[thread].at(row) / threads[thread].total();
                if (share >= 0.005) text += fmt::format(" {} {:.0f}%", profile.stages.rows()[row].letter, 100.0 * share);
            }
            text += "\n";
        }
    }
    return text;
}

/// Sequential time by stage: of the serial staged run, or of the fused one if that was not measured.
std::string serial_text(const Profile& profile) {
    const auto staged = std::find_if(profile.results.begin(), profile.results.end(),
                                     [](const ScheduleResult& result) { return result.name == "serial:staged"; });
    const ScheduleResult& serial = staged == profile.results.end() ? profile.results.front() : *staged;
    const RecordedPass& pass = serial.recording.pass;
    std::string text = fmt::format("Where sequential time goes ({}):\n", serial.name);
    double total = 0.0;
    for (const ThreadTimes& thread : pass.threads) total += thread.total();
    for (std::size_t row = 0; row < profile.stages.size(); ++row) {
        const double share = total > 0.0 ? pass.sum(row) / total : 0.0;
        if (share == 0.0) continue;
        const double per_step = serial.recording.steps > 0 ? pass.sum(row) / static_cast<double>(serial.recording.steps) : 0.0;
        text += fmt::format("  {:<20} {:>5.1f} % {:>9} us per step  {}\n", profile.stages.rows()[row].name, 100.0 * share,
                            microseconds(per_step), std::string(static_cast<std::size_t>(std::lround(50.0 * share)), '#'));
    }
    const double serial_share = profile.results.front().recording.pass.serial_share();
    return text + field("serial share", fmt::format("{:.2f} % of serial:fused; Amdahl's law allows {:.3g} with 16 threads",
                                                    100.0 * serial_share, 1.0 / (serial_share + (1.0 - serial_share) / 16.0)));
}

/// Processors that the calibrations obtained; empty without calibration.
std::string crowding_text(const Profile& profile) {
    if (profile.calibrated < 0.0) return {};
    return fmt::format("calibration got {:.2f} of {} processors, the schedules {:.2f}; {:.2f} are required", profile.calibrated,
                       profile.processors_requested(), profile.processors_got(), crowded_below * profile.processors_requested());
}

std::string numbered(std::size_t number, const ScheduleResult& result) {
    return fmt::format("{} {}, {}, {}", number, result.name, plural(result.schedule.threads, "thread"),
                       plural(result.schedule.segments, "segment"));
}

std::string measured_on() {
    const engine::Provenance here = engine::current_provenance();
    return fmt::format("{}, {} usable processors, commit {}", here.cpu, tasks::usable_threads(), here.commit);
}

/// Colours repeat after eight.
Line line_of_series(std::size_t series) { return series < 8 ? Line::solid : Line::dashed; }

/// Time per step of each stage, summed over threads, waiting included, for every recorded schedule (horizontal axis: its number in the
/// tables). One series per stage, named as the graph's tasks.
Plot stages_plot(const std::string& scene, const Profile& profile) {
    Plot plot;
    plot.title = fmt::format("Stages of a step of {}", scene);
    plot.subtitle = measured_on();
    plot.x = {"schedule, by its number", Scale::linear, 1.0, 0.0, static_cast<double>(profile.results.size() + 1)};
    plot.y = {"time per step, all threads together [us]", Scale::logarithmic, 1.0, {}, {}};
    constexpr Mark marks[] = {Mark::dot, Mark::square, Mark::diamond, Mark::triangle, Mark::ring, Mark::cross};
    for (std::size_t row = 0; row < profile.stages.size(); ++row) {
        Series series{profile.stages.rows()[row].name, {}, marks[row / 8 % 6], Line::none, ""};
        for (std::size_t number = 0; number < profile.results.size(); ++number) {
            const Recording& recording = profile.results[number].recording;
            if (recording.steps == 0 || recording.pass.sum(row) <= 0.0) continue;
            series.points.push_back(
                {static_cast<double>(number + 1), 1e6 * recording.pass.sum(row) / static_cast<double>(recording.steps)});
        }
        if (!series.points.empty()) plot.series.push_back(std::move(series));
    }
    for (std::size_t number = 0; number < profile.results.size(); ++number)
        plot.series.push_back({numbered(number + 1, profile.results[number]), {}, Mark::none, Line::none, "#444444"});
    return plot;
}

/// Time per step beside busy neighbours, a curve per schedule.
Plot loads_plot(const std::string& scene, const Profile& profile) {
    Plot plot;
    plot.title = fmt::format("Time per step of {} beside busy neighbours", scene);
    plot.subtitle = measured_on();
    plot.x = {"busy neighbours", Scale::linear, 1.0, 0.0, {}};
    plot.y = {"time per step [us]", Scale::logarithmic, 1.0, {}, {}};
    for (const ScheduleResult& result : profile.results) {
        Series series{numbered(plot.series.size() + 1, result), {}, Mark::dot, line_of_series(plot.series.size()), ""};
        for (const LoadResult& load : result.loads) {
            if (load.rounds > 0) series.points.push_back({static_cast<double>(load.neighbours), 1e6 * load.step.median});
        }
        plot.series.push_back(std::move(series));
    }
    return plot;
}

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
