/// cvtflow-lab noise: sequences of pitches with their spectra, as text, CSV, JSON and picture.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/lab/command/command.hpp"
#include "bench/lab/plot/plot.hpp"
#include "bench/study/noise/noise.hpp"
#include "engine/executor/tbb/job_pool.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/report_columns.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

struct NoiseRow {
    std::string name;            ///< "uniform", "random 3", "searched 12"
    bool random = false;         ///< shuffled, not searched
    PitchSequence sequence;      ///< [links]
    double expected = 0.0;       ///< tonality by the closed form [dB]
    NoiseSpectrum rigid, check;  ///< spectra at the level `rigid` and at the level of the check
};

struct NoiseResult {
    std::string scene, level;  ///< scene, and level of detail of the check
    double mean = 0.0;         ///< mean pitch [m]
    double spread = 0.0;       ///< [1]
    std::uint64_t seed = 0;
    std::vector<NoiseRow> rows;  ///< uniform, random ones, searched ones
    std::size_t best = 0;        ///< row with the least tonality in the check
    double wall = 0.0;           ///< [s]

    [[nodiscard]] int pins() const { return static_cast<int>(rows.front().sequence.size()); }
};

constexpr std::array columns{"force_tonality_dB",  "force_pins_dB",  "force_line_dB",
                             "torque_tonality_dB", "torque_pins_dB", "torque_line_dB"};
using Figures = std::array<double, columns.size()>;

/// Tonality, pin passing, and strongest line from half to 1.5 times of it, of both signals; lines against the uniform chain's pin passing.
Figures figures_of(const NoiseSpectrum& now, const NoiseSpectrum& uniform, int pins) {
    Figures figures{};
    for (const bool force : {true, false}) {
        const OrderPowers& powers = force ? now.force : now.torque;
        const double reference = (force ? uniform.force : uniform.torque)[static_cast<std::size_t>(pins)];
        const double line = *std::max_element(powers.begin() + pins / 2, powers.begin() + 3 * pins / 2);
        double* to = figures.data() + (force ? 0 : 3);
        to[0] = force ? now.force_tone : now.torque_tone;
        to[1] = 10.0 * std::log10(powers[static_cast<std::size_t>(pins)] / reference);
        to[2] = 10.0 * std::log10(line / reference);
    }
    return figures;
}

/// Calls for every simulation: row, name of its level, spectrum, spectrum of the uniform chain.
template <class Function>
void each_simulation(const NoiseResult& result, const Function& call) {
    const NoiseRow& uniform = result.rows.front();
    for (const NoiseRow& row : result.rows) {
        if (row.rigid.simulated()) call(row, std::string("rigid"), row.rigid, uniform.rigid);
        if (row.check.simulated()) call(row, result.level, row.check, uniform.check);
    }
}

/// Mean figures of the random sequences, lines as mean powers.
Figures mean_of_random(const NoiseResult& result) {
    Figures sum{};
    int count = 0;
    each_simulation(result, [&](const NoiseRow& row, const std::string&, const NoiseSpectrum& now, const NoiseSpectrum& uniform) {
        if (&now != &row.rigid || !row.random || !now.fault.empty()) return;
        const Figures figures = figures_of(now, uniform, result.pins());
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += k % 3 == 0 ? figures[k] : std::pow(10.0, 0.1 * figures[k]);
        ++count;
    });
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] = k % 3 == 0 ? sum[k] / count : 10.0 * std::log10(sum[k] / count);
    return sum;
}

std::vector<std::string> cells_of(std::string name, std::string level, const Figures& figures) {
    std::vector<std::string> cells{std::move(name), std::move(level)};
    for (const double figure : figures) cells.push_back(fmt::format("{:.1f}", figure + 0.0));
    return cells;
}

/// Agreement of two tonalities on the order of sequences: the closed form's and that at `rigid`, or that at `rigid` and that of the check.
double agreement(const NoiseResult& result, bool random, bool check) {
    std::vector<double> before, after;
    for (const NoiseRow& row : result.rows) {
        if (&row == &result.rows.front() || !row.rigid.usable() || (check ? !row.check.usable() : row.random != random)) continue;
        before.push_back(check ? row.rigid.tone() : row.expected);
        after.push_back(check ? row.check.tone() : row.rigid.tone());
    }
    return rank_correlation(before, after);
}

/// "[0.0074704,0.0087696,…]", as chain.pitch takes it [m].
std::string pitch_text(const NoiseRow& row, const NoiseResult& result) {
    return fmt::format("[{:.7g}]", fmt::join(pitches_of(row.sequence, result.mean, result.spread), ","));
}

