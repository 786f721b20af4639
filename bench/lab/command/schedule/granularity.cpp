/// cvtflow-lab granularity: efficiency of executors against the length of tasks, as text, CSV and pictures.

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
#include "bench/lab/plot/plot.hpp"
#include "bench/study/granularity/granularity.hpp"
#include "bench/study/profile/report.hpp"
#include "engine/base/provenance.hpp"
#include "tasks/scene/csv.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

/// Whether the shortest tasks reach an efficiency of 50 %.
bool all_effective(const std::vector<GranularityPoint>& curve) {
    return !curve.empty() && effective_granularity(curve) == curve.front().length;
}

std::string granularity_cell(const std::vector<GranularityPoint>& curve) {
    const double length = effective_granularity(curve);
    if (!std::isfinite(length)) return "-";
    return fmt::format("{}{:.3g}", all_effective(curve) ? "<" : "", 1e6 * length);
}

std::string conditions(const Granularity& result) {
    const engine::Provenance here = engine::current_provenance();
    return fmt::format("{} threads on {}; calibration got {:.2f} of {} processors{}; commit {}", result.requested, here.cpu,
                       result.calibrated, result.requested, result.crowded() ? ", other processes are busy" : "", here.commit);
}

/// Colours repeat after eight.
Line line_of_curve(std::size_t series) { return series < 8 ? Line::solid : Line::dashed; }

std::string in_quotes(const std::string& text) { return tasks::csv_cell(text, true, true); }

/// METG(50 %) of every executor (rows) by number of tasks (columns) [us]; "<0.1": the shortest tasks sufficed; "-": none was long enough.
std::string granularity_table(const Granularity& result) {
    std::vector<Table::Column> columns{{"executor"}};
    for (const int tasks : result.tasks()) columns.push_back({fmt::format("M = {}", tasks), Align::right});
    Table table(columns);
    for (const std::string& executor : result.executors()) {
        std::vector<std::string> cells{executor};
        for (const int tasks : result.tasks()) cells.push_back(granularity_cell(result.curve(executor, tasks)));
        table.add(cells);
    }
    return table.text(2);
}

/// A row per point, provenance in every row.
std::string granularity_csv(const Granularity& result) {
    std::string text =
        "executor,threads,tasks,length_us,efficiency,efficiency_lower_quartile,efficiency_upper_quartile,cycle_us,ideal_us,calibrated,"
        "processors,commit,compiler,flags,runtimes,cpu,cores,date\n";
    const engine::Provenance here = engine::current_provenance();
    const std::string provenance = fmt::format("{:.3f},{},{},{},{},{},{},{},{}", result.calibrated, result.requested, here.commit,
                                               in_quotes(here.compiler + " " + here.build_type), in_quotes(compiler_flags()),
                                               in_quotes(bench::runtime_versions()), in_quotes(here.cpu), here.cores, here.date);
    for (const GranularityPoint& point : result.points) {
        const Spread& efficiency = point.efficiency;
        text += fmt::format("{},{},{},{:.4g},{:.5f},{:.5f},{:.5f},{:.5g},{:.5g},{}\n", point.executor, point.threads, point.tasks,
                            1e6 * point.length, efficiency.median, efficiency.lower_quartile, efficiency.upper_quartile, 1e6 * point.cycle,
                            1e6 * point.ideal, provenance);
    }
    return text;
}

/// Efficiency against length, a curve per executor: one picture for every number of tasks.
std::vector<Plot> efficiency_plots(const Granularity& result) {
    std::vector<Plot> plots;
    for (const int tasks : result.tasks()) {
        Plot plot;
        plot.title = fmt::format("Efficiency against the length of a task, {} per level", plural(tasks, "task"));
        plot.subtitle = conditions(result);
        plot.x = {"length of a task [us]", Scale::logarithmic, 1.0, {}, {}};
        plot.y = {"efficiency", Scale::linear, 1.0, 0.0, 1.1};
        for (const std::string& executor : result.executors()) {
            Series series{executor, {}, Mark::small_dot, line_of_curve(plot.series.size()), ""};
            for (const GranularityPoint& point : result.curve(executor, tasks))
                series.points.push_back({1e6 * point.length, point.efficiency.median});
            plot.series.push_back(std::move(series));
        }
        plots.push_back(std::move(plot));
    }
    return plots;
}

/// METG(50 %) against the number of tasks, a curve per executor.
Plot granularity_plot(const Granularity& result) {
    Plot plot;
    plot.title = "Shortest tasks with half of the efficiency: METG(50 %)";
    plot.subtitle = conditions(result) + "; triangles: upper bounds";
    plot.x = {"tasks per level", Scale::logarithmic, 1.0, {}, {}};
    plot.y = {"METG(50 %) [us]", Scale::logarithmic, 1.0, {}, {}};
    std::vector<Series> bounds;
    for (const std::string& executor : result.executors()) {
        Series series{executor, {}, Mark::dot, line_of_curve(plot.series.size()), palette(plot.series.size())};
        Series bound{"", {}, Mark::triangle, Line::none, series.colour};
        for (const int tasks : result.tasks()) {
            const std::vector<GranularityPoint> curve = result.curve(executor, tasks);
            (all_effective(curve) ? bound : series).points.push_back({static_cast<double>(tasks), 1e6 * effective_granularity(curve)});
        }
        plot.series.push_back(std::move(series));
        if (!bound.points.empty()) bounds.push_back(std::move(bound));
    }
    plot.series.insert(plot.series.end(), bounds.begin(), bounds.end());
    return plot;
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

std::string heading(const Granularity& result, const GranularityOptions& options) {
    const engine::Provenance here = engine::current_provenance();
    return fmt::format("METG(50 %) [us]: shortest task length with an efficiency of 50 %; medians of {}\n",
                       plural(options.rounds, "round")) +
           field("machine", fmt::format("{}, {}", here.cpu, plural(here.cores, "core"))) +
           field("program", fmt::format("cvtflow {} ({}), {} {}", here.version, here.commit, here.compiler, here.build_type)) +
           field("libraries", bench::runtime_versions()) +
           field(result.crowded() ? "crowded" : "quiet",
                 fmt::format("calibration got {:.2f} of {}{}", result.calibrated, plural(result.requested, "processor"),
                             result.crowded() ? ": other processes are busy and affect these figures" : ""));
}

ExitStatus granularity(const GranularityArguments& arguments) {
    GranularityOptions options = arguments.options;
    options.wait = ways_to_wait.at(arguments.wait);
    options.work = 1e-3 * arguments.work_milliseconds;
    if (!arguments.lengths.empty()) options.lengths.clear();
    for (const double length : arguments.lengths) options.lengths.push_back(1e-6 * length);
    std::sort(options.lengths.begin(), options.lengths.end());
    const Granularity result = measure_granularity(options, [&](const std::string& line) {
        if (!arguments.quiet) print_error(line);
    });
    fmt::print("{}\n{}", heading(result, options), granularity_table(result));
    OutputFolder folder(arguments.output);
    folder.write("granularity.csv", granularity_csv(result));
    folder.write("granularity.svg", svg(granularity_plot(result)));
    folder.write("efficiency.svg", svg(efficiency_plots(result)));
    fmt::print("{}", folder.written());
    return ExitStatus::finished;
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
