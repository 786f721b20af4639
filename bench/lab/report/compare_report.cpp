#include "bench/lab/report/compare_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "bench/lab/text/watch_text.hpp"
#include "bench/study/tradeoff/recommendation.hpp"
#include "tools/program/text/report_columns.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using ChoiceColumn = ReportColumn<ComparedChoice>;
using ChoiceColumns = std::vector<ChoiceColumn>;
using nlohmann::ordered_json;

std::string error_cell(double error) { return std::isnan(error) ? "-" : std::isfinite(error) ? fmt::format("{:.1e}", error) : "lost"; }

/// A column of errors. @param of a function of a choice
template <class Of>
ChoiceColumn error_column(const std::string& key, const std::string& heading, Of of) {
    return {key, heading, [of](const ComparedChoice& c) { return of(c); }, [of](const ComparedChoice& c) { return error_cell(of(c)); }};
}

void add_costs(ChoiceColumns& columns, const ComparedChoice& first) {
    const auto fewer = [evaluations = first.run.evaluations_per_second()](const ComparedChoice& c) {
        return evaluations / c.run.evaluations_per_second();
    };
    const auto faster = [seconds = first.median()](const ComparedChoice& c) { return seconds / c.median(); };
    columns.insert(columns.end(),
                   {{"method", "method", [](const ComparedChoice& c) { return c.choice; }, [](const ComparedChoice& c) { return c.choice; },
                     Align::left},
                    {"mean_step", "mean step", [](const ComparedChoice& c) { return c.mean_step(); },
                     [](const ComparedChoice& c) { return time_text(c.mean_step()); }},
                    {"steps", "", [](const ComparedChoice& c) { return c.run.counters.steps; }},
                    {"evaluations", "evaluations", [](const ComparedChoice& c) { return c.run.counters.evaluations; },
                     [](const ComparedChoice& c) { return count_text(c.run.counters.evaluations); }},
                    {"transitions", "", [](const ComparedChoice& c) { return c.run.counters.detected; }},
                    {"evaluations_per_second", "per second", [](const ComparedChoice& c) { return c.run.evaluations_per_second(); },
                     [](const ComparedChoice& c) { return fmt::format("{:.3g}", c.run.evaluations_per_second()); }},
                    {"wall_seconds_per_second", "wall s/s", [](const ComparedChoice& c) { return c.median(); },
                     [](const ComparedChoice& c) { return fmt::format("{:.4g}", c.median()); }},
                    {"fewer_by", "fewer", fewer, [fewer](const ComparedChoice& c) { return fmt::format("{:.2f}", fewer(c)); }},
                    {"faster_by", "faster", faster, [faster](const ComparedChoice& c) { return fmt::format("{:.2f}", faster(c)); }}});
}

void add_errors(ChoiceColumns& columns, bool pin) {
    columns.push_back(error_column("error_axial_force", "axial force", [](const ComparedChoice& c) { return c.errors.axial_force; }));
    columns.push_back(error_column("error_tension", "tension", [](const ComparedChoice& c) { return c.errors.tension; }));
    columns.push_back(error_column("error_slip", "slip", [](const ComparedChoice& c) { return c.errors.slip; }));
    columns.push_back(error_column("error_losses", "losses", [](const ComparedChoice& c) { return c.errors.losses; }));
    if (pin) columns.push_back(error_column("error_pin", "pin", [](const ComparedChoice& c) { return c.pin_error; }));
}

/// A figure of Newton's method; nothing for other methods.
template <class Of>
ChoiceColumn newton_column(const std::string& key, const std::string& heading, Of of) {
    return {key, heading, [of](const ComparedChoice& c) { return c.run.newton ? ordered_json(of(*c.run.newton)) : ordered_json(); },
            [of](const ComparedChoice& c) { return c.run.newton ? fmt::format("{:.3g}", static_cast<double>(of(*c.run.newton))) : ""; }};
}

