#include "tools/program/command/sweep/batch.hpp"
#include "engine/base/text.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "tasks/batch/results/results.hpp"
#include "tasks/run/run_recorder.hpp"
#include "tasks/schedule/schedule.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/front.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/program.hpp"
#include "tools/program/progress.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

std::string progress_line(const tasks::BatchProgress& p) {
    const double rate = static_cast<double>(p.done) / std::max(p.wall, 1e-9), left = p.left();
    return fmt::format("{} of {} cases, {:.3g} a second{}{}", p.before + p.done, p.cases, rate,
                       std::isnan(left) ? "" : fmt::format(", {} left", clock_text(left)),
                       p.failed > 0 ? fmt::format(", {} failed", p.failed) : "");
}

/// A line of standard output, for programs that read it while the sweep runs.
void print_json(const nlohmann::ordered_json& line) {
    fmt::print("{}\n", line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    std::fflush(stdout);
}

nlohmann::ordered_json progress_json(const tasks::BatchProgress& p) {
    return {{"event", "progress"}, {"done", p.before + p.done}, {"failed_now", p.failed},
            {"wall", p.wall},      {"cases", p.cases},          {"left", p.left()}};  // NaN becomes null
}

/// The file with all rows; the folder as long as it is not written.
std::string table_of(const tasks::BatchReport& report) { return report.folder + (report.finished ? "/results.csv" : ""); }

/// The last line of batch --json.
nlohmann::ordered_json end_json(const tasks::Sweep& sweep, const tasks::BatchReport& report, ExitStatus status) {
    const tasks::BatchProgress& p = report.progress;
    nlohmann::ordered_json line{{"event", report.finished ? "finished" : "stopped"},
                                {"sweep", sweep.name},
                                {"folder", report.folder},
                                {"table", table_of(report)},
                                {"cases", p.cases},
                                {"done", p.before + p.done},
                                {"done_now", p.done},
                                {"wall", p.wall},
                                {"threads", report.threads},
                                {"results_hash", report.results_hash}};
    line.update(tally_json(report.tally));
    if (!report.continuation_error.empty()) line["continuation_error"] = report.continuation_error;
    if (!report.steady_check.empty()) line["steady_check"] = report.steady_check;
    line["exit_status"] = static_cast<int>(status);
    return line;
}

void print_end(const tasks::Sweep& sweep, const tasks::BatchReport& report, const tasks::BatchOptions& options) {
    const tasks::BatchProgress& p = report.progress;
    fmt::print("{}: {}\n", sweep.name,
               report.finished ? "finished"
                               : fmt::format("stopped after {} of {} cases; to continue: cvtflow resume {}{}", p.before + p.done, p.cases,
                                             options.folder, report.hopeless.empty() ? "" : " --keep-going"));
    std::string text = field("cases", fmt::format("{} now in {:.2f} s on {}, {:.3g} a second{}", p.done, p.wall,
                                                  plural(report.threads, "thread"), static_cast<double>(p.done) / std::max(p.wall, 1e-9),
                                                  p.before > 0 ? fmt::format("; {} before", p.before) : ""));
    text += tally_text(report.tally) + field("results hash", report.results_hash) + field("table", table_of(report));
    if (!report.continuation_error.empty()) text += field("continuation error", report.continuation_error);
    if (!report.steady_check.empty()) text += field("three times as long", report.steady_check);
    fmt::print("{}", text);
}

/// `finished` only if all cases are ok.
ExitStatus status_of(const tasks::CaseTally& tally) { return tally.failed() == 0 ? ExitStatus::finished : ExitStatus::incomplete; }

/// Runs a part of a sweep in a child process.
ExitStatus run_part(const tasks::Sweep& sweep, tasks::BatchOptions options, SweepOutput output) {
    const bool quiet = output.quiet;
    tasks::BatchReport report;
    const engine::Cancellation& interrupted = catch_interrupts();
    {
        StatusLine line(quiet, output.json);
        options.cancel = &interrupted;
        options.progress = [&line, json = output.json](const tasks::BatchProgress& progress) {
            if (!line.due()) return;
            if (!json) return line.show(progress_line(progress));
            print_json(progress_json(progress));
            line.wait();
        };
        options.notice = [&line](const std::string& what) { line.say(what); };
        if (options.part.only) options.threads = 1;
        report = tasks::run_batch(sweep, options);
    }
    if (options.part.only && !interrupted.requested()) return ExitStatus::finished;
    const ExitStatus status = !report.hopeless.empty()                      ? ExitStatus::incomplete
                              : !report.finished || interrupted.requested() ? ExitStatus::cancelled
                                                                            : status_of(report.tally);
    if (output.json) print_json(end_json(sweep, report, status));
    if (!quiet && !output.json) print_end(sweep, report, options);
    if (!quiet) print_notices();
    if (!report.hopeless.empty()) print_error(fmt::format("{}: {}; --keep-going runs the others", sweep.name, report.hopeless));
    return status;
}

/// Runs the sweep or its part in child processes.
ExitStatus run_supervised(const tasks::Sweep& sweep, tasks::BatchOptions options, SweepOutput output) {
    engine::SharedSlots journal(options.threads);
    options.journal = &journal;
    const auto work = [&](const tasks::SweepPart& part) {
        tasks::BatchOptions here = options;
        here.part = part;
        return finish_output(guarded([&] { return static_cast<int>(run_part(sweep, here, output)); }));
    };
    return static_cast<ExitStatus>(tasks::supervise(journal, work, print_error));
}

constexpr long shown_cases = 20;

struct BatchArguments {
    std::string sweep;
    tasks::BatchOptions options;
    std::optional<std::string> grace;  ///< an empty text is an error
    SweepOutput output;
    bool dry = false, tuned = false;
};

/// @throws UsageError for an unknown status
void require_statuses(const std::vector<std::string>& given) {
    const auto names = tasks::status_names();
    for (const std::string& name : given) {
        if (std::find(names.begin(), names.end(), name) == names.end())
            throw UsageError(fmt::format("--retry {}: not one of {}", name, fmt::join(names, ", ")));
    }
}

std::string cases_text(const tasks::Sweep& sweep) {
    std::vector<Table::Column> columns{{"case", Align::right}};
    for (const tasks::Axis& axis : sweep.axes) {
        for (const tasks::Parameter* key : axis.keys)
            columns.push_back({key->unit.empty() || key->unit == "1" ? std::string(key->key) : fmt::format("{} [{}]", key->key, key->unit),
                               Align::right});
    }
    Table table(columns);
    for (long number = 0; number < std::min(sweep.cases(), shown_cases); ++number) {
        std::vector<std::string> cells{std::to_string(number)};
        for (std::size_t a = 0; a < sweep.axes.size(); ++a) {
            const tasks::Axis& axis = sweep.axes[a];
            for (std::size_t k = 0; k < axis.keys.size(); ++k) {
                const std::string text = tasks::axis_text(*axis.keys[k], axis.at(sweep.row(number, a), k));
                const std::optional<double> value = engine::number_of(text);
                cells.push_back(value ? fmt::format("{:.6g}", *value) : text);
            }
        }
        table.add(cells);
    }
    const long more = sweep.cases() - shown_cases;
    return table.text(2) + (more > 0 ? fmt::format("  … and {} more\n", more) : "");
}

/// Disk space that the sweep will take.
std::string disk_text(const tasks::Sweep& sweep) {
    constexpr double bytes_of_cell = 13.0, copies = 2.0;  // rows by process, and all of them in the end
    const double cells = static_cast<double>(sweep.cases()) * static_cast<double>(tasks::result_columns(sweep).size());
    std::string text = size_text(copies * bytes_of_cell * cells) + " of results";
    if (!sweep.records) return text;
    tasks::Scene scene = sweep.scene;
    double records = 0.0;
    for (long number = 0; number < sweep.cases(); ++number) {
        sweep.apply_case(number, scene);
        if (tasks::violations(scene).empty()) records += tasks::record_bytes(scene, model::make_chain(scene.parameters));
    }
    return text + fmt::format(", up to {} of records", size_text(records));
}

ExitStatus dry_run(const tasks::Sweep& sweep, int threads) {
    const tasks::BatchEstimate cost = tasks::estimate(sweep, 0.6);
    std::string text = fmt::format("{}: {}\n{}", sweep.name, plural(sweep.cases(), "case"), cases_text(sweep));
    std::vector<std::string> scalars;
    for (const tasks::Scalar& scalar : sweep.scalars) scalars.push_back(scalar.text);
    text += field("scalars", fmt::format("{}", fmt::join(scalars, ", ")));
    if (cost.bad > 0) text += field("invalid cases", plural(cost.bad, "case"));
    const std::string none =
        cost.bad == cost.cases ? "none: every case has inconsistent parameters" : "none: no case could be measured: " + cost.untried;
    text += field("estimate", cost.measured == 0 ? none
                                                 : fmt::format("{} on one thread, {} on {} (measured on {}, settling included)",
                                                               duration_text(cost.total), duration_text(cost.total / threads),
                                                               plural(threads, "thread"), plural(cost.measured, "case")));
    text += field("disk", disk_text(sweep));
    if (cost.stable_step > 0.0 && std::isfinite(cost.stable_step))
        text += field("stable to", fmt::format("{} at the start of the cases tried{}", time_text(cost.stable_step),
                                               cost.beyond > 1.0 ? "; run.step exceeds this limit" : ""));
    fmt::print("{}", text);
    return cost.measured == 0 ? ExitStatus::incomplete : ExitStatus::finished;
}

ExitStatus batch(const BatchArguments& arguments) {
    const tasks::Sweep sweep = load_sweep(arguments.sweep);
    tasks::BatchOptions options = arguments.options;
    if (options.folder.empty()) options.folder = "results/" + sweep.path.stem().string();
    if (options.threads == 0) options.threads = tasks::usable_threads();
    require_statuses(options.retry);
    if (arguments.grace) options.grace = seconds_of("--grace", *arguments.grace);
    if (arguments.dry) return dry_run(sweep, options.threads);
    if (arguments.options.folder.empty()) options.folder = default_place(sweep.path.stem().string());
    if (arguments.tuned) return run_sweep(load_sweep(options.folder + "/tuned.toml"), options, arguments.output);
    if (!(sweep.accuracy.target > 0.0)) return run_sweep(sweep, options, arguments.output);
    std::vector<std::string> words{
        "accuracy", "tune", sweep.path.string(), options.folder, std::to_string(options.threads), arguments.output.quiet ? "quiet" : ""};
    words.insert(words.end(), given_words().begin(), given_words().end());
    become_python(words);  // which tunes, and executes these words with --tuned
}

}  // namespace

