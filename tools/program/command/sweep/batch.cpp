#include "tools/program/command/sweep/batch.hpp"
#include "engine/base/text.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "engine/record/case_table.hpp"
#include "tasks/batch/results/results.hpp"
#include "tasks/run/run_recorder.hpp"
#include "tasks/schedule/schedule.hpp"
#include "tasks/tuning/verified_sweep.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/program.hpp"
#include "tools/program/progress.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

/// @param shard  a worker knows only the cases that it has claimed so far
std::string progress_line(const tasks::BatchProgress& p, const tasks::Shard& shard) {
    const double rate = static_cast<double>(p.done) / std::max(p.wall, 1e-9), left = p.left();
    if (shard.claims())
        return fmt::format("{}: {}, {:.3g} a second{}", shard.text(), plural(p.before + p.done, "case"), rate,
                           p.failed > 0 ? fmt::format(", {} failed", p.failed) : "");
    return fmt::format("{} of {} cases, {:.3g} a second{}{}", p.before + p.done, p.cases, rate,
                       std::isnan(left) ? "" : fmt::format(", {} left", clock_text(left)),
                       p.failed > 0 ? fmt::format(", {} failed", p.failed) : "");
}

/// A line of standard output, for programs that read it while the sweep runs.
void print_json(const nlohmann::ordered_json& line) {
    fmt::print("{}\n", line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    std::fflush(stdout);
}

nlohmann::ordered_json progress_json(const tasks::BatchProgress& p, const tasks::Shard& shard) {
    nlohmann::ordered_json line{{"event", "progress"}, {"done", p.before + p.done}, {"failed_now", p.failed}, {"wall", p.wall}};
    if (shard.claims()) return line.update({{"worker", shard.number}}), line;
    return line.update({{"cases", p.cases}, {"left", p.left()}}), line;  // NaN becomes null
}

/// Whether nothing is left to do. A worker that was stopped after the last case it had claimed leaves cases that no worker has claimed.
bool ended(const tasks::BatchReport& report, ExitStatus status) { return report.finished && status != ExitStatus::cancelled; }

/// The last line of batch --json.
nlohmann::ordered_json end_json(const tasks::Sweep& sweep, const tasks::BatchReport& report, ExitStatus status) {
    const tasks::BatchProgress& p = report.progress;
    nlohmann::ordered_json line{{"event", ended(report, status) ? "finished" : "stopped"},
                                {"sweep", sweep.name},
                                {"folder", report.folder},
                                {"table", report.folder + "/cases.h5"},
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

void print_end(const tasks::Sweep& sweep, const tasks::BatchReport& report, const tasks::BatchOptions& options, ExitStatus status) {
    const tasks::BatchProgress& p = report.progress;
    const std::string of_all = options.shard.claims() ? "" : fmt::format(" of {}", p.cases);
    fmt::print("{}: {}\n", sweep.name,
               ended(report, status) ? "finished"
                                     : fmt::format("stopped after {}{} cases; to continue: cvtflow resume {}{}", p.before + p.done, of_all,
                                                   options.folder, report.hopeless.empty() ? "" : " --keep-going"));
    std::string text = field("cases", fmt::format("{} now in {:.2f} s on {}, {:.3g} a second{}", p.done, p.wall,
                                                  plural(report.threads, "thread"), static_cast<double>(p.done) / std::max(p.wall, 1e-9),
                                                  p.before > 0 ? fmt::format("; {} before", p.before) : ""));
    text += tally_text(report.tally) + field("results hash", report.results_hash) + field("table", report.folder + "/cases.h5");
    if (!report.continuation_error.empty()) text += field("continuation error", report.continuation_error);
    if (!report.steady_check.empty()) text += field("three times as long", report.steady_check);
    fmt::print("{}", text);
}

/// `finished` only if all cases are ok.
ExitStatus status_of(const tasks::CaseTally& tally) { return tally.failed() == 0 ? ExitStatus::finished : ExitStatus::incomplete; }

/// Prints the verified errors of a table to stderr, if its sweep has a target accuracy; quiet: only if it is missed.
/// @return whether the target is met, or there is none   @throws engine::RecordError
bool say_verification(const std::string& name, const std::string& file, bool quiet) {
    const tasks::SweepVerification verification = tasks::sweep_verification(file);
    if (!(verification.target > 0.0)) return true;
    if (!quiet || !verification.held())
        print_error(fmt::format("{}: {}{}", name, verification.held() ? "" : "misses its target: ", verification.text()));
    return verification.held();
}

/// Repeats some cases at reference accuracy, if the sweep has a target accuracy. @return whether it is met
bool verified(const tasks::Sweep& asked, const tasks::TunedSweep& tuned, tasks::BatchReport& report, bool quiet) {
    if (!(asked.accuracy.target > 0.0) || catch_interrupts().requested()) return true;
    const auto say = [quiet](const std::string& what) { tools::say(quiet, what); };
    std::vector<std::string> remarks;
    try {
        remarks = tasks::verify_sweep(asked, tuned, report.folder, catch_interrupts(), say);
    } catch (const tasks::SimulationError&) {
        if (!catch_interrupts().requested()) throw;
        return true;
    }
    for (const std::string& remark : remarks) print_error("not verified: " + remark);
    const std::string file = report.folder + "/cases.h5";
    report.results_hash = engine::CaseReader(file).head().attribute("results_hash");
    return say_verification(asked.name, file, quiet) && (remarks.empty() || tasks::sweep_verification(file).verified > 0);
}

/// Runs a part of a sweep in a child process.
ExitStatus run_part(const tasks::Sweep& asked, const tasks::TunedSweep& tuned, tasks::BatchOptions options, SweepOutput output) {
    const tasks::Sweep& sweep = tuned.sweep;
    const bool quiet = output.quiet;
    tasks::BatchReport report;
    const engine::Cancellation& interrupted = catch_interrupts();
    {
        StatusLine line(quiet, output.json);
        options.cancel = &interrupted;
        options.progress = [&line, json = output.json, shard = options.shard](const tasks::BatchProgress& progress) {
            if (!line.due()) return;
            if (!json) return line.show(progress_line(progress, shard));
            print_json(progress_json(progress, shard));
            line.wait();
        };
        options.notice = [&line](const std::string& what) { line.say(what); };
        if (options.part.only) options.threads = 1;
        report = tasks::run_batch(sweep, options);
    }
    if (options.part.only && !interrupted.requested()) return ExitStatus::finished;
    if (options.shard.claims() && report.finished && !interrupted.requested()) {
        if (!output.json) say(quiet, progress_line(report.progress, options.shard));
        return ExitStatus::finished;
    }
    const bool accurate = !report.finished || verified(asked, tuned, report, quiet);
    const ExitStatus status = !report.hopeless.empty()                      ? ExitStatus::incomplete
                              : !report.finished || interrupted.requested() ? ExitStatus::cancelled
                              : accurate                                    ? status_of(report.tally)
                                                                            : ExitStatus::inaccurate;
    if (output.json) print_json(end_json(sweep, report, status));
    if (!quiet && !output.json) print_end(sweep, report, options, status);
    if (!quiet) print_notices();
    if (!report.hopeless.empty()) print_error(fmt::format("{}: {}; --keep-going runs the others", sweep.name, report.hopeless));
    return status;
}

/// Tunes a sweep in the parent process, once for all children.
tasks::TunedSweep tuned_here(const tasks::Sweep& sweep, const std::string& folder, bool quiet) {
    if (!(sweep.accuracy.target > 0.0)) return {sweep, {}, std::nullopt};
    const auto say = [quiet](const std::string& what) { tools::say(quiet, what); };
    tasks::TunedSweep tuned = tasks::tuned_sweep(sweep, folder, catch_interrupts(), say);
    say(fmt::format("{}: {} for {:g} % (largest error at the corners: {:.2g} %){}", sweep.name, tuned.kept.choice.text(),
                    100.0 * sweep.accuracy.target, 100.0 * tuned.kept.error,
                    tuned.result ? fmt::format(", found in {}", clock_text(tuned.result->wall)) : ", from the cache"));
    return tuned;
}

/// Runs the sweep or its part in child processes.
ExitStatus run_supervised(const tasks::Sweep& asked, const tasks::TunedSweep& tuned, tasks::BatchOptions options, SweepOutput output) {
    engine::SharedSlots journal(options.threads);
    options.journal = &journal;
    const auto work = [&](const tasks::SweepPart& part) {
        tasks::BatchOptions here = options;
        here.part = part;
        return guarded([&] { return static_cast<int>(run_part(asked, tuned, here, output)); });
    };
    return static_cast<ExitStatus>(tasks::supervise(journal, work, print_error));
}

/// @return whether it was interrupted
bool pause() {
    usleep(200'000);
    return catch_interrupts().requested();
}

/// Runs one of several processes that share a sweep's cases. Each ends when all cases are done; the first one then merges their tables.
ExitStatus run_worker(const tasks::Sweep& asked, const tasks::TunedSweep& tuned, tasks::BatchOptions options, SweepOutput output) {
    const std::vector<std::string> retry = std::exchange(options.retry, {});  // of the merged table
    for (tasks::WorkerPlaces places(tuned.sweep, options.folder); !places.done();) {
        if (const std::optional<tasks::WorkerPlace> place = places.next()) {
            options.shard = {place->number, 0};
            const ExitStatus status = run_supervised(asked, tuned, options, output);
            if (status != ExitStatus::finished) return status;
        } else if (!places.done() && pause()) {
            return ExitStatus::cancelled;
        }
    }
    std::unique_ptr<engine::FolderLock> ending;  // one worker after the other
    while ((ending = engine::FolderLock::if_free(tasks::workers_folder(options.folder))) == nullptr)
        if (pause()) return ExitStatus::cancelled;
    if (tasks::awaits_workers(options.folder) && !tasks::merge(options.folder, false, options.mixed).missing_cases.empty())
        throw tasks::SimulationError(options.folder + ": cases are missing although all were claimed; cvtflow merge lists them");
    options.shard = {};
    options.retry = retry;
    return run_supervised(asked, tuned, options, output);
}

constexpr long shown_cases = 20;

struct BatchArguments {
    std::string sweep;
    tasks::BatchOptions options;
    std::optional<std::string> shard, grace, every;  ///< empty text is an error
    SweepOutput output;
    bool dry = false, worker = false;
};

tasks::Shard shard_of(const std::string& text) {
    const std::optional<tasks::Shard> shard = tasks::Shard::from(text);
    if (shard && !shard->claims()) return *shard;
    throw UsageError(fmt::format("--shard {}: expected I/N with 1 <= I <= N <= {}, e.g. 3/8", text, tasks::max_shards));
}

std::string cases_text(const tasks::Sweep& sweep, const std::vector<long>& cases) {
    std::vector<Table::Column> columns{{"case", Align::right}};
    for (const tasks::Axis& axis : sweep.axes) {
        for (const tasks::Parameter* key : axis.keys)
            columns.push_back({key->unit.empty() || key->unit == "1" ? std::string(key->key) : fmt::format("{} [{}]", key->key, key->unit),
                               Align::right});
    }
    Table table(columns);
    for (std::size_t i = 0; i < cases.size() && static_cast<long>(i) < shown_cases; ++i) {
        std::vector<std::string> cells{std::to_string(cases[i])};
        for (std::size_t a = 0; a < sweep.axes.size(); ++a) {
            const tasks::Axis& axis = sweep.axes[a];
            for (std::size_t k = 0; k < axis.keys.size(); ++k)
                cells.push_back(tasks::axis_text(*axis.keys[k], axis.at(sweep.row(cases[i], a), k)));
        }
        table.add(cells);
    }
    const long more = static_cast<long>(cases.size()) - shown_cases;
    return table.text(2) + (more > 0 ? fmt::format("  … and {} more\n", more) : "");
}

/// Disk space that the sweep will take.
std::string disk_text(const tasks::Sweep& sweep, const std::vector<long>& cases) {
    const double rows = static_cast<double>(cases.size());
    std::string text = size_text(rows * static_cast<double>(tasks::result_layout(sweep).bytes())) + " of results";
    if (!sweep.records || cases.empty()) return text;
    tasks::Scene scene = sweep.scene;
    double records = 0.0;
    for (const long number : cases) {
        sweep.apply_case(number, scene);
        if (tasks::violations(scene).empty()) records += tasks::record_bytes(scene, model::make_chain(scene.parameters));
    }
    return text + fmt::format(", up to {} of records", size_text(records));
}

ExitStatus dry_run(const tasks::Sweep& sweep, const tasks::Shard& shard, int threads) {
    const std::vector<long> cases = tasks::shard_cases(sweep, shard);
    const tasks::BatchEstimate cost = tasks::estimate(sweep, shard, 0.6);
    std::string text = fmt::format("{}: {}{}\n{}", sweep.name, plural(static_cast<long>(cases.size()), "case"),
                                   !shard.whole() ? fmt::format(" of shard {}/{}", shard.number, shard.of) : "", cases_text(sweep, cases));
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
    text += field("disk", disk_text(sweep, cases));
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
    if (arguments.shard) options.shard = shard_of(*arguments.shard);
    require_statuses("--retry", options.retry);
    if (arguments.grace) options.grace = seconds_of("--grace", *arguments.grace);
    if (arguments.every) options.checkpoint_every = seconds_of("--checkpoint-every", *arguments.every);
    if (arguments.dry) return dry_run(sweep, options.shard, options.threads);
    if (arguments.options.folder.empty()) options.folder = default_place(sweep.path.stem().string());
    return run_sweep(sweep, options, arguments.output, arguments.worker);
}

constexpr std::size_t named_cases = 20, named_shards = 5;

void report_missing(const tasks::MergeReport& report) {
    const std::vector<std::string>& shards = report.missing_shards;
    for (std::size_t k = 0; k < std::min(named_shards, shards.size()); ++k) print_error(shards[k] + ": this worker has no results");
    if (shards.size() > named_shards)
        print_error(fmt::format("… and {} more; {} workers have no results", shards.size() - named_shards, shards.size()));
    const std::vector<long>& cases = report.missing_cases;
    if (cases.empty()) return;
    const auto named = cases.begin() + static_cast<std::ptrdiff_t>(std::min(named_cases, cases.size()));
    print_error(fmt::format("{} of {} cases are missing: {}{}", cases.size(), report.cases, fmt::join(cases.begin(), named, ", "),
                            named != cases.end() ? ", …" : ""));
}

ExitStatus merge(const std::string& folder, bool partial, bool mixed) {
    const tasks::MergeReport report = tasks::merge(folder, partial, mixed);
    const bool whole = report.missing_cases.empty() && report.missing_shards.empty();
    if (!whole) report_missing(report);
    if (!whole && !partial) {
        print_error("nothing was written; run the missing shares, or use --partial to join the available ones");
        return ExitStatus::incomplete;
    }
    fmt::print("{}: {} of {} cases\n{}{}", engine::visible(report.file), report.rows, report.cases, tally_text(report.tally),
               field("results hash", report.results_hash));
    const bool accurate = say_verification(folder, report.file, false);
    return !whole ? ExitStatus::incomplete : accurate ? status_of(report.tally) : ExitStatus::inaccurate;
}

}  // namespace

std::string sweep_of(const std::string& folder) {
    std::error_code unreadable;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, unreadable)) {
        if (entry.path().filename() != "cases.h5") continue;
        const std::string file = entry.path().string();
        try {
            return engine::CaseReader(file).head().attribute("sweep_path");
        } catch (const engine::RecordError& error) {
            if (!engine::torn_while_growing(file, tasks::mark_of_a_sweep)) throw;
            throw engine::RecordError(
                fmt::format("{}\n  to continue with the intact rows: cvtflow batch SWEEP -o {}", error.what(), folder));
        }
    }
    throw tasks::SimulationError(folder + ": contains no sweep");
}

void require_statuses(const std::string& option, const std::vector<std::string>& given) {
    const auto names = tasks::status_names();
    for (const std::string& name : given) {
        if (std::find(names.begin(), names.end(), name) == names.end())
            throw UsageError(fmt::format("{} {}: not one of {}", option, name, fmt::join(names, ", ")));
    }
}

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

ExitStatus run_sweep(const tasks::Sweep& sweep, tasks::BatchOptions options, SweepOutput output, bool as_worker) try {
    if (options.threads <= 0) options.threads = tasks::usable_threads();
    const tasks::TunedSweep tuned = tuned_here(sweep, options.folder, output.quiet);
    std::error_code absent;
    const bool begun_by_workers = options.shard.whole() && std::filesystem::exists(tasks::claims_file(options.folder), absent);
    if ((as_worker || begun_by_workers) && tasks::awaits_workers(options.folder)) return run_worker(sweep, tuned, options, output);
    return run_supervised(sweep, tuned, options, output);
} catch (const tasks::AccuracyError& error) {
    print_error(error.what());
    return ExitStatus::inaccurate;
} catch (const tasks::SimulationError&) {  // tuning that was interrupted
    if (catch_interrupts().requested()) return ExitStatus::cancelled;
    throw;
}

Action declare_batch(CLI::App& app) {
    const auto arguments = std::make_shared<BatchArguments>();
    app.add_option("SWEEP", arguments->sweep, "Sweep file (SWEEP.toml), or name of a ready sweep in scenes/sweeps")
        ->required()
        ->type_name("");
    app.add_option("-o,--output", arguments->options.folder,
                   "Folder for the results (default: results/SWEEP); an unfinished sweep there is continued")
        ->type_name("DIR");
    app.add_flag("--dry-run", arguments->dry, "Print the cases and the estimated time; run nothing");
    app.add_option("--threads", arguments->options.threads,
                   "Number of cases that run in parallel (default: all processors of this process)")
        ->type_name("N")
        ->check(CLI::Range(1, 1024));
    app.add_flag("--pin", arguments->options.pin, "Pin every worker to a processor");
    app.add_option("--shard", arguments->shard,
                   "Be worker I of N with a fixed share of the cases, which needs no file locks; cvtflow merge joins the tables")
        ->type_name("I/N");
    app.add_option("--grace", arguments->grace,
                   "After SIGTERM, time for running cases to finish; the others write a checkpoint (default: 30 s)")
        ->type_name("TIME");
    app.add_option("--checkpoint-every", arguments->every, "Wall time between checkpoints of a running case (default: 60 s)")
        ->type_name("TIME");
    declare_repeated(app, "--retry", arguments->options.retry,
                     "Repeat cases that ended with this status, e.g. budget; may be given several times", "STATUS");
    CLI::Option* worker = app.add_flag("--worker", arguments->worker,
                                       "Share the cases with other processes that run this command with the same DIR, on any machine");
    for (const char* other : {"--shard", "--retry", "--dry-run"}) worker->excludes(other);
    app.add_flag("--keep-going", arguments->options.keep_going, keep_going_meaning);
    app.add_flag("--mixed", arguments->options.mixed, mixed_meaning);
    app.add_flag("-q,--quiet", arguments->output.quiet, "Print errors only");
    app.add_flag("--json", arguments->output.json,
                 "Print lines of JSON: at most every 10 s the progress (not with -q), at the end a summary with the exit status")
        ->excludes("--dry-run");
    app.footer("Results do not depend on threads, workers or interruptions. cvtflow table DIR shows them.\n\n" +
               std::string(exit_status_help));
    return [arguments] { return batch(*arguments); };
}

Action declare_merge(CLI::App& app) {
    const auto folder = std::make_shared<std::string>();
    const auto partial = std::make_shared<bool>(false), mixed = std::make_shared<bool>(false);
    app.add_option("DIR", *folder, "Folder of the sweep")->required()->type_name("");
    app.add_flag("--partial", *partial, "Join the available cases although others are missing");
    app.add_flag("--mixed", *mixed, mixed_meaning);
    app.footer("Missing workers and cases are listed.\n\n" + std::string(exit_status_help));
    return [folder, partial, mixed] { return merge(*folder, *partial, *mixed); };
}

}  // namespace cvtflow::tools
