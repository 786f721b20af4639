#include "bench/lab/report/comparison_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/lab/text/method_choice_text.hpp"
#include "bench/lab/text/watch_text.hpp"
#include "tools/program/text/provenance_json.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

using nlohmann::ordered_json;

namespace {

/// Of the first candidate, over this one's.
double speed_up(const Comparison& comparison, const Compared& compared) {
    return compared.seconds > 0.0 ? comparison.candidates.front().seconds / compared.seconds : NAN;
}
double saving(const Comparison& comparison, const Compared& compared) {
    return static_cast<double>(comparison.candidates.front().counters.evaluations) /
           static_cast<double>(std::max(1L, compared.counters.evaluations));
}

std::string error_cell(double error) { return std::isnan(error) ? "-" : fmt::format("{:.2e}", error); }

std::string number(double value, const char* absent = "") { return std::isfinite(value) ? fmt::format("{:.9g}", value) : absent; }

}  // namespace

std::string comparison_table(const Comparison& comparison, const ComparisonOptions& options) {
    const auto right = [](const char* heading) { return Table::Column{heading, Align::right}; };
    Table table({{"method"},
                 right("step"),
                 right("steps"),
                 right("evaluations"),
                 right("eval./s"),
                 right("fewer by"),
                 right("s/simulated s"),
                 right("faster by"),
                 right("err axial"),
                 right("err tension"),
                 right("err pin"),
                 right("residual"),
                 {"remark"}});
    for (const Compared& compared : comparison.candidates) {
        const double rate = static_cast<double>(compared.counters.evaluations) / options.duration;
        const bool good = !compared.fault;
        table.add({compared.candidate.method, time_text(compared.step), count_text(compared.counters.steps),
                   count_text(compared.counters.evaluations), good ? fmt::format("{:.3g}", rate) : "-",
                   good ? fmt::format("{:.2f}", saving(comparison, compared)) : "-",
                   good && compared.seconds > 0.0 ? fmt::format("{:.4g}", compared.seconds / options.duration) : "-",
                   good && compared.seconds > 0.0 ? fmt::format("{:.2f}", speed_up(comparison, compared)) : "-",
                   error_cell(compared.error_axial), error_cell(compared.error_tension), error_cell(compared.error_pin),
                   residual_cell(compared.fault, compared.watch),
                   compared.fault ? compared.fault.message() : unreliable_remark(compared.fault, compared.watch)});
    }
    return table.text(2);
}

std::string comparison_csv(const Comparison& comparison, const ComparisonOptions& options) {
    std::string text =
        "method,step,steps,evaluations,transitions,fewer_by,seconds_per_simulated_second,faster_by,error_axial,error_tension,error_pin,"
        "finished,";
    text += watch_heading + std::string("\n");
    for (const Compared& compared : comparison.candidates) {
        const tasks::Counters& counted = compared.counters;
        text += fmt::format("{},{:.17g},{},{},{},{},{},{},{},{},{},{},{}\n", compared.candidate.method, compared.step, counted.steps,
                            counted.evaluations, counted.detected, number(saving(comparison, compared)),
                            compared.seconds > 0.0 ? number(compared.seconds / options.duration) : "",
                            number(speed_up(comparison, compared)), number(compared.error_axial), number(compared.error_tension),
                            number(compared.error_pin), compared.fault ? "no" : "yes", watch_csv(compared.fault, compared.watch));
    }
    return text;
}

