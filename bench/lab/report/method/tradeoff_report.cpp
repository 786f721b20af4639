#include "bench/lab/report/method/tradeoff_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/lab/text/watch_text.hpp"
#include "tools/program/plot/plot.hpp"
#include "tools/program/text/provenance_json.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

std::string short_error(double error) { return std::isfinite(error) ? fmt::format("{:.1e}", error) : "lost"; }
std::string number_or_empty(double value) { return std::isfinite(value) ? fmt::format("{:.3e}", value) : ""; }
std::string stable_text(double step) { return std::isfinite(step) ? time_text(step) : "any"; }

std::vector<tasks::TradeoffPoint> points_of(const std::vector<TradeoffEntry>& entries) {
    std::vector<tasks::TradeoffPoint> points;
    for (const TradeoffEntry& entry : entries) points.push_back(entry.point());
    return points;
}

/// Result of a long run; empty without one.
const Confirmed* long_run(const TradeoffEntry& entry) {
    return entry.confirmed && entry.confirmed->ran && !entry.confirmed->run.fault ? &*entry.confirmed : nullptr;
}

}  // namespace

double TradeoffEntry::median() const {
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
}

std::string TradeoffEntry::standing() const { return !objection.empty() ? objection : confirmed ? "confirmed" : ""; }

tasks::TradeoffPoint TradeoffEntry::point() const {
    return {choice, objection.empty() ? largest_force() : std::numeric_limits<double>::infinity(), median()};
}

std::string tradeoff_table(const std::vector<TradeoffEntry>& entries, const TradeoffSetting& setting) {
    const auto right = [](const char* heading) { return Table::Column{heading, Align::right}; };
    Table table({{"method"},
                 right("evaluations/s"),
                 right("axial force"),
                 right("tension"),
                 right("slip"),
                 right("losses"),
                 right("wall s/s"),
                 right("faster"),
                 {"front"},
                 right("stable to"),
                 right("slip off"),
                 right("losses off"),
                 right("residual"),
                 {"over " + time_text(setting.confirm)}});
    for (const TradeoffEntry& e : entries) {
        const Confirmed* far = long_run(e);
        const auto percent = [&](double share) { return far != nullptr ? fmt::format("{:.3f} %", 100.0 * share) : ""; };
        table.add({e.choice, fmt::format("{:.3g}", e.evaluations), short_error(e.errors.axial_force), short_error(e.errors.tension),
                   short_error(e.errors.slip), short_error(e.errors.losses), fmt::format("{:.4g}", e.median()),
                   fmt::format("{:.1f}", entries[0].median() / e.median()), e.front ? "*" : "", stable_text(e.stable_step),
                   percent(far != nullptr ? far->slip_error : 0.0), percent(far != nullptr ? far->loss_error : 0.0),
                   far != nullptr ? residual_cell(far->run.fault, far->run.watch) : "", e.standing()});
    }
    return table.text(2);
}

std::string tradeoff_recommendations(const std::vector<TradeoffEntry>& entries, const TradeoffSetting& setting) {
    const std::vector<tasks::TradeoffPoint> points = points_of(entries);
    std::string text = "\nFor an error in axial forces and link tensions of at most\n";
    for (const double error : recommended_errors) {
        const auto best = tasks::recommended(points, error, tasks::tradeoff_safety);
        text += best ? fmt::format("  {:.0e}  use {} ({:.4g} s per simulated second, {:.1e} here)\n", error, points[*best].choice,
                                   points[*best].seconds, points[*best].error)
                     : fmt::format("  {:.0e}  no choice is accurate enough\n", error);
    }
    text += fmt::format(
        "A target counts as met with a margin of {:g}, because scenes differ. Recommendations were confirmed over {}\nagainst {}.\n",
        tasks::tradeoff_safety, time_text(setting.confirm), setting.confirm_reference);
    const std::string brief = too_short(setting.confirm_watch);
    return brief.empty() ? text : text + fmt::format("Confirmed over too short a time: {}.\n", brief);
}

