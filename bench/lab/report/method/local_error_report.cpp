#include "bench/lab/report/method/local_error_report.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "tools/program/text/report_columns.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

constexpr std::array parts{&LocalError::positions, &LocalError::velocities, &LocalError::axial_force, &LocalError::tension};

std::string error_text(double error) {
    if (std::isnan(error)) return "cut";
    return error > 0.0 ? fmt::format("{:.3e}", error) : "0";
}

/// log(e/e')/log(h/h') between a row and the one above it.
std::string slope(double error, double above, double ratio) {
    return error > 0.0 && above > 0.0 ? fmt::format("{:.2f}", std::log(above / error) / std::log(ratio)) : "";
}

}  // namespace

std::string error_table(const std::vector<LocalError>& errors) {
    const auto right = [](const char* heading) { return Table::Column{heading, Align::right}; };
    Table table({right("step"), right("positions"), right("slope"), right("velocities"), right("slope"), right("axial force"),
                 right("slope"), right("tension"), right("slope")});
    for (std::size_t i = 0; i < errors.size(); ++i) {
        std::vector<std::string> cells{time_text(errors[i].step)};
        for (const auto part : parts) {
            cells.push_back(error_text(errors[i].*part));
            cells.push_back(i == 0 ? "" : slope(errors[i].*part, errors[i - 1].*part, errors[i - 1].step / errors[i].step));
        }
        table.add(cells);
    }
    return table.text(2);
}

std::string error_csv(const std::vector<ErrorCurve>& curves) {
    std::string text = "method,friction,step,positions,velocities,axial_force,tension\n";
    for (const ErrorCurve& curve : curves) {
        for (const LocalError& error : curve.errors) {
            text += fmt::format("{},{},{:.17g}", curve.method, curve.friction, error.step);
            for (const auto part : parts) text += std::isnan(error.*part) ? "," : fmt::format(",{:.9g}", error.*part);
            text += "\n";
        }
    }
    return text;
}

std::string error_json(const std::vector<ErrorCurve>& curves, const std::string& scene) {
    auto list = nlohmann::ordered_json::array();
    for (const ErrorCurve& curve : curves) {
        auto rows = nlohmann::ordered_json::array();
        for (const LocalError& error : curve.errors) {
            rows.push_back({{"step", error.step},
                            {"positions", error.positions},
                            {"velocities", error.velocities},
                            {"axial_force", error.axial_force},
                            {"tension", error.tension}});
        }
        list.push_back({{"method", curve.method}, {"friction", curve.friction}, {"errors", rows}});
    }
    return json_text({{"scene", scene}, {"provenance", provenance_json()}, {"curves", list}});
}

Plot error_plot(const std::vector<ErrorCurve>& curves, const std::string& friction, double LocalError::*part, const std::string& name,
                const std::string& scene) {
    static constexpr std::array marks{Mark::dot, Mark::ring, Mark::square, Mark::diamond, Mark::triangle, Mark::cross};
    Plot plot;
    plot.title = fmt::format("Error of one step: {}", name);
    plot.subtitle = fmt::format("{}, {} friction, relative to tight rk4", scene, friction);
    plot.x = {"step [s]", Scale::logarithmic, 1.0, {}, {}};
    plot.y = {"relative error", Scale::logarithmic, 1.0, {}, {}};
    for (const ErrorCurve& curve : curves) {
        if (curve.friction != friction) continue;
        Series series{curve.method, {}, marks[plot.series.size() % marks.size()], Line::solid, ""};
        for (const LocalError& error : curve.errors)
            series.points.push_back({error.step, std::isfinite(error.*part) && error.*part < 1e6 ? error.*part : NAN});
        plot.series.push_back(std::move(series));
    }
    return plot;
}

}  // namespace cvtflow::bench
