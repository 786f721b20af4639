#include "tools/program/view/run_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "model/basis/portable_math.hpp"
#include "model/law/friction.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::tools {

namespace {

constexpr const char* sheave_names[] = {"1- (fixed)", "1+ (movable)", "2- (movable)", "2+ (fixed)"};

/// All rows of a channel, `width` numbers each.
struct ChannelRows {
    std::vector<double> values;
    std::size_t width;
};

ChannelRows rows_of(const RecordedRun& run, const std::string& name) {
    const engine::ChannelInfo* channel = run.channel(name);
    if (channel == nullptr)
        throw UsageError(fmt::format("{}: the record has no channel {}; record it with --set record.channels=wear/*", run.path(), name));
    return {run.values(name), static_cast<std::size_t>(channel->width)};
}

/// ∫ dt of every number.
std::vector<double> integrals(const RecordedRun& run, const ChannelRows& rows) {
    std::vector<double> sums(rows.width, 0.0);
    for (std::size_t k = 1; k < run.times().size(); ++k) {
        const double half = 0.5 * (run.times()[k] - run.times()[k - 1]);
        for (std::size_t n = 0; n < rows.width; ++n)
            sums[n] += half * (rows.values[k * rows.width + n] + rows.values[(k - 1) * rows.width + n]);
    }
    return sums;
}

/// How well the outputs sample the wear: their sum beside the energy that the run has accounted for in every step.
std::string sampled_text(const RecordedRun& run, double sampled) {
    const std::vector<double> so_far = run.values("dissipated/tip_friction");
    if (so_far.empty()) return "";
    return fmt::format("; {} outputs sum to {:.4g} J of the {:.4g} J that friction of tips dissipated", run.times().size(), sampled,
                       so_far.back() - so_far.front());
}

std::vector<double> largest(const ChannelRows& rows) {
    std::vector<double> most(rows.width, 0.0);
    for (std::size_t k = 0; k < rows.values.size(); ++k) most[k % rows.width] = std::max(most[k % rows.width], rows.values[k]);
    return most;
}

/// Rings of a sheave.
struct Rings {
    double from, width;  ///< [m]
    std::size_t count;
    [[nodiscard]] double middle(std::size_t ring) const { return from + (static_cast<double>(ring) + 0.5) * width; }
};

/// A curve per sheave over the radius; `values` are of the rings of all sheaves, one after the other.
template <class Scale>
Plot over_radius(const RecordedRun& run, const Rings& rings, const std::vector<double>& values, const std::string& title,
                 const std::string& label, const Scale& scale) {
    Plot plot{.title = title, .subtitle = run.conditions(), .x = {"radius [mm]"}, .y = {label}, .height = 300.0};
    for (std::size_t sheave = 0; sheave < 4; ++sheave) {
        Series series{fmt::format("sheave {}", sheave_names[sheave]), {}, Mark::small_dot, Line::solid, "", 1.6};
        for (std::size_t ring = 0; ring < rings.count; ++ring) {
            const double value = values[sheave * rings.count + ring];
            series.points.push_back({1e3 * rings.middle(ring), value > 0.0 ? value * scale(ring) : NAN});
        }
        plot.series.push_back(std::move(series));
    }
    std::size_t first = rings.count, end = 0;  // rings in use: few at one ratio
    for (std::size_t k = 0; k < values.size(); ++k)
        if (values[k] > 0.0) first = std::min(first, k % rings.count), end = std::max(end, k % rings.count + 1);
    if (first >= end) return plot;
    plot.x.from = 1e3 * (rings.from + (static_cast<double>(first) - 1.0) * rings.width);
    plot.x.to = 1e3 * (rings.from + (static_cast<double>(end) + 1.0) * rings.width);
    return plot;
}

/// How often the record fits into 1,000 hours of what it shows.
double per_thousand_hours(const RecordedRun& run) { return 3.6e6 / (run.times().back() - run.times().front()); }

/// Number of values by their size, as a staircase. values: one at least
Series histogram(const std::vector<double>& values) {
    constexpr std::size_t steps = 24;
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    const double from = *least, width = std::max(*most - from, 1e-6 * std::abs(*most)) / steps;
    std::vector<double> counts(steps, 0.0);
    for (const double value : values) counts[std::min(steps - 1, static_cast<std::size_t>((value - from) / width))] += 1.0;
    Series series{"", {{from, 0.0}}, Mark::none, Line::solid, "", 1.6};
    for (std::size_t k = 0; k < steps; ++k) {
        series.points.push_back({from + static_cast<double>(k) * width, counts[k]});
        series.points.push_back({from + static_cast<double>(k + 1) * width, counts[k]});
    }
    series.points.push_back({from + steps * width, 0.0});
    return series;
}

/// Worn volume over the area of the largest contact, π a², a = π R p/(2 E*).
Plot over_tips(const RecordedRun& run, const model::Parameters& p) {
    const std::vector<double> way = integrals(run, rows_of(run, "wear/tip_force_speed")),
                              pressure = largest(rows_of(run, "wear/tip_pressure"));
    const std::string title = "Worn depth of the tips in 1,000 hours";
    Plot plot{.title = title, .subtitle = run.conditions(), .x = {"depth [um]"}, .y = {"number of tips"}, .height = 300.0};
    const double scale = 1e6 * per_thousand_hours(run) * p.wear.coefficient;
    std::vector<double> depths;
    for (std::size_t tip = 0; tip < way.size(); ++tip) {
        const double a = 0.5 * std::numbers::pi * model::contact_radius(p) * pressure[tip] / model::contact_modulus(p);
        if (a > 0.0) depths.push_back(scale * way[tip] / (std::numbers::pi * a * a));
    }
    if (!depths.empty() && scale > 0.0) plot.series.push_back(histogram(depths));
    return plot;
}

}  // namespace