std::string noise_text(const NoiseResult& result) {
    using enum Align;
    Table table(
        {{"sequence"}, {"level"}, {"force", right}, {"pins", right}, {"line", right}, {"torque", right}, {"pins", right}, {"line", right}});
    const NoiseSpectrum &rigid = result.rows.front().rigid, &check = result.rows.front().check;
    each_simulation(result, [&](const NoiseRow& row, const std::string& level, const NoiseSpectrum& now, const NoiseSpectrum& uniform) {
        if (!row.check.simulated()) return;
        table.add(now.usable() ? cells_of(row.name, level, figures_of(now, uniform, result.pins()))
                               : std::vector<std::string>{row.name, level, now.fault, "", "", "", "", ""});
        if (&now == &check) table.add(cells_of("mean of random", "rigid", mean_of_random(result)));
    });
    return fmt::format("{}: {} pins, mean pitch {:.4g} mm, spread {:g} %, pins pass at {:.0f} Hz\n\n{}\n", result.scene, result.pins(),
                       1e3 * result.mean, 100.0 * result.spread, rigid.round * result.pins(), table.text(2)) +
           "  force, torque: tonality [dB]; pins: line of the passing pins; line: strongest line from half to 1.5 times of it,\n"
           "  both against the uniform chain's passing pins [dB]\n" +
           field("ranks", fmt::format("closed form and rigid {:.2f} (random), {:.2f} (searched); rigid and {} {:.2f}",
                                      agreement(result, true, false), agreement(result, false, false), result.level,
                                      agreement(result, false, true))) +
           field("best", result.rows[result.best].name) +
           field("time", fmt::format("{:.1f} s; a simulation {:.2f} s at rigid, {:.2f} s at {}", result.wall, rigid.wall, check.wall,
                                     result.level));
}

std::string noise_csv(const NoiseResult& result) {
    std::string text = fmt::format("sequence,level,status,expected_dB,{},steps\n", fmt::join(columns, ","));
    each_simulation(result, [&](const NoiseRow& row, const std::string& level, const NoiseSpectrum& now, const NoiseSpectrum& uniform) {
        const std::string figures =
            now.usable() ? fmt::format("{:.4f}", fmt::join(figures_of(now, uniform, result.pins()), ",")) : std::string(",,,,,");
        text += fmt::format("{},{},{},{:.4f},{},{}\n", row.name, level, now.usable() ? "ok" : "failed", row.expected, figures,
                            fmt::join(row.sequence, " "));
    });
    return text;
}

nlohmann::ordered_json noise_json(const NoiseResult& result) {
    nlohmann::ordered_json json{{"provenance", provenance_json()}, {"scene", result.scene},   {"level", result.level},
                                {"mean_pitch_m", result.mean},     {"spread", result.spread}, {"seed", result.seed},
                                {"wall_s", result.wall},           {"best", result.best}};
    each_simulation(result, [&](const NoiseRow& row, const std::string& level, const NoiseSpectrum& now, const NoiseSpectrum& uniform) {
        nlohmann::ordered_json each{{"name", row.name}, {"level", level}, {"steps", row.sequence}, {"expected_dB", row.expected}};
        if (!now.usable()) each["fault"] = now.fault;
        for (std::size_t k = 0; now.usable() && k < columns.size(); ++k) each[columns[k]] = figures_of(now, uniform, result.pins())[k];
        json["simulations"].push_back(std::move(each));
    });
    return json;
}

/// Spectra of the uniform chain and of the best one, as checked.
std::vector<Plot> noise_plots(const NoiseResult& result) {
    std::vector<Plot> plots;
    for (const bool force : {true, false}) {
        Plot plot;
        plot.title = force ? "Radial forces on the bearings" : "Torque of the chain on the shafts";
        plot.subtitle = fmt::format("{} at {}; pins pass at {:.0f} Hz; {} sequences simulated in {:.0f} s", result.scene, result.level,
                                    result.rows.front().rigid.round * result.pins(), result.rows.size() - 1, result.wall);
        plot.x = {"order of the pin passing", Scale::linear, 1.0, 0.0, static_cast<double>(noise_harmonics)};
        plot.y = {force ? "amplitude [N]" : "amplitude [N m]", Scale::logarithmic, 1.0, {}, {}};
        plot.height = 380.0;
        for (const std::size_t row : {std::size_t{0}, result.best}) {
            const NoiseSpectrum& now = result.rows[row].check;
            const std::string name = fmt::format("{}: tonality {:.0f} dB", result.rows[row].name, force ? now.force_tone : now.torque_tone);
            plot.series.push_back({name, {}, Mark::none, Line::solid, "", 1.2});
            const OrderPowers& powers = force ? now.force : now.torque;
            for (std::size_t n = 1; n < powers.size(); ++n)
                plot.series.back().points.push_back({static_cast<double>(n) / result.pins(), std::sqrt(2.0 * powers[n])});
        }
        plots.push_back(std::move(plot));
    }
    return plots;
}

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
    std::string level;  ///< level of detail of the check
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

/// Scene with the sequence's pitches. @throws UsageError if they do not fit the machine
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
