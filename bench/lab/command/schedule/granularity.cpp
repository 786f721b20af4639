#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <memory>

#include "bench/executor/further_executors.hpp"
#include "bench/lab/command/command.hpp"
#include "bench/lab/report/granularity_report.hpp"
#include "engine/base/provenance.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

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
    folder.write("granularity.json", granularity_json(result, options));
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

}  // namespace cvtflow::bench
