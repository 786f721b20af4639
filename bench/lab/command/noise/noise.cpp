#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include "bench/lab/command/command.hpp"
#include "bench/lab/command/noise/noise_report.hpp"
#include "engine/executor/tbb/job_pool.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/report_columns.hpp"
#include "tools/program/view/run_plots.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

struct NoiseArguments {
    SceneArguments scene;
    OutputArguments output;
    int lengths = 2, random = 20, candidates = 40, checked = 10, moves = 2000, rounds = 1, threads = 1;
    double spread = 0.08;
    std::uint64_t seed = 1;
};

/// The scenes of the search and of the check.
struct NoiseScenes {
    tasks::Scene rigid, check;
    std::string level;  ///< of the check
};

NoiseScenes scenes_of(const NoiseArguments& arguments) {
    SceneArguments check = arguments.scene, rigid = arguments.scene;
    if (check.detail.empty()) check.detail = "fine";
    rigid.detail = "rigid";
    for (SceneArguments* each : {&check, &rigid}) each->settings.insert(each->settings.begin(), {"run.method=auto", "run.step=auto"});
    NoiseScenes scenes{load_scene(rigid).scene, load_scene(check).scene, check.detail};
    if (scenes.check.parameters.detail.pulleys == model::PulleyDetail::absent)
        throw UsageError(scenes.check.name + " has no pulleys: nothing passes a bearing");
    return scenes;
}

/// With the sequence's pitches. @throws UsageError if they do not fit the machine
tasks::Scene with_sequence(const tasks::Scene& scene, const NoiseRow& row, const NoiseResult& result) {
    tasks::Scene machine = scene;
    machine.state_file.clear();
    machine.start_state = {};
    try {
        tasks::set_value(machine, "chain.pitch=" + pitch_text(row, result));
    } catch (const tasks::SceneError& error) {
        throw UsageError(error.what());
    }
    return machine;
}

/// Simulates rows at `rigid`, or at the level of the check.
void simulate(NoiseResult& result, const std::vector<std::size_t>& rows, const tasks::Scene& scene, NoiseSpectrum NoiseRow::*level,
              const NoiseArguments& arguments) {
    std::size_t next = 0;
    const engine::Cancellation& cancel = catch_interrupts();
    engine::run_jobs(
        arguments.threads, false,
        [&](int) { return next < rows.size() && !cancel.requested() ? std::optional(static_cast<long>(next++)) : std::nullopt; },
        [&](int, long job) {
            NoiseRow& row = result.rows[rows[static_cast<std::size_t>(job)]];
            row.*level = measure_noise(with_sequence(scene, row, result), arguments.rounds, cancel);
        });
}

/// Appends sequences and simulates them at `rigid`. @param make a sequence, by chance
template <class Make>
void add_rows(NoiseResult& result, int count, bool random, const tasks::Scene& scene, const NoiseArguments& arguments, const Make& make) {
    std::vector<std::size_t> rows;
    for (int k = 1; k <= count; ++k) {
        rows.push_back(result.rows.size());
        std::mt19937_64 urn(arguments.seed * 1000003u + rows.back());
        result.rows.push_back({fmt::format("{} {}", random ? "random" : "searched", k), random, make(urn), 0.0, {}, {}});
    }
    simulate(result, rows, scene, &NoiseRow::rigid, arguments);
}

/// Weights the closed form by the random sequences that were simulated.
void weigh(PitchSearch& search, const NoiseResult& result) {
    for (const auto signal : {&NoiseSpectrum::force, &NoiseSpectrum::torque}) {
        std::vector<PitchSequence> sequences;
        std::vector<OrderPowers> powers;
        for (const NoiseRow& row : result.rows) {
            if (!row.random || !row.rigid.usable()) continue;
            sequences.push_back(row.sequence);
            powers.push_back(row.rigid.*signal);
        }
        if (sequences.empty()) throw tasks::SceneError("no random sequence runs: " + result.rows.back().rigid.fault);
        search.weigh(sequences, powers);
    }
}

/// The uniform chain, random sequences and searched ones, simulated at `rigid`.
void make_rows(NoiseResult& result, const tasks::Scene& scene, const NoiseArguments& arguments) {
    const int pins = scene.parameters.chain.pins;
    result.rows.push_back({"uniform", false, PitchSequence(static_cast<std::size_t>(pins), 0), 0.0, {}, {}});
    simulate(result, {0}, scene, &NoiseRow::rigid, arguments);
    const NoiseSpectrum& uniform = result.rows.front().rigid;
    if (!uniform.usable()) throw tasks::SceneError("the uniform chain: " + uniform.fault);
    PitchSearch search(pins, arguments.lengths, arguments.spread, uniform.round);
    add_rows(result, arguments.random, true, scene, arguments, [&](std::mt19937_64& urn) { return search.random(urn); });
    weigh(search, result);
    add_rows(result, arguments.candidates, false, scene, arguments,
             [&](std::mt19937_64& urn) { return search.climb(urn, arguments.moves); });
    for (NoiseRow& row : result.rows) row.expected = search.expected(row.sequence);
}

