#include "tools/program/view/sweep_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "tasks/scene/units.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/plot/axis_scale.hpp"
#include "tools/program/plot/field.hpp"
#include "tools/program/view/labels.hpp"

namespace cvtflow::tools {

namespace {

std::size_t numbers_of(const SweepView& sweep, const std::string& word) {
    const std::size_t column = sweep.column(word);
    if (!sweep.columns[column].number) throw UsageError(fmt::format("{}: the cells of this column are not numbers", word));
    return column;
}

std::string heading_of(const SweepColumn& column) { return shown(column.name, column.unit).label; }
double factor_of(const SweepColumn& column) { return shown(column.name, column.unit).factor; }

/// "load torque" of a column.
std::string title_of(const SweepColumn& column) {
    const std::string heading = heading_of(column);
    return heading.substr(0, heading.find(" ["));
}

/// In the unit of the column's heading.
double value_of(const SweepView& sweep, std::size_t row, std::size_t column) {
    return sweep.number(row, column) * factor_of(sweep.columns[column]);
}

/// "start ratio 2.4", "clamping driven 10000 N".
std::string setting_text(const SweepView& sweep, std::size_t row, std::size_t column) {
    const SweepColumn& key = sweep.columns[column];
    const double value = sweep.number(row, column);
    if (!std::isfinite(value)) return fmt::format("{} {}", title_of(key), sweep.cells[row][column]);
    const bool plain = key.unit.empty() || key.unit == "1";
    return fmt::format("{} {}", title_of(key), plain ? sweep.cells[row][column] : tasks::quantity_text(value, key.unit));
}

/// "153 of 160 cases".
std::string counts_text(const SweepView& sweep, std::size_t good) {
    return good == sweep.cells.size() ? fmt::format("{} cases", good)
                                      : fmt::format("{} of {} cases, those that ended well", good, sweep.cells.size());
}

/// Axes other than the given columns that the cases differ in.
std::vector<std::size_t> others(const SweepView& sweep, const std::set<std::size_t>& but) {
    std::vector<std::size_t> found;
    for (std::size_t c = 0; c < sweep.columns.size(); ++c) {
        if (!sweep.columns[c].axis || but.contains(c)) continue;
        std::set<std::string> values;
        for (const auto& row : sweep.cells) values.insert(row[c]);
        if (values.size() > 1) found.push_back(c);
    }
    return found;
}

/// Those of the columns that tell the cases apart: one that only follows the others is left out.
std::vector<std::size_t> telling(const SweepView& sweep, const std::vector<std::size_t>& columns) {
    std::vector<std::size_t> kept;
    std::vector<std::string> names(sweep.cells.size());
    for (const std::size_t c : columns) {
        std::vector<std::string> finer = names;
        for (std::size_t row = 0; row < finer.size(); ++row) finer[row] += "\n" + sweep.cells[row][c];
        if (std::set(finer.begin(), finer.end()).size() == std::set(names.begin(), names.end()).size()) continue;
        names = std::move(finer);
        kept.push_back(c);
    }
    return kept;
}

struct Chosen {
    SweepView good;
    Plot plot;
};

Chosen begin_plot(const SweepView& sweep, const SweepColumn& x, const SweepColumn& y, const std::string& title) {
    Chosen made{sweep, {}};
    made.good.keep_good();
    if (made.good.cells.empty()) throw UsageError(sweep.path + ": no case ended well");
    made.plot.title = title;
    made.plot.subtitle = fmt::format("sweep {}, {}", sweep.name, counts_text(sweep, made.good.cells.size()));
    made.plot.x.label = heading_of(x);
    made.plot.y.label = heading_of(y);
    return made;
}

/// Points whose colours tell a value, in eight steps.
void add_points(Plot& plot, const SweepView& sweep, std::size_t x, std::size_t y, std::size_t colour, const std::string& label) {
    Field values{label, {0.0, 1.0}, {0.0, 1.0}, {}};
    for (std::size_t row = 0; row < sweep.cells.size(); ++row) values.values.push_back(value_of(sweep, row, colour));
    std::vector<double> levels = contour_levels(values);
    if (levels.empty()) levels.push_back(values.values.empty() ? 0.0 : values.values.front());
    const double step = levels.size() > 1 ? levels[1] - levels[0] : 1.0;
    for (std::size_t k = 0; k < levels.size(); ++k) {
        const double share = levels.size() > 1 ? static_cast<double>(k) / static_cast<double>(levels.size() - 1) : 0.5;
        const std::string from = tick_label(levels[k] - 0.5 * step, 0.1 * step), to = tick_label(levels[k] + 0.5 * step, 0.1 * step);
        const bool first = k == 0, last = k + 1 == levels.size();  // what lies beyond the levels belongs to the nearest
        Series series{first && last ? "all"
                      : first       ? "below " + to
                      : last        ? "above " + from
                                    : fmt::format("{} … {}", from, to),
                      {},
                      Mark::dot,
                      Line::none,
                      heat_colour(share)};
        for (std::size_t row = 0; row < sweep.cells.size(); ++row) {
            const double value = value_of(sweep, row, colour);
            const auto nearest =
                static_cast<std::size_t>(std::clamp(std::lround((value - levels[0]) / step), 0L, static_cast<long>(levels.size()) - 1));
            if (std::isfinite(value) && nearest == k) series.points.push_back({value_of(sweep, row, x), value_of(sweep, row, y)});
        }
        plot.series.push_back(std::move(series));
    }
}

std::vector<double> distinct(const SweepView& sweep, std::size_t column) {
    std::set<double> values;
    for (std::size_t row = 0; row < sweep.cells.size(); ++row) values.insert(value_of(sweep, row, column));
    return {values.begin(), values.end()};
}

/// The cases by their places. @throws UsageError for two at one place
std::map<std::pair<double, double>, double> by_place(const SweepView& sweep, std::size_t x, std::size_t y, std::size_t colour) {
    std::map<std::pair<double, double>, double> places;
    for (std::size_t row = 0; row < sweep.cells.size(); ++row) {
        const auto [at, added] = places.insert({{value_of(sweep, row, x), value_of(sweep, row, y)}, value_of(sweep, row, colour)});
        if (added) continue;
        std::string differ;
        for (const std::size_t c : others(sweep, {x, y, colour})) differ += (differ.empty() ? "" : ", ") + sweep.columns[c].name;
        throw UsageError(fmt::format("several cases at one point of {} and {}: choose with --where COLUMN=VALUE among {}",
                                     sweep.columns[x].name, sweep.columns[y].name, differ.empty() ? "the columns" : differ));
    }
    return places;
}

}  // namespace

Plot sweep_curves(const SweepView& sweep, const std::string& x, const std::string& y) {
    const std::size_t xc = numbers_of(sweep, x), yc = numbers_of(sweep, y);
    Chosen made = begin_plot(sweep, sweep.columns[xc], sweep.columns[yc],
                             fmt::format("{} over {}", title_of(sweep.columns[yc]), title_of(sweep.columns[xc])));
    const std::vector<std::size_t> rest = telling(made.good, others(made.good, {xc, yc}));
    std::map<std::string, std::vector<Point>> curves;
    std::vector<std::string> order;
    for (std::size_t row = 0; row < made.good.cells.size(); ++row) {
        std::string name;
        for (const std::size_t c : rest) name += (name.empty() ? "" : ", ") + setting_text(made.good, row, c);
        if (!curves.contains(name)) order.push_back(name);
        curves[name].push_back({value_of(made.good, row, xc), value_of(made.good, row, yc)});
    }
    for (const std::string& name : order) {
        auto& points = curves[name];
        std::stable_sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.x < b.x; });
        made.plot.series.push_back({name, points, Mark::dot, Line::solid, "", 1.4});
    }
    return made.plot;
}