std::string sweep_of(const std::string& folder) { return tasks::read_facts(folder).text("sweep_path"); }

std::string tally_text(const tasks::CaseTally& tally) {
    std::vector<std::string> parts;
    for (const auto& [status, count] : tally.statuses()) parts.push_back(fmt::format("{} {}", count, status));
    std::string text = field("statuses", parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, ", ")));
    const long failed = tally.failed();
    if (failed > 0)
        text += field("failed", fmt::format("{} of {} ({:.3g} %)", failed, plural(tally.rows(), "case"),
                                            100.0 * static_cast<double>(failed) / static_cast<double>(tally.rows())));
    long named = 0;
    for (const tasks::CaseTally::Failure& failure : tally.failures()) {
        named += failure.cases;
        text += field("", fmt::format("{} {}: {} (first: case {})", failure.cases, failure.status, failure.error, failure.first));
    }
    if (named > 0 && named < failed) text += field("", fmt::format("{} with other messages", failed - named));
    parts.clear();
    for (const auto& [name, count] : tally.notes()) parts.push_back(fmt::format("{} {} of {}", name, count, tally.rows()));
    return text + (parts.empty() ? "" : field("notes", fmt::format("{}", fmt::join(parts, ", "))));
}

nlohmann::ordered_json tally_json(const tasks::CaseTally& tally) {
    nlohmann::ordered_json failures = nlohmann::ordered_json::array();
    for (const tasks::CaseTally::Failure& failure : tally.failures())
        failures.push_back({{"status", failure.status}, {"error", failure.error}, {"first_case", failure.first}, {"cases", failure.cases}});
    return {{"statuses", tally.statuses()}, {"failed", tally.failed()}, {"failures", failures}, {"notes", tally.notes()}};
}