std::string comparison_json(const std::string& scene, const Comparison& comparison, const ComparisonOptions& options) {
    ordered_json rows = ordered_json::array();
    for (const Compared& compared : comparison.candidates) {
        rows.push_back({{"method", compared.candidate.method},
                        {"step", compared.step},
                        {"steps", compared.counters.steps},
                        {"evaluations", compared.counters.evaluations},
                        {"transitions", compared.counters.detected},
                        {"seconds", compared.seconds},
                        {"error_axial", compared.error_axial},
                        {"error_tension", compared.error_tension},
                        {"error_pin", compared.error_pin},
                        {"fault", compared.fault ? compared.fault.message() : ""},
                        {"watch", watch_json(compared.fault, compared.watch)}});
    }
    const ordered_json json{{"scene", scene},
                            {"provenance", provenance_json()},
                            {"duration", options.duration},
                            {"output_interval", options.output_interval},
                            {"rounds", options.rounds},
                            {"reference", candidate_name(options.reference)},
                            {"reference_watch", watch_json({}, comparison.reference_watch)},
                            {"pin", comparison.pin.value_or(-1)},
                            {"entry", comparison.entry},
                            {"candidates", rows}};
    return json_text(json);
}

namespace {

/// Colours repeat after eight.
Line line_of(std::size_t series) { return series < 8 ? Line::solid : Line::dashed; }

Plot empty_plot(const std::string& scene, const Comparison& comparison, const std::string& quantity) {
    Plot plot;
    plot.title = fmt::format("{} of pin {}", quantity, *comparison.pin);
    plot.subtitle = fmt::format("{}, on the sheave at -z; the pin enters the driving sheaves at {}", scene, time_text(comparison.entry));
    plot.x = {"time [ms]", Scale::linear, 1.0, {}, {}};
    plot.y = {quantity + " [N]", Scale::linear, 1.0, {}, {}};
    return plot;
}

}  // namespace

Plot pin_plot(const std::string& scene, const Comparison& comparison) {
    Plot plot = empty_plot(scene, comparison, "Axial force");
    const auto add = [&](const std::string& name, const Course& course, const std::string& colour, Line line, double width) {
        Series series{name, {}, Mark::none, line, colour, width};
        const std::vector<double> force = course.pin_axial(*comparison.pin, 0);
        for (std::size_t k = 0; k < force.size(); ++k) series.points.push_back({1e3 * course.time[k], force[k]});
        plot.series.push_back(std::move(series));
    };
    add("reference", comparison.reference, "#bbbbbb", Line::solid, 5.0);  // below the others, which mostly hide one another
    for (const Compared& compared : comparison.candidates) {
        const std::size_t number = plot.series.size() - 1;
        if (!compared.fault) add(candidate_name(compared.candidate), compared.course, palette(number), line_of(number), 1.6);
    }
    return plot;
}

Plot pin_error_plot(const std::string& scene, const Comparison& comparison) {
    Plot plot = empty_plot(scene, comparison, "Error of the axial force");
    plot.y.label = "|force - reference| [N]";
    plot.y.scale = Scale::logarithmic;
    const std::vector<double> should = comparison.reference.pin_axial(*comparison.pin, 0);
    for (const Compared& compared : comparison.candidates) {
        if (compared.fault) continue;
        Series series{candidate_name(compared.candidate), {}, Mark::none, line_of(plot.series.size()), ""};
        const std::vector<double> force = compared.course.pin_axial(*comparison.pin, 0);
        for (std::size_t k = 0; k < std::min(force.size(), should.size()); ++k)
            series.points.push_back({1e3 * compared.course.time[k], std::abs(force[k] - should[k])});
        plot.series.push_back(std::move(series));
    }
    return plot;
}

std::string pin_csv(const Comparison& comparison) {
    std::string text = "time,reference";
    std::vector<std::vector<double>> columns{comparison.reference.pin_axial(*comparison.pin, 0)};
    for (const Compared& compared : comparison.candidates) {
        if (compared.fault) continue;
        text += "," + candidate_name(compared.candidate);
        columns.push_back(compared.course.pin_axial(*comparison.pin, 0));
    }
    text += "\n";
    for (std::size_t row = 0; row < comparison.reference.time.size(); ++row) {
        text += fmt::format("{:.9g}", comparison.reference.time[row]);
        for (const auto& column : columns) text += fmt::format(",{:.9g}", row < column.size() ? column[row] : NAN);
        text += "\n";
    }
    return text;
}

}  // namespace cvtflow::bench
