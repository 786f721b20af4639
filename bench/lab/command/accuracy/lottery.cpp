#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <memory>

#include "bench/lab/command/command.hpp"
#include "bench/study/extremes/lottery.hpp"
#include "tasks/scene/csv.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

struct LotteryArguments {
    std::uint64_t seed = 1;
    long first = 0, machines = 40;
    int threads = 1;
    bool settings = false, csv = false;
    LotteryRules rules;
};

std::string line_of(const LotteryTicket& t, const LotteryArguments& a) {
    if (a.csv)
        return fmt::format("{},{},{:.6g},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.3g},{:.3g},{:.3g},{:.3f}\n", t.number, t.detail, t.step,
                           tasks::csv_cell(t.status, true), tasks::csv_cell(t.notes, true), t.slip, t.exact_slip, t.loss, t.exact_loss,
                           t.residual, t.exact_residual, t.balance_error_ratio, t.wall);
    return fmt::format("{:>5} {:<17} {:>8.3g} {:<12} {:>8.3f} % {:>+8.3f} % {:>9.4g} J {:>+8.3f} % {:>8.2g} {:>8.2g} {:>8.2g}  {}{}\n",
                       t.number, t.detail, t.step, t.status, 100.0 * t.slip, 100.0 * (t.exact_loss > 0.0 ? t.slip_error(a.rules) : 0.0),
                       t.loss, 100.0 * (t.exact_loss > 0.0 ? t.loss_error() : 0.0), t.residual, t.exact_residual, t.balance_error_ratio,
                       t.notes, t.message.empty() ? "" : " " + t.message);
}

std::string heading(bool csv) {
    if (csv) return "machine,detail,step,status,notes,slip,exact_slip,loss,exact_loss,residual,exact_residual,error_ratio,wall\n";
    return fmt::format("{:>5} {:<17} {:>8} {:<12} {:>10} {:>10} {:>11} {:>10} {:>8} {:>8} {:>8}  {}\n", "", "detail", "step [s]", "status",
                       "slip", "off by", "losses", "off by", "residual", "finer", "error_ratio", "notes");
}

/// Notes against errors of means, in four fields.
ExitStatus compare_longer(const LotteryArguments& a) {
    const LotteryRules& rules = a.rules;
    long fields[2][2] = {}, compared = 0;
    if (a.csv) fmt::print("machine,status,later,notes,quantity,off,wall\n");
    for (const LongerTicket& t : play_longer(a.seed, a.first, a.machines, a.threads, rules)) {
        if (a.csv)
            fmt::print("{},{},{},{},{},{:.3g},{:.3f}\n", t.number, tasks::csv_cell(t.status, true), t.later, tasks::csv_cell(t.notes, true),
                       t.quantity, t.off, t.wall);
        else
            fmt::print("{:>5} {:<12} {:>8.2f} %  {:<16} {} {}\n", t.number, t.status, 100.0 * t.off, t.quantity, t.notes, t.later);
        if (!t.compared()) continue;
        ++compared;
        ++fields[t.noted()][t.off > rules.tolerance];
    }
    to_stderr(fmt::format(
        "{} machines, {:g} ms compared with {:g}: {} without a note (unsteady, uncertain) are right to {:g} %, {} are off; {} with it are "
        "right, {} off\n",
        compared, 1e3 * rules.duration, 1e3 * rules.longer * rules.duration, fields[0][0], 100.0 * rules.tolerance, fields[0][1],
        fields[1][0], fields[1][1]));
    return fields[0][1] == 0 ? ExitStatus::finished : ExitStatus::fault;
}