ExitStatus run_sweep(const tasks::Sweep& sweep, tasks::BatchOptions options, SweepOutput output) {
    if (options.threads <= 0) options.threads = tasks::usable_threads();
    const ExitStatus status = run_supervised(sweep, options, output);
    const bool finished = status == ExitStatus::finished || status == ExitStatus::incomplete;
    if (!finished || !std::filesystem::exists(options.folder + "/accuracy.json")) return status;
    become_python(std::vector<std::string>{"accuracy", "verify", options.folder, std::to_string(static_cast<int>(status)),
                                           output.quiet ? "quiet" : ""});  // some cases at reference quality
}

Action declare_batch(CLI::App& app) {
    const auto arguments = std::make_shared<BatchArguments>();
    app.add_option("SWEEP", arguments->sweep, "Sweep file (SWEEP.toml), or name of a ready sweep in scenes/sweeps")
        ->required()
        ->type_name("");
    app.add_option(
           "-o,--output", arguments->options.folder,
           "Folder for the results (default: results/SWEEP). An unfinished sweep there is continued; where other processes run it, on "
           "this machine or others, cases are shared with them")
        ->type_name("DIR");
    app.add_flag("--dry-run", arguments->dry, "Print the cases and the estimated time; run nothing");
    app.add_option("--threads", arguments->options.threads,
                   "Number of cases that run in parallel (default: all processors of this process)")
        ->type_name("N")
        ->check(CLI::Range(1, 1024));
    app.add_flag("--pin", arguments->options.pin, "Pin every worker to a processor");
    app.add_option("--grace", arguments->grace,
                   "After SIGTERM, time for running cases to finish; the others begin again later (default: 30 s)")
        ->type_name("TIME");
    declare_repeated(app, "--retry", arguments->options.retry,
                     "Repeat cases that ended with this status, e.g. budget; may be given several times", "STATUS");
    app.add_flag("--keep-going", arguments->options.keep_going, keep_going_meaning);
    app.add_flag("--tuned", arguments->tuned)->group("");  // the sweep at the level that [accuracy] has chosen
    app.add_flag("-q,--quiet", arguments->output.quiet, "Print errors only");
    app.add_flag("--json", arguments->output.json,
                 "Print lines of JSON: at most every 10 s the progress (not with -q), at the end a summary with the exit status")
        ->excludes("--dry-run");
    app.footer("Results do not depend on threads, processes or interruptions. cvtflow table DIR shows them.\n\n" +
               std::string(exit_status_help));
    return [arguments] { return batch(*arguments); };
}

}  // namespace cvtflow::tools
