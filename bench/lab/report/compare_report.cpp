#include "bench/lab/report/compare_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "bench/lab/text/text.hpp"
#include "tasks/scene/csv.hpp"
#include "tools/program/text/report_columns.hpp"
#include "tools/program/text/text.hpp"

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

ChoiceColumns columns_of(const ComparedChoice& first, const CompareSetting& setting) {
    ChoiceColumns columns;
    add_costs(columns, first);
    add_errors(columns, setting.pin.has_value());
    if (setting.newton) add_newton(columns);
    const auto watch = [](const ComparedChoice& c) { return watch_json(c.run.fault, c.run.watch); };
    columns.push_back({"", "residual", {}, [](const ComparedChoice& c) { return residual_cell(c.run.fault, c.run.watch); }});
    columns.push_back({"", "status", {}, [](const ComparedChoice& c) { return c.run.watch.status(c.run.fault); }, Align::left});
    add_watch(columns, "", watch);
    return columns;
}

}  // namespace

double ComparedChoice::median() const {
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
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
    return json_text(json);
}

namespace {

/// Colours repeat after eight.
Line line_of(std::size_t series) { return series < 8 ? Line::solid : Line::dashed; }

Plot empty_plot(const CompareSetting& setting, const std::string& quantity) {
    Plot plot;
    plot.title = fmt::format("{} of pin {}", quantity, setting.pin->pin);
    plot.subtitle = setting.scene + ", on the sheave at -z";
    if (setting.pin->time > 0.0) plot.subtitle += fmt::format("; the pin enters the driving sheaves at {}", time_text(setting.pin->time));
    plot.x = {"time [ms]", Scale::linear, 1.0, {}, {}};
    plot.y = {quantity + " [N]", Scale::linear, 1.0, {}, {}};
    return plot;
}

}  // namespace

std::string pin_csv(const std::vector<ComparedChoice>& choices, const Trajectory& reference, const CompareSetting& setting) {
    std::string text = "time,reference";
    std::vector<std::vector<double>> columns{reference.pin_axial(setting.pin->pin, 0)};
    for (const ComparedChoice& choice : choices) {
        if (choice.run.fault) continue;
        text += "," + tasks::csv_cell(choice.choice, true);
        columns.push_back(choice.run.pin_axial(setting.pin->pin, 0));
    }
    text += "\n";
    for (std::size_t row = 0; row < reference.times.size(); ++row) {
        text += fmt::format("{:.9g}", reference.times[row]);
        for (const auto& column : columns) text += fmt::format(",{:.9g}", column[row]);
        text += "\n";
    }
    return text;
}

Plot pin_plot(const std::vector<ComparedChoice>& choices, const Trajectory& reference, const CompareSetting& setting) {
    Plot plot = empty_plot(setting, "Axial force");
    const auto add = [&](const std::string& name, const Trajectory& run, const std::string& colour, Line line, double width) {
        Series series{name, {}, Mark::none, line, colour, width};
        const std::vector<double> force = run.pin_axial(setting.pin->pin, 0);
        for (std::size_t k = 0; k < force.size(); ++k) series.points.push_back({1e3 * run.times[k], force[k]});
        plot.series.push_back(std::move(series));
    };
    add("reference", reference, "#bbbbbb", Line::solid, 5.0);  // below the others, which mostly hide one another
    for (const ComparedChoice& choice : choices) {
        const std::size_t number = plot.series.size() - 1;
        if (!choice.run.fault) add(choice.choice, choice.run, palette(number), line_of(number), 1.6);
    }
    return plot;
}

Plot pin_error_plot(const std::vector<ComparedChoice>& choices, const Trajectory& reference, const CompareSetting& setting) {
    Plot plot = empty_plot(setting, "Error of the axial force");
    plot.y.label = "|force - reference| [N]";
    plot.y.scale = Scale::logarithmic;
    const std::vector<double> should = reference.pin_axial(setting.pin->pin, 0);
    for (const ComparedChoice& choice : choices) {
        if (choice.run.fault) continue;
        Series series{choice.choice, {}, Mark::none, line_of(plot.series.size()), ""};
        const std::vector<double> force = choice.run.pin_axial(setting.pin->pin, 0);
        for (std::size_t k = 0; k < should.size(); ++k)
            series.points.push_back({1e3 * choice.run.times[k], std::abs(force[k] - should[k])});
        plot.series.push_back(std::move(series));
    }
    return plot;
}

}  // namespace cvtflow::bench