Plot sweep_map(const SweepView& sweep, const std::string& x, const std::string& y, const std::string& colour) {
    const std::size_t xc = numbers_of(sweep, x), yc = numbers_of(sweep, y), cc = numbers_of(sweep, colour);
    const std::string label = heading_of(sweep.columns[cc]);
    Chosen made =
        begin_plot(sweep, sweep.columns[xc], sweep.columns[yc],
                   fmt::format("{} over {} and {}", title_of(sweep.columns[cc]), title_of(sweep.columns[xc]), title_of(sweep.columns[yc])));
    const auto places = by_place(made.good, xc, yc, cc);
    Field field{label, distinct(made.good, xc), distinct(made.good, yc), {}};
    const std::size_t grid = field.x.size() * field.y.size();
    if (field.x.size() < 2 || field.y.size() < 2 || 2 * places.size() < grid) {  // hardly a grid
        made.plot.series.push_back({label, {}, Mark::none, Line::none, "#000000"});
        add_points(made.plot, made.good, xc, yc, cc, label);
        return made.plot;
    }
    Series cases{"cases", {}, Mark::small_dot, Line::none, "#ffffff"};
    for (const double row : field.y) {
        for (const double column : field.x) {
            const auto found = places.find({column, row});
            field.values.push_back(found == places.end() ? NAN : found->second);
            if (found != places.end()) cases.points.push_back({column, row});
        }
    }
    cases.name.clear();
    made.plot.series.push_back(std::move(cases));
    made.plot.fields.push_back(std::move(field));
    return made.plot;
}

}  // namespace cvtflow::tools
