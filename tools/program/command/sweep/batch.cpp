#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>

#include "tasks/batch/bench.hpp"
#include "tasks/batch/results/results.hpp"
#include "tasks/run/run_recorder.hpp"
#include "tasks/schedule/schedule.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/command/command.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/text/batch_text.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

constexpr long shown_cases = 20;

struct BatchArguments {
    std::string sweep, folder;
    std::optional<std::string> shard, grace, every;  ///< empty text is an error
    std::vector<std::string> retry;
    int threads = 0, bench = 0;
    bool dry = false, pin = false, quiet = false, keep_going = false, mixed = false;
};

tasks::Shard shard_of(const std::string& text) {
    const std::size_t slash = text.find('/');
    tasks::Shard shard;
    const auto number = [&](std::size_t first, std::size_t last, int& to) {
        const auto [end, error] = std::from_chars(text.data() + first, text.data() + last, to);
        return error == std::errc{} && end == text.data() + last;
    };
    if (slash != std::string::npos && number(0, slash, shard.number) && number(slash + 1, text.size(), shard.of) && shard.valid())
        return shard;
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
        if (tasks::violations(scene).empty()) records += tasks::record_bytes(scene, model::ChainModel(scene.parameters));
    }
    return text + fmt::format(", up to {} of records", size_text(records));
}

ExitStatus dry_run(const tasks::Sweep& sweep, const tasks::Shard& shard, int threads) {
    const std::vector<long> cases = tasks::shard_cases(sweep, shard);
    const tasks::BatchEstimate cost = tasks::estimate(sweep, shard, 0.6);
    fmt::print("{}: {}{}\n{}", sweep.name, plural(static_cast<long>(cases.size()), "case"),
               shard.of > 1 ? fmt::format(" of shard {}/{}", shard.number, shard.of) : "", cases_text(sweep, cases));
    std::vector<std::string> scalars;
    for (const tasks::Scalar& scalar : sweep.scalars) scalars.push_back(scalar.text);
    fmt::print("{}", field("scalars", fmt::format("{}", fmt::join(scalars, ", "))));
    if (cost.bad > 0) fmt::print("{}", field("invalid cases", plural(cost.bad, "case")));
    const std::string one = fmt::format("{} on one thread, {} on {}", duration_text(cost.total), duration_text(cost.total / threads),
                                        plural(threads, "thread"));
    const std::string none =
        cost.bad == cost.cases ? "none: every case has inconsistent parameters" : "none: no case could be measured: " + cost.untried;
    fmt::print(
        "{}", field("estimate",
                    cost.measured == 0 ? none : fmt::format("{} (measured on {}, settling included)", one, plural(cost.measured, "case"))));
    fmt::print("{}", field("disk", disk_text(sweep, cases)));
    if (cost.stable_step > 0.0 && std::isfinite(cost.stable_step))
        fmt::print("{}", field("stable to", fmt::format("{} at the start of the cases tried{}", time_text(cost.stable_step),
                                                        cost.beyond > 1.0 ? "; run.step exceeds this limit" : "")));
    return cost.measured == 0 ? ExitStatus::incomplete : ExitStatus::finished;
}

/// One line per number of threads: wall and CPU time, cases per second, parallel efficiency, overhead over the bare loop.
ExitStatus bench(const tasks::Sweep& sweep, const std::string& folder, int threads, int rounds) {
    std::vector<int> counts{1};
    if (threads > 1) counts.push_back(threads);
    const tasks::BatchBench result = tasks::bench_batch(sweep, folder, counts, rounds);
    Table table({{"", Align::left},
                 {"wall [s]", Align::right},
                 {"cpu [s]", Align::right},
                 {"cases/s", Align::right},
                 {"cpu over bare", Align::right},
                 {"efficiency", Align::right}});
    for (const tasks::BatchTiming& t : result.timings) {
        const tasks::BatchTiming &bare = result.timings[0], &one = result.timings[1];
        table.add({t.threads == 0 ? "bare step loop" : plural(t.threads, "thread"), fmt::format("{:.3f}", t.wall),
                   fmt::format("{:.3f}", t.cpu), fmt::format("{:.3g}", static_cast<double>(result.cases) / t.wall),
                   t.threads == 0 ? "" : fmt::format("{:+.2f} %", 100.0 * (t.cpu / bare.cpu - 1.0)),
                   t.threads < 2 ? "" : fmt::format("{:.3f}", one.wall / t.wall / t.threads)});
    }
    fmt::print("{}: {}, {} evaluations, medians of {}\n{}", sweep.name, plural(result.cases, "case"), count_text(result.evaluations),
               plural(rounds, "round"), table.text(2));
    fmt::print("{}{}", field("peak memory", size_text(result.peak_memory)), field("results hash", result.results_hash));
    return ExitStatus::finished;
}