void add_newton(ChoiceColumns& columns) {
    using Newton = bench::NewtonStatistics;
    const auto per_step = [](long Newton::*count) {
        return [count](const Newton& n) { return static_cast<double>(n.*count) / static_cast<double>(std::max(1L, n.steps)); };
    };
    columns.push_back(newton_column("newton_iterations", "iterations", per_step(&Newton::iterations)));
    columns.push_back(newton_column("newton_most", "most", [](const Newton& n) { return n.most; }));
    columns.push_back(newton_column("newton_jacobians", "Jacobians", per_step(&Newton::jacobians)));
    columns.push_back(newton_column("newton_halvings", "halvings", per_step(&Newton::backtracks)));
    columns.push_back(newton_column("newton_fell_back", "fell back", [](const Newton& n) { return n.refreshed; }));
    columns.push_back(newton_column("newton_unconverged", "unconverged", [](const Newton& n) { return n.unconverged; }));
}

/// ChoiceColumns of watch_json(), from a run or from the confirmation. @param prefix of their keys
template <class Of>
void add_watch(ChoiceColumns& columns, const std::string& prefix, Of of) {
    for (const char* key : {"status", "residual", "suspicion", "pin_periods", "long_enough", "mean_slip", "efficiency"})
        columns.push_back({prefix + key, "", [of, key](const ComparedChoice& c) {
                               const ordered_json watch = of(c);
                               return watch.contains(key) ? watch[key] : ordered_json();
                           }});
}

/// Result of a long run; nullptr without one.
const Confirmed* long_run(const ComparedChoice& c) {
    return c.front_result.confirmed && c.front_result.confirmed->ran && !c.front_result.confirmed->run.fault ? &*c.front_result.confirmed
                                                                                                             : nullptr;
}

void add_front(ChoiceColumns& columns, double confirm) {
    const auto far = [](const char* key, const char* heading, double Confirmed::*error) {
        return ChoiceColumn{
            key, heading,
            [error](const ComparedChoice& c) { return long_run(c) != nullptr ? ordered_json(long_run(c)->*error) : ordered_json(); },
            [error](const ComparedChoice& c) {
                return long_run(c) != nullptr ? fmt::format("{:.3f} %", 100.0 * (long_run(c)->*error)) : "";
            }};
    };
    const auto outcome = [](const ComparedChoice& c) { return c.front_result.outcome(); };
    columns.push_back({"front", "front", [](const ComparedChoice& c) { return c.front_result.front; },
                       [](const ComparedChoice& c) { return c.front_result.front ? "*" : ""; }, Align::left});
    columns.push_back({"stable_step", "stable to", [](const ComparedChoice& c) { return c.front_result.stable_step; },
                       [](const ComparedChoice& c) {
                           return std::isfinite(c.front_result.stable_step) ? time_text(c.front_result.stable_step) : "any";
                       }});
    columns.push_back(far("long_slip_off", "slip off", &Confirmed::slip_error));
    columns.push_back(far("long_losses_off", "losses off", &Confirmed::loss_error));
    add_watch(columns, "long_", [](const ComparedChoice& c) {
        return long_run(c) != nullptr ? watch_json(long_run(c)->run.fault, long_run(c)->run.watch) : ordered_json::object();
    });
    columns.push_back({"standing", "over " + time_text(confirm), outcome, outcome, Align::left});
}

ChoiceColumns columns_of(const ComparedChoice& first, const CompareSetting& setting) {
    ChoiceColumns columns;
    add_costs(columns, first);
    add_errors(columns, setting.pin.has_value());
    if (setting.newton) add_newton(columns);
    const auto watch = [](const ComparedChoice& c) { return watch_json(c.run.fault, c.run.watch); };
    columns.push_back({"", "residual", {}, [](const ComparedChoice& c) { return residual_cell(c.run.fault, c.run.watch); }});
    columns.push_back({"", "status", {}, [](const ComparedChoice& c) { return c.run.watch.status(c.run.fault); }, Align::left});
    add_watch(columns, "", watch);
    if (setting.front) add_front(columns, setting.confirm);
    return columns;
}