bool has_wear(const RecordedRun& run) {
    const auto names = {"wear/friction_power", "wear/force_speed", "wear/pressure_speed", "wear/tip_force_speed", "wear/tip_pressure"};
    return run.scene() && run.times().size() > 1 &&
           std::all_of(names.begin(), names.end(), [&](const char* name) { return run.channel(name) != nullptr; });
}

std::vector<Plot> wear_plots(const RecordedRun& run) {
    const ChannelRows power = rows_of(run, "wear/friction_power");
    const std::vector<double> energy = integrals(run, power), way = integrals(run, rows_of(run, "wear/force_speed")),
                              loads = largest(rows_of(run, "wear/pressure_speed"));
    if (!run.scene()) throw UsageError(run.path() + ": its scene cannot be read by this program");
    if (run.times().size() < 2) throw UsageError(run.path() + ": one output; wear needs two");
    const model::Parameters& p = run.scene()->parameters;
    const std::size_t count = power.width / 4;
    const Rings rings{p.pulley.innermost, (p.pulley.outermost - p.pulley.innermost) / static_cast<double>(count), count};
    const double cosine = model::portable_cos(p.tip.angle);
    const auto per_mm = [&](std::size_t) { return 1e-3 / rings.width; };
    const auto mega = [](std::size_t) { return 1e-6; };
    const auto micrometres = [&](std::size_t ring) {
        return 1e6 * per_thousand_hours(run) * p.wear.coefficient * cosine / (2.0 * std::numbers::pi * rings.middle(ring) * rings.width);
    };
    Plot by_energy = over_radius(run, rings, energy, "Friction energy of the tips by radius", "energy per radius [J/mm]", per_mm);
    by_energy.subtitle += sampled_text(run, std::accumulate(energy.begin(), energy.end(), 0.0));
    return {std::move(by_energy), over_radius(run, rings, loads, "Largest pressure times sliding speed", "p v [MPa m/s]", mega),
            over_radius(run, rings, way,
                        fmt::format("Worn depth of the sheaves in 1,000 hours, Archard's coefficient {:.3g} 1/Pa", p.wear.coefficient),
                        "depth [um]", micrometres),
            over_tips(run, p)};
}

}  // namespace cvtflow::tools
