#include "bench/lab/report/pin_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "tasks/scene/csv.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

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
