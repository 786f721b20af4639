#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "bench/lab/command/command.hpp"
#include "bench/study/extremes/extremes.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

struct ExtremesArguments {
    std::string group;
    bool nightly = false, cases = false;
};

ExitStatus run_extremes(const ExtremesArguments& arguments) {
    const ExtremeJudge judge(tasks::read_scene(tasks::find_scene("tiny")));
    int rows = 0, failed = 0;
    for (const Extreme& row : bench::extremes()) {
        if ((!arguments.group.empty() && row.group != arguments.group) || (row.nightly && !arguments.nightly)) continue;
        const ExtremeResult result = judge.judge(row);
        ++rows;
        failed += result.passed ? 0 : 1;
        fmt::print("{:<60} {:<6} {}\n", row.name, result.passed ? "ok" : "NOT OK", result.outcome());
        for (const ExtremeCase& one : result.cases) {
            if (!arguments.cases && result.passed) break;
            fmt::print("    {:<6} {:<18} {:<9} step {:.2g} s, balance {:.1g}, half step {:.1g}, {:.2f} s  {}\n", one.detail, one.method,
                       ending_name(one.ending), one.step, one.balance, one.refinement, one.wall, one.message);
        }
        std::fflush(stdout);
    }
    fmt::print("{} rows, {} with an unexpected outcome\n", rows, failed);
    if (rows == 0) throw UsageError(fmt::format("no group '{}' of extremes", arguments.group));
    return failed == 0 ? ExitStatus::finished : ExitStatus::fault;
}

}  // namespace

Action declare_extremes(CLI::App& app) {
    const auto arguments = std::make_shared<ExtremesArguments>();
    app.add_option("--group", arguments->group, "Run the rows of one section of keys only (cvtflow explain): chain, tip, start, run, ...");
    app.add_flag("--nightly", arguments->nightly, "Run rows that take minutes, too");
    app.add_flag("--cases", arguments->cases, "Print every case of every row, not only of those that end otherwise than stated");
    app.footer(
        "Every row runs the scene tiny at the edge of a key, with four methods at every level of detail. Each run must be accurate (energy "
        "balance,\nagreement with half the step), refused with a message, ended by a named fault, or warned of as beyond stability.\n"
        "Exit status 3: a row has another outcome than stated.");
    return [arguments] { return run_extremes(*arguments); };
}

}  // namespace cvtflow::bench
