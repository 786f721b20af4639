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

void print_cases(const ExtremeResult& result) {
    for (const ExtremeCase& one : result.cases) {
        fmt::print("    {:<6} {:<18} {:<9} step {:.2g} s (stable {:.2g} s), {} steps, balance {:.1g}, half step {:.1g}, {:.2f} s  {}\n",
                   one.detail, one.method, ending_name(one.ending), one.step, one.stable_step, one.steps, one.balance, one.refinement,
                   one.wall, one.message);
    }
}

ExitStatus run_extremes(const ExtremesArguments& arguments) {
    ExtremeJudge judge(tasks::read_scene(tasks::find_scene("tiny")));
    fmt::print("{:<10} {:<72} {:<6} {}\n", "group", "row", "", "outcome: number of cases (4 methods x 3 levels of detail)");
    int rows = 0, failed = 0;
    for (const Extreme& row : bench::extremes()) {
        if ((!arguments.group.empty() && row.group != arguments.group) || (row.nightly && !arguments.nightly)) continue;
        const ExtremeResult result = judge.judge(row);
        ++rows;
        failed += result.passed ? 0 : 1;
        fmt::print("{:<10} {:<72} {:<6} {}\n", row.group, row.name, result.passed ? "ok" : "NOT OK", result.outcome());
        if (arguments.cases) print_cases(result);
        std::fflush(stdout);
    }
    fmt::print("{} rows, {} with an unexpected outcome\n", rows, failed);
    if (rows == 0) throw UsageError(fmt::format("no group '{}' of extremes", arguments.group));
    return failed == 0 ? ExitStatus::finished : ExitStatus::fault;
}

}  // namespace

Action declare_extremes(CLI::App& app) {
    const auto arguments = std::make_shared<ExtremesArguments>();
    app.add_option("--group", arguments->group,
                   "Run one group only: friction, damping, stiffness, masses, pins, pitch, plates, joints, operation, contact, steps, "
                   "numbers, limits");
    app.add_flag("--nightly", arguments->nightly, "Run rows that take minutes, too");
    app.add_flag("--cases", arguments->cases, "Print every case of every row");
    app.footer(
        "Every row runs the scene tiny at an extreme value, with four methods at four levels of detail. Each run must be accurate (energy "
        "balance,\nagreement with half the step), refused with a message, ended by a named fault, or warned of as beyond stability.\n"
        "Exit status 3: a row has another outcome than stated.");
    return [arguments] { return run_extremes(*arguments); };
}

}  // namespace cvtflow::bench