std::vector<tasks::TradeoffPoint> points_of(const std::vector<ComparedChoice>& choices) {
    std::vector<tasks::TradeoffPoint> points;
    for (const ComparedChoice& choice : choices) points.push_back(choice.point());
    return points;
}

}  // namespace

double ComparedChoice::median() const {
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
}

tasks::TradeoffPoint ComparedChoice::point() const {
    const double force = std::max(errors.axial_force, errors.tension);
    return {choice, front_result.objection.empty() ? force : std::numeric_limits<double>::infinity(), median()};
}

std::string compare_table(const std::vector<ComparedChoice>& choices, const CompareSetting& setting) {
    return report_table(columns_of(choices.front(), setting), choices);
}

std::string compare_csv(const std::vector<ComparedChoice>& choices, const CompareSetting& setting) {
    return report_csv(columns_of(choices.front(), setting), choices);
}

std::string compare_json(const std::vector<ComparedChoice>& choices, const CompareSetting& setting) {
    ordered_json json{{"scene", setting.scene},         {"provenance", provenance_json()},
                      {"reference", setting.reference}, {"reference_watch", watch_json({}, setting.reference_watch)},
                      {"duration", setting.duration},   {"interval", setting.interval},
                      {"rounds", setting.rounds}};
    if (setting.pin) json.update(ordered_json{{"pin", setting.pin->pin}, {"entry", setting.pin->time}});
    json["choices"] = report_json(columns_of(choices.front(), setting), choices);
    if (!setting.front) return json_text(json);
    json.update(ordered_json{{"confirm", setting.confirm},
                             {"confirm_reference", setting.confirm_reference},
                             {"confirm_watch", watch_json({}, setting.confirm_watch)}});
    for (const double error : recommended_errors) {
        const auto best = recommended(points_of(choices), error, tradeoff_safety);
        json["recommended"].push_back({{"error", error}, {"method", best ? ordered_json(choices[*best].choice) : ordered_json()}});
    }
    return json_text(json);
}

std::string recommendations(const std::vector<ComparedChoice>& choices, const CompareSetting& setting) {
    const std::vector<tasks::TradeoffPoint> points = points_of(choices);
    std::string text = "\nFor an error in axial forces and link tensions of at most\n";
    for (const double error : recommended_errors) {
        const auto best = recommended(points, error, tradeoff_safety);
        text += best ? fmt::format("  {:.0e}  use {} ({:.4g} s per simulated second, {:.1e} here)\n", error, points[*best].choice,
                                   points[*best].seconds, points[*best].error)
                     : fmt::format("  {:.0e}  no choice is accurate enough\n", error);
    }
    text += fmt::format(
        "A target counts as met with a margin of {:g}, because scenes differ. Recommendations were confirmed over {}\nagainst {}.\n",
        tradeoff_safety, time_text(setting.confirm), setting.confirm_reference);
    const std::string brief = too_short(setting.confirm_watch);
    return brief.empty() ? text : text + fmt::format("Confirmed over too short a time: {}.\n", brief);
}

Plot front_plot(const std::vector<ComparedChoice>& choices, const CompareSetting& setting) {
    Plot plot;
    plot.title = "Speed and accuracy: " + setting.scene;
    plot.subtitle = fmt::format("against {} over {}, medians of {} alternating rounds; without unstable choices and those wrong over {}",
                                setting.reference, setting.duration, setting.rounds, time_text(setting.confirm));
    plot.x.label = "wall time per simulated second [s]";
    plot.y.label = "error, larger of axial forces and link tensions";
    plot.x.scale = plot.y.scale = Scale::logarithmic;
    std::vector<std::string> families;
    for (const ComparedChoice& choice : choices) {
        const std::string family = choice.choice.substr(0, choice.choice.find('@'));
        if (families.empty() || families.back() != family) {
            families.push_back(family);
            plot.series.push_back({.name = family, .points = {}, .line = Line::solid, .colour = {}});
        }
        const tasks::TradeoffPoint point = choice.point();
        if (std::isfinite(point.error)) plot.series.back().points.push_back({point.seconds, point.error});
    }
    return plot;
}

}  // namespace cvtflow::bench