ExitStatus batch(const BatchArguments& arguments) {
    const tasks::Sweep sweep = load_sweep(arguments.sweep);
    tasks::BatchOptions options;
    options.folder = arguments.folder.empty() ? "results/" + sweep.path.stem().string() : arguments.folder;
    options.threads = arguments.threads > 0 ? arguments.threads : tasks::usable_threads();
    options.pin = arguments.pin;
    if (arguments.shard) options.shard = shard_of(*arguments.shard);
    options.retry = arguments.retry;
    options.keep_going = arguments.keep_going;
    options.mixed = arguments.mixed;
    require_statuses("--retry", arguments.retry);
    if (arguments.grace) options.grace = seconds_of("--grace", *arguments.grace);
    if (arguments.every) options.checkpoint_every = seconds_of("--checkpoint-every", *arguments.every);
    if (arguments.bench > 0)
        return bench(sweep, arguments.folder.empty() ? "results/bench_batch" : options.folder, options.threads, arguments.bench);
    if (arguments.dry) return dry_run(sweep, options.shard, options.threads);
    if (arguments.folder.empty()) {
        std::error_code reported_later;
        std::filesystem::create_directories("results", reported_later);
    }
    return run_sweep(sweep, options, arguments.quiet);
}

constexpr std::size_t named_cases = 20, named_shards = 5;

std::string missing_text(const tasks::MergeReport& report) {
    std::string text;
    const auto shards = report.missing_shards.size();
    const std::vector<std::string> named(report.missing_shards.begin(),
                                         report.missing_shards.begin() + static_cast<std::ptrdiff_t>(std::min(named_shards, shards)));
    for (const std::string& shard : named) text += fmt::format("cvtflow: {}: this shard has no results\n", shard);
    if (shards > named_shards) text += fmt::format("cvtflow: … and {} more; {} shards have no results\n", shards - named_shards, shards);
    if (report.missing_cases.empty()) return text;
    const std::vector<long> first(
        report.missing_cases.begin(),
        report.missing_cases.begin() + static_cast<std::ptrdiff_t>(std::min(named_cases, report.missing_cases.size())));
    return text + fmt::format("cvtflow: {} of {} cases are missing: {}{}\n", report.missing_cases.size(), report.cases,
                              fmt::join(first, ", "), report.missing_cases.size() > named_cases ? ", …" : "");
}

ExitStatus merge(const std::string& folder, bool partial, bool mixed) {
    const tasks::MergeReport report = tasks::merge(folder, partial, mixed);
    const bool whole = report.missing_cases.empty() && report.missing_shards.empty();
    if (!whole) to_stderr(missing_text(report));
    if (!whole && !partial) {
        print_error("nothing was written; run the missing shards, or use --partial to join the available ones");
        return ExitStatus::incomplete;
    }
    fmt::print("{}: {} of {} cases\n{}{}", report.file, report.rows, report.cases, tally_text(report.tally),
               field("results hash", report.results_hash));
    const bool accurate = say_verdict(folder, report.file, false);
    return !whole ? ExitStatus::incomplete : accurate ? exit_status(report.tally) : ExitStatus::inaccurate;
}

}  // namespace

Action declare_batch(CLI::App& app) {
    const auto arguments = std::make_shared<BatchArguments>();
    app.add_option("SWEEP", arguments->sweep, "Sweep file (SWEEP.toml), or name of a ready sweep in scenes/sweeps")
        ->required()
        ->type_name("");
    app.add_option("-o,--output", arguments->folder,
                   "Folder for the results (default: results/SWEEP); an unfinished sweep there is continued")
        ->type_name("DIR");
    app.add_flag("--dry-run", arguments->dry, "Print the cases and the estimated time; run nothing");
    app.add_option("--bench", arguments->bench,
                   "Benchmark instead: ROUNDS rounds of the bare step loop, of one thread and of all threads, in DIR/bench")
        ->type_name("ROUNDS")
        ->check(CLI::Range(1, 10000))
        ->group("Laboratory");
    app.add_option("--threads", arguments->threads, "Number of cases that run in parallel (default: all processors of this process)")
        ->type_name("N")
        ->check(CLI::Range(1, 1024));
    app.add_flag("--pin", arguments->pin, "Pin every worker to a processor");
    app.add_option("--shard", arguments->shard, "Run part I of N only; cvtflow merge joins the parts")->type_name("I/N");
    app.add_option("--grace", arguments->grace,
                   "After SIGTERM, time for running cases to finish; the others write a checkpoint (default: 30 s)")
        ->type_name("TIME");
    app.add_option("--checkpoint-every", arguments->every, "Wall time between checkpoints of a running case (default: 60 s)")
        ->type_name("TIME");
    declare_repeated(app, "--retry", arguments->retry, "Repeat cases that ended with this status, e.g. budget; may be given several times",
                     "STATUS");
    app.add_flag("--keep-going", arguments->keep_going, keep_going_meaning);
    app.add_flag("--mixed", arguments->mixed, mixed_meaning);
    app.add_flag("-q,--quiet", arguments->quiet, "Print errors only");
    app.footer("Results do not depend on threads, shards or interruptions. cvtflow table DIR shows them.\n\n" +
               std::string(exit_status_help));
    return [arguments] { return batch(*arguments); };
}

Action declare_merge(CLI::App& app) {
    const auto folder = std::make_shared<std::string>();
    const auto partial = std::make_shared<bool>(false), mixed = std::make_shared<bool>(false);
    app.add_option("DIR", *folder, "Folder of all shards")->required()->type_name("");
    app.add_flag("--partial", *partial, "Join the available cases although others are missing");
    app.add_flag("--mixed", *mixed, mixed_meaning);
    app.footer("Missing shards and cases are listed.\n\n" + std::string(exit_status_help));
    return [folder, partial, mixed] { return merge(*folder, *partial, *mixed); };
}

}  // namespace cvtflow::tools
