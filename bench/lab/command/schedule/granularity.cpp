/// cvtflow-lab granularity: efficiency of executors against the length of tasks.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/executor/further_executors.hpp"
#include "bench/lab/command/command.hpp"
#include "bench/lab/show.hpp"
#include "bench/study/granularity/granularity.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

/// All points, and the shortest tasks with an efficiency of 50 %; "is_bound": those of the curve's beginning, so they may be shorter.
Json granularity_json(const Granularity& result, int rounds) {
    Json points = Json::array(), shortest = Json::array();
    for (const GranularityPoint& point : result.points)
        points.push_back(
            named("executor,threads,tasks,length_us,efficiency,efficiency_lower_quartile,efficiency_upper_quartile,cycle_us,ideal_us",
                  {point.executor, point.threads, point.tasks, 1e6 * point.length, point.efficiency.median, point.efficiency.lower_quartile,
                   point.efficiency.upper_quartile, 1e6 * point.cycle, 1e6 * point.ideal}));
    for (const std::string& executor : result.executors())
        for (const int tasks : result.tasks()) {
            const std::vector<GranularityPoint> curve = result.curve(executor, tasks);
            const double length = effective_granularity(curve);
            shortest.push_back(named("executor,tasks,length,is_bound",
                                     {executor, tasks, number_json(length), !curve.empty() && length == curve.front().length}));
        }
    return named("rounds,machine,requested,calibrated,crowded,points,shortest",
                 {rounds, machine_json(), result.requested, result.calibrated, result.crowded(), points, shortest});
}

struct GranularityArguments {
    GranularityOptions options;
    std::vector<double> lengths;  ///< [us]; none: those of the options
    double work_milliseconds = 4.0;
    std::string wait = "balanced";
    OutputArguments output;
    bool quiet = false;
};

const std::map<std::string, engine::Wait> ways_to_wait{
    {"spin", engine::Wait::spin}, {"balanced", engine::Wait::balanced}, {"passive", engine::Wait::passive}};

ExitStatus granularity(const GranularityArguments& arguments) {
    GranularityOptions options = arguments.options;
    options.wait = ways_to_wait.at(arguments.wait);
    options.work = 1e-3 * arguments.work_milliseconds;
    if (!arguments.lengths.empty()) options.lengths.clear();
    for (const double length : arguments.lengths) options.lengths.push_back(1e-6 * length);
    std::sort(options.lengths.begin(), options.lengths.end());
    const Granularity result = measure_granularity(options, [&](const std::string& line) { say(arguments.quiet, line); });
    show("granularity", granularity_json(result, options.rounds), arguments.output);
}

constexpr const char* granularity_explanation =
    "METG is the minimum effective task granularity of Task Bench. All executors run the same graph with tasks of 0.1 to 100 us and the\n"
    "same total work. A cycle has 8 levels of M tasks; each task depends on the same task and its neighbours of the level before. The\n"
    "controller runs between cycles. Tasks are dependent arithmetic, so their length is a number of instructions. Efficiency is the time\n"
    "of that work in a bare loop, divided by the number of usable threads, over the time of the executor in the same round.\n"
    "`<`: the shortest tasks sufficed; `-`: no task was long enough.";

void declare_graph(CLI::App& app, GranularityArguments& arguments) {
    GranularityOptions& options = arguments.options;
    app.add_option("--tasks", options.tasks, "Numbers of tasks per level")
        ->type_name("LIST")
        ->delimiter(',')
        ->check(CLI::Range(1, 4096))
        ->default_str("1,2,4,8,16,32,64");
    app.add_option("--lengths", arguments.lengths, "Lengths of a task [us] (default: 0.1,0.2,0.5 … 100)")
        ->type_name("LIST")
        ->delimiter(',')
        ->check(CLI::Range(0.001, 1e5));
    app.add_option("--levels", options.levels, "Levels per cycle")->type_name("N")->check(CLI::Range(1, 1000))->capture_default_str();
    app.add_option("--work-ms", arguments.work_milliseconds, "Total work of one measurement, which ends after five times that time")
        ->type_name("MS")
        ->check(CLI::Range(0.1, 1000.0))
        ->capture_default_str();
}

}  // namespace

Action declare_granularity(CLI::App& app) {
    const auto arguments = std::make_shared<GranularityArguments>();
    GranularityOptions& options = arguments->options;
    app.add_option("--executors", options.executors, "Executors to compare (default: all)")->type_name("LIST")->delimiter(',');
    app.add_option("--threads", options.threads, "Threads of each (default: all usable)")->type_name("N")->check(CLI::Range(1, 1024));
    declare_graph(app, *arguments);
    app.add_option("--rounds", options.rounds, "Alternating rounds")->type_name("N")->check(CLI::Range(1, 10000))->capture_default_str();
    app.add_option("--wait", arguments->wait, "Wait policy of flow and barrier: spin, balanced or passive")
        ->type_name("POLICY")
        ->check(CLI::IsMember({"spin", "balanced", "passive"}))
        ->capture_default_str();
    app.add_flag("--pin", options.pin, "Pin each thread to a processor");
    declare_output(app, arguments->output);
    app.add_flag("-q,--quiet", arguments->quiet, "No progress; results are printed all the same");
    app.footer(granularity_explanation);
    return [arguments] { return granularity(*arguments); };
}

tools::Action declare_executors(CLI::App&) {
    return [] {
        fmt::print("{}\nRuntimes: {}.\n{}", tools::executor_table(), runtime_versions(), tools::absent_executor_text());
        return tools::ExitStatus::finished;
    };
}

}  // namespace cvtflow::bench