std::string tradeoff_csv(const std::vector<TradeoffEntry>& entries) {
    std::string text =
        "method,evaluations_per_second,error_axial_force,error_tension,error_slip,error_losses,wall_seconds_per_second,front,stable_step,"
        "standing,slip_off,losses_off,";
    text += watch_heading + std::string("\n");
    for (const TradeoffEntry& e : entries) {
        const Confirmed* far = long_run(e);
        const std::string watch = far != nullptr ? watch_csv(far->run.fault, far->run.watch) : ",,,,,,";
        text += fmt::format("{},{:.6g},{},{},{},{},{:.6g},{},{},{},{},{},{}\n", e.choice, e.evaluations,
                            number_or_empty(e.errors.axial_force), number_or_empty(e.errors.tension), number_or_empty(e.errors.slip),
                            number_or_empty(e.errors.losses), e.median(), e.front ? 1 : 0, number_or_empty(e.stable_step), e.standing(),
                            far != nullptr ? number_or_empty(far->slip_error) : "", far != nullptr ? number_or_empty(far->loss_error) : "",
                            watch);
    }
    return text;
}

std::string tradeoff_json(const std::vector<TradeoffEntry>& entries, const TradeoffSetting& setting) {
    using nlohmann::ordered_json;
    auto rows = ordered_json::array();
    for (const TradeoffEntry& e : entries) {
        ordered_json row{{"method", e.choice},
                         {"evaluations_per_second", e.evaluations},
                         {"error_axial_force", e.errors.axial_force},
                         {"error_tension", e.errors.tension},
                         {"error_slip", e.errors.slip},
                         {"error_losses", e.errors.losses},
                         {"wall_seconds_per_second", e.seconds},
                         {"front", e.front},
                         {"stable_step", e.stable_step},
                         {"standing", e.standing()},
                         {"short", watch_json(e.fault, e.watch)}};
        if (e.confirmed && e.confirmed->ran) {
            const Confirmed& far = *e.confirmed;
            row["long"] = {{"slip_off", far.slip_error},
                           {"losses_off", far.loss_error},
                           {"wall_seconds_per_second", far.run.wall},
                           {"watch", watch_json(far.run.fault, far.run.watch)}};
        }
        rows.push_back(row);
    }
    auto recommendations = ordered_json::array();
    for (const double error : recommended_errors) {
        const auto best = tasks::recommended(points_of(entries), error, tasks::tradeoff_safety);
        recommendations.push_back({{"error", error}, {"method", best ? ordered_json(entries[*best].choice) : ordered_json()}});
    }
    return json_text({{"scene", setting.scene},
                      {"provenance", provenance_json()},
                      {"reference", setting.reference},
                      {"duration", setting.duration},
                      {"interval", setting.interval},
                      {"confirm", setting.confirm},
                      {"confirm_reference", setting.confirm_reference},
                      {"confirm_watch", watch_json({}, setting.confirm_watch)},
                      {"choices", rows},
                      {"recommended", recommendations}});
}

std::string tradeoff_picture(const std::vector<TradeoffEntry>& entries, const TradeoffSetting& setting) {
    Plot plot;
    plot.title = "Speed and accuracy: " + setting.scene;
    plot.subtitle = fmt::format("against {} over {}, medians of {} alternating rounds; without unstable choices and those wrong over {}",
                                setting.reference, setting.duration, setting.rounds, time_text(setting.confirm));
    plot.x.label = "wall time per simulated second [s]";
    plot.y.label = "error, larger of axial forces and link tensions";
    plot.x.scale = plot.y.scale = Scale::logarithmic;
    std::vector<std::string> families;
    for (const TradeoffEntry& entry : entries) {
        const std::string family = entry.choice.substr(0, entry.choice.find('@'));
        if (families.empty() || families.back() != family) {
            families.push_back(family);
            plot.series.push_back({.name = family, .points = {}, .line = Line::solid, .colour = {}});
        }
        const tasks::TradeoffPoint point = entry.point();
        if (std::isfinite(point.error)) plot.series.back().points.push_back({point.seconds, point.error});
    }
    return svg(plot);
}

}  // namespace cvtflow::bench
