#include "bench/lab/command/noise/noise_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/program/text/report_columns.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

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

/// How two tonalities rank sequences: the closed form's and that at `rigid`, or that at `rigid` and that of the check.
double agreement(const NoiseResult& result, bool random, bool check) {
    std::vector<double> before, after;
    for (const NoiseRow& row : result.rows) {
        if (&row == &result.rows.front() || !row.rigid.usable() || (check ? !row.check.usable() : row.random != random)) continue;
        before.push_back(check ? row.rigid.tone() : row.expected);
        after.push_back(check ? row.check.tone() : row.rigid.tone());
    }
    return rank_correlation(before, after);
}

}  // namespace

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

}  // namespace cvtflow::bench
