#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "bench/lab/plot/plot.hpp"
#include "tools/program/drawing.hpp"

namespace cvtflow::tools {

namespace {

using Json = nlohmann::json;

constexpr int region_points = 320;  ///< points along either axis at which a region is evaluated

Json end_of(const std::optional<double>& end) { return end ? Json(*end) : Json(); }

Json axis_json(const Axis& axis) {
    constexpr const char* names[] = {"linear", "log", "symlog"};
    return {{"label", axis.label},
            {"scale", names[static_cast<int>(axis.scale)]},
            {"linear_up_to", axis.linear_up_to},
            {"from", end_of(axis.from)},
            {"to", end_of(axis.to)}};
}

Json series_json(const Series& series) {
    constexpr const char* marks[] = {"none", "dot", "small_dot", "ring", "square", "diamond", "triangle", "cross"};
    constexpr const char* lines[] = {"none", "solid", "dashed", "dotted"};
    Json x = Json::array(), y = Json::array();
    for (const Point& point : series.points) x.push_back(point.x), y.push_back(point.y);
    return {{"name", series.name},
            {"x", std::move(x)},
            {"y", std::move(y)},
            {"mark", marks[static_cast<int>(series.mark)]},
            {"line", lines[static_cast<int>(series.line)]},
            {"colour", series.colour},
            {"width", series.width},
            {"sets_ends", true}};
}

/// Place of a value along an axis, up to a factor; and back.
double placed(const Axis& axis, double value) {
    if (axis.scale == Scale::linear) return value;
    if (axis.scale == Scale::logarithmic) return std::log10(value);
    const double size = std::abs(value) / axis.linear_up_to;
    return std::copysign(size <= 1.0 ? size : 1.0 + std::log10(size), value);
}
double value_at(const Axis& axis, double place) {
    if (axis.scale == Scale::linear) return place;
    if (axis.scale == Scale::logarithmic) return std::pow(10.0, place);
    const double size = std::abs(place);
    return std::copysign(axis.linear_up_to * (size <= 1.0 ? size : std::pow(10.0, size - 1.0)), place);
}

/// Values along an axis, equally spaced in the picture: between its ends, or those of the points.
std::vector<double> places(const Plot& plot, const Axis& axis, double Point::*coordinate) {
    double from = INFINITY, to = -INFINITY;
    for (const Series& series : plot.series)
        for (const Point& point : series.points)
            if (std::isfinite(point.*coordinate)) from = std::min(from, point.*coordinate), to = std::max(to, point.*coordinate);
    from = axis.from.value_or(from), to = axis.to.value_or(to);
    std::vector<double> all;
    const double first = placed(axis, from), last = placed(axis, to);
    for (int k = 0; from < to && k < region_points; ++k) all.push_back(value_at(axis, first + (last - first) * k / (region_points - 1)));
    return all;
}

Json region_json(const Plot& plot, const Region& region) {
    const std::vector<double> x = places(plot, plot.x, &Point::x), y = places(plot, plot.y, &Point::y);
    Json rows = Json::array();
    for (const double up : y) {
        Json row = Json::array();
        for (const double across : x) row.push_back(region.inside(across, up) ? 1 : 0);
        rows.push_back(std::move(row));
    }
    return {{"name", region.name}, {"colour", region.colour}, {"x", x}, {"y", y}, {"inside", std::move(rows)}};
}

}  // namespace

std::string svg(const std::vector<Plot>& plots) {
    Json panels = Json::array();
    for (const Plot& plot : plots) {
        Json series = Json::array(), regions = Json::array();
        for (const Series& each : plot.series) series.push_back(series_json(each));
        for (const Region& each : plot.regions) regions.push_back(region_json(plot, each));
        panels.push_back({{"title", plot.title},
                          {"x", axis_json(plot.x)},
                          {"y", axis_json(plot.y)},
                          {"series", std::move(series)},
                          {"regions", std::move(regions)},
                          {"height", 540.0}});
    }
    return drawn(
        {{"command", "chart"}, {"format", "svg"}, {"heading", plots.empty() ? "" : plots.front().subtitle}, {"panels", std::move(panels)}});
}

std::string svg(const Plot& plot) { return svg(std::vector{plot}); }
std::string palette(std::size_t number) { return "C" + std::to_string(number); }

}  // namespace cvtflow::tools