/// Mixed rows that have spectra of a level, the least tonal first.
std::vector<std::size_t> ranked(const NoiseResult& result, const NoiseSpectrum NoiseRow::*level) {
    std::vector<std::size_t> order;
    for (std::size_t row = 1; row < result.rows.size(); ++row)
        if ((result.rows[row].*level).usable()) order.push_back(row);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return (result.rows[a].*level).tone() < (result.rows[b].*level).tone(); });
    return order;
}

void check_best(NoiseResult& result, const tasks::Scene& scene, const NoiseArguments& arguments) {
    std::vector<std::size_t> rows = ranked(result, &NoiseRow::rigid);
    rows.resize(std::min(rows.size(), static_cast<std::size_t>(arguments.checked)));
    rows.insert(rows.end(), {0, 1});  // and a random one, beside which the others are seen
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    simulate(result, rows, scene, &NoiseRow::check, arguments);
    const NoiseSpectrum& uniform = result.rows.front().check;
    const std::vector<std::size_t> best = ranked(result, &NoiseRow::check);
    if (best.empty() || !uniform.usable()) throw tasks::SceneError(fmt::format("no spectrum at {}: {}", result.level, uniform.fault));
    result.best = best.front();
}

ExitStatus noise(const NoiseArguments& arguments) {
    const auto started = std::chrono::steady_clock::now();
    const NoiseScenes scenes = scenes_of(arguments);
    NoiseResult result;
    result.scene = scenes.check.name, result.level = scenes.level, result.spread = arguments.spread, result.seed = arguments.seed;
    result.mean = model::chain_length(scenes.rigid.parameters.chain) / scenes.rigid.parameters.chain.pins;
    try {
        make_rows(result, scenes.rigid, arguments);
        check_best(result, scenes.check, arguments);
    } catch (const tasks::SceneError&) {  // what is missing may be missing because of the interrupt
        if (!catch_interrupts().requested()) throw;
    }
    if (catch_interrupts().requested()) return ExitStatus::cancelled;
    result.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    const NoiseRow& best = result.rows[result.best];
    OutputFolder folder(arguments.output);
    folder.write("sequences.csv", noise_csv(result));
    folder.write("spectrum.csv", csv(noise_plots(result)));
    folder.write("noise.json", json_text(noise_json(result)));
    folder.write("noise.svg", svg(noise_plots(result)));
    folder.write("quiet.toml", tasks::write_scene(with_sequence(scenes.check, best, result)));
    fmt::print("{}{}\n--set chain.pitch={}\n", noise_text(result), folder.written(), pitch_text(best, result));
    return ExitStatus::finished;
}

}  // namespace

Action declare_noise(CLI::App& app) {
    const auto arguments = std::make_shared<NoiseArguments>();
    declare_scene(app, arguments->scene);
    const auto number = [&](const char* name, int& value, int from, int to, const char* meaning) {
        app.add_option(name, value, fmt::format("{} (default: {})", meaning, value))->check(CLI::Range(from, to))->type_name("N");
    };
    number("--lengths", arguments->lengths, 2, 3, "Number of different pitches");
    app.add_option("--spread", arguments->spread, "Difference of the pitches from their mean, as a share of it (default: 0.08)")
        ->check(CLI::Range(1e-3, 0.3))
        ->type_name("SHARE");
    number("--random", arguments->random, 1, 10000, "Random sequences to simulate for comparison");
    number("--candidates", arguments->candidates, 1, 10000, "Searched sequences to simulate");
    number("--moves", arguments->moves, 0, 1000000, "Exchanges of links that the search tries per sequence");
    number("--checked", arguments->checked, 1, 1000, "Best sequences to check at the level of --detail, which is fine without it");
    number("--rounds", arguments->rounds, 1, 100, "Revolutions of the chain that a spectrum is taken over");
    number("--threads", arguments->threads, 1, 1024, "Simulations in parallel");
    app.add_option("--seed", arguments->seed, "Seed of the search (default: 1)")->type_name("N");
    declare_output(app, arguments->output);
    app.footer(
        "Sequences have the length of the scene's chain, half of its links shorter and half longer (three lengths: a third each). A climb "
        "by\n"
        "exchanges lowers the tonality that a closed form expects; `rigid` simulates the results, the level of --detail checks the best.\n"
        "Every simulation settles from a geometric start. Load, speed and clamping should not change with time. docs/noise.md\n"
        "Files: sequences.csv, spectrum.csv, noise.json, noise.svg, quiet.toml (a scene with the best sequence).");
    return [arguments] { return noise(*arguments); };
}

}  // namespace cvtflow::bench
