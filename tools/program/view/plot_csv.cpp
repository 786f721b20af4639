#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tasks/scene/csv.hpp"
#include "tools/program/view/run_plots.hpp"

namespace cvtflow::tools {

std::string csv(const std::vector<Plot>& plots) {
    const bool fields = std::any_of(plots.begin(), plots.end(), [](const Plot& plot) { return !plot.fields.empty(); });
    std::string text = fields ? "plot,series,x,y,value,x axis,y axis\n" : "plot,series,x,y,x axis,y axis\n";
    const auto quoted = [](const std::string& cell) { return tasks::csv_cell(cell, true, true); };
    for (const Plot& plot : plots) {
        const std::string axes = fmt::format(",{},{}\n", quoted(plot.x.label), quoted(plot.y.label));
        for (const Field& field : plot.fields) {
            for (std::size_t k = 0; k < field.values.size(); ++k)
                text += fmt::format("{},{},{:.9g},{:.9g},{:.9g}{}", quoted(plot.title), quoted(field.label), field.x[k % field.x.size()],
                                    field.y[k / field.x.size()], field.values[k], axes);
        }
        for (const Series& series : plot.series) {
            const std::string name = quoted(series.name.empty() ? plot.title : series.name);
            for (const Point& point : series.points) {
                if (std::isfinite(point.x) && std::isfinite(point.y))
                    text += fmt::format("{},{},{:.9g},{:.9g}{}{}", quoted(plot.title), name, point.x, point.y, fields ? "," : "", axes);
            }
        }
    }
    return text;
}

}  // namespace cvtflow::tools
