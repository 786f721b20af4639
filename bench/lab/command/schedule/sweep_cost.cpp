#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "bench/lab/command/command.hpp"
#include "bench/study/batch_bench.hpp"
#include "bench/study/profile/statistics.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/schedule/schedule.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

namespace {

using namespace tools;

struct BatchArguments {
    std::string sweep;
    int threads = 0, rounds = 5;
};

/// One line per number of threads: wall and CPU time, cases per second, parallel efficiency, overhead over the bare loop.
ExitStatus batch(const std::string& file, int threads, int rounds) {
    const tasks::Sweep sweep = load_sweep(file);
    if (threads == 0) threads = tasks::usable_threads();
    std::vector<int> counts{1};
    if (threads > 1) counts.push_back(threads);
    const BatchBench result = bench_batch(sweep, counts, rounds);
    Table table({{"", Align::left},
                 {"wall [s]", Align::right},
                 {"cpu [s]", Align::right},
                 {"cases/s", Align::right},
                 {"cpu over bare", Align::right},
                 {"efficiency", Align::right}});
    for (const BatchTiming& t : result.timings) {
        const BatchTiming &bare = result.timings[0], &one = result.timings[1];
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

struct RunArguments {
    SceneArguments scene;
    int rounds = 5;
};

/// Medians of processor times, and of the ratios of each round with their extremes.
ExitStatus run_cost(const RunArguments& arguments) {
    const LoadedScene loaded = load_scene(arguments.scene);
    tasks::Scene scene = loaded.scene;
    if (!loaded.notice.empty()) print_error(loaded.notice);
    tasks::set_values(scene, std::vector<std::string>{"run.schedule=serial"});
    const std::vector<RunCost> costs = bench_run(scene, arguments.rounds);
    Table table({{"", Align::left},
                 {"processor time [s]", Align::right},
                 {"over bare", Align::right},
                 {"least", Align::right},
                 {"most", Align::right}});
    const std::pair<const char*, double RunCost::*> rows[] = {{"without watch", &RunCost::unwatched},
                                                              {"bare steps", &RunCost::bare},
                                                              {"observed", &RunCost::observed},
                                                              {"recorded", &RunCost::recorded}};
    for (const auto& [name, member] : rows) {
        std::vector<double> times, shares;
        for (const RunCost& cost : costs) {
            times.push_back(cost.*member);
            shares.push_back(100.0 * (cost.*member / cost.bare - 1.0));
        }
        const bool bare = member == &RunCost::bare;
        const auto percent = [bare](double share) { return bare ? std::string() : fmt::format("{:+.1f} %", share); };
        table.add({name, fmt::format("{:.3f}", median(times)), percent(median(shares)), percent(*std::ranges::min_element(shares)),
                   percent(*std::ranges::max_element(shares))});
    }
    fmt::print("{}: outputs every {:.3g} us, medians of {}\n{}", scene.name, 1e6 * scene.run.output_interval,
               plural(arguments.rounds, "round"), table.text(2));
    return ExitStatus::finished;
}

}  // namespace

Action declare_run_cost(CLI::App& app) {
    const auto arguments = std::make_shared<RunArguments>();
    declare_scene(app, arguments->scene);
    declare_fresh_start(app, arguments->scene);
    declare_shortcut(app, arguments->scene, "--until", "run.until", "TIME");
    app.add_option("--rounds", arguments->rounds, "Rounds of the four runs by turns (default: 5)")
        ->type_name("ROUNDS")
        ->check(CLI::Range(1, 10000));
    app.footer(
        "without watch: bare steps whose energies are not watched; observed: outputs and the summary without a record; recorded: with one. "
        "On one\n"
        "thread.");
    return [arguments] { return run_cost(*arguments); };
}

Action declare_sweep_cost(CLI::App& app) {
    const auto arguments = std::make_shared<BatchArguments>();
    app.add_option("SWEEP", arguments->sweep, "Sweep file (SWEEP.toml), or name of a ready sweep in scenes/sweeps")
        ->required()
        ->type_name("");
    app.add_option("--rounds", arguments->rounds, "Rounds of the bare step loop, of one thread and of all threads (default: 5)")
        ->type_name("ROUNDS")
        ->check(CLI::Range(1, 10000));
    app.add_option("--threads", arguments->threads, "Number of cases that run in parallel (default: all processors of this process)")
        ->type_name("N")
        ->check(CLI::Range(1, 1024));
    app.footer("cpu over bare: what a sweep costs beside its steps.");
    return [arguments] { return batch(arguments->sweep, arguments->threads, arguments->rounds); };
}

}  // namespace cvtflow::bench
