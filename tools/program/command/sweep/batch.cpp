#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>

#include "tasks/batch/results/results.hpp"
#include "tasks/run/run_recorder.hpp"
#include "tasks/schedule/schedule.hpp"
#include "tools/program/arguments/scene_arguments.hpp"
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
    int threads = 0;
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
    if (arguments.dry) return dry_run(sweep, options.shard, options.threads);
    if (arguments.folder.empty()) {
        std::error_code reported_later;
        std::filesystem::create_directories("results", reported_later);
    }
    return run_sweep(sweep, options, arguments.quiet);
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
    app.add_option("--retry", arguments->retry, "Repeat cases that ended with this status, e.g. budget; may be given several times")
        ->type_name("STATUS")
        ->expected(1)
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    app.add_flag("--keep-going", arguments->keep_going, keep_going_meaning);
    app.add_flag("--mixed", arguments->mixed, mixed_meaning);
    app.add_flag("-q,--quiet", arguments->quiet, "Print errors only");
    app.footer("Results do not depend on threads, shards or interruptions. cvtflow table DIR shows them.\n\n" +
               std::string(exit_status_help));
    return [arguments] { return batch(*arguments); };
}

}  // namespace cvtflow::tools