ExitStatus lottery(const LotteryArguments& arguments) {
    if (arguments.settings) {
        for (long k = 0; k < arguments.machines; ++k) {
            fmt::print("# machine {}\n", arguments.first + k);
            const LotteryMachine machine = lottery_machine(arguments.seed, arguments.first + k);
            if (!machine.scene.empty()) fmt::print("# of scene {}\n", machine.scene);
            for (const std::string& setting : machine.settings) fmt::print("--set '{}'\n", setting);
        }
        return ExitStatus::finished;
    }
    if (arguments.rules.longer > 0.0) return compare_longer(arguments);
    const auto tickets = play_all(arguments.seed, arguments.first, arguments.machines, arguments.threads, arguments.rules);
    fmt::print("{}", heading(arguments.csv));
    std::map<std::string, int> statuses;
    int broken = 0, silent = 0, alarms = 0;
    for (const LotteryTicket& ticket : tickets) {
        fmt::print("{}", line_of(ticket, arguments));
        ++statuses[ticket.status];
        broken += ticket.honest(arguments.rules) ? 0 : 1;
        silent += ticket.honest(arguments.rules) || ticket.notes.find("unsteady") != std::string::npos ? 0 : 1;
        alarms += ticket.false_alarm(arguments.rules) ? 1 : 0;
    }
    std::string counts;
    for (const auto& [status, count] : statuses) counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", count, status);
    to_stderr(fmt::format(
        "{} machines: {}; {} finished with errors above {:g} % ({} without the note unsteady), {} unreliable with errors below\n",
        tickets.size(), counts, broken, 100.0 * arguments.rules.tolerance, silent, alarms));
    return broken == 0 ? ExitStatus::finished : ExitStatus::fault;
}

}  // namespace

Action declare_lottery(CLI::App& app) {
    const auto arguments = std::make_shared<LotteryArguments>();
    app.add_option("--machines", arguments->machines, "Number of machines (default: 40)")->check(CLI::Range(1L, 1000000L))->type_name("N");
    app.add_option("--first", arguments->first, "Number of the first one (default: 0)")->check(CLI::NonNegativeNumber)->type_name("N");
    app.add_option("--seed", arguments->seed, "Seed of the draw (default: 1)")->type_name("N");
    app.add_option("--threads", arguments->threads, "Number of machines that run in parallel (default: 1)")
        ->check(CLI::Range(1, 1024))
        ->type_name("N");
    app.add_option("--detail", arguments->rules.detail,
                   "Level of detail of all machines, settled anew, with linear joints (default: as drawn)")
        ->type_name("NAME");
    app.add_option("--tolerance", arguments->rules.tolerance, "Largest error of slip and losses of a finished run (default: 0.01)")
        ->check(CLI::PositiveNumber)
        ->type_name("SHARE");
    app.add_option("--settling", arguments->rules.settling_time, "Time for which machines settle [s] (default: 0.02)")
        ->check(CLI::PositiveNumber)
        ->type_name("S");
    app.add_option("--duration", arguments->rules.duration, "Time for which machines run [s] (default: 0.02)")
        ->check(CLI::PositiveNumber)
        ->type_name("S");
    app.add_option("--longer", arguments->rules.longer,
                   "Compare means and notes on them with means of the last half of runs that are longer by this factor")
        ->check(CLI::Range(2.0, 1000.0))
        ->type_name("FACTOR");
    app.add_flag("--settings", arguments->settings, "Print the settings of the machines and run nothing");
    app.add_flag("--csv", arguments->csv, "Print a CSV table");
    app.footer(
        "Draws every physical parameter within a factor of 2 of its default, and clamping, speed, load, ratio, detail, laws and chain. "
        "Every\nother machine has hydraulics, drawn likewise. A third of the machines are ready scenes with their states and some drawn\n"
        "parameters. Some loads are zero, reversed or jump. Each machine settles\nfor 20 ms and runs for 20 ms with the default method and "
        "step, then again with a quarter of the step. Slip and "
        "losses of a finished\nrun must agree with that within the tolerance.\n\nExit status 3: a finished run was wrong.");
    return [arguments] { return lottery(*arguments); };
}

}  // namespace cvtflow::bench
