#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "tasks/batch/results/results.hpp"
#include "tools/program/text/scene_text.hpp"
#include "tools/program/text/text.hpp"
#include "tools/program/view/sweep_view.hpp"

namespace cvtflow::tools {

namespace {

constexpr const char* mark_colour = "#e3342f";

/// Limits of loads above zero and below it, over the other axis, in units of display.
using Limits = std::array<std::map<double, double>, 2>;

/// None where two cases at one place of the other axis have two limits.
Limits limits_over(const SweepView& sweep, std::size_t load, std::size_t other) {
    constexpr double same = 1e-3;  // less than the width of a line
    const double factor = shown(sweep.columns[load].name, sweep.columns[load].unit).factor;
    Limits limits;
    for (std::size_t row = 0; row < sweep.cells.size(); ++row) {
        const std::optional<double> torque = load_limit(sweep, row);
        if (!torque) continue;
        const double limit = factor * *torque;
        const auto [at, added] = limits[std::signbit(limit) ? 1 : 0].insert({value_of(sweep, row, other), limit});
        if (!added && !(std::abs(at->second - limit) <= same * std::abs(limit))) return {};
    }
    return limits;
}

/// @param across whether the load is the horizontal axis
void add_limits(std::vector<Series>& marks, const SweepView& sweep, std::size_t load, std::size_t other, bool across) {
    std::vector<double> loads;
    for (std::size_t row = 0; row < sweep.cells.size(); ++row) loads.push_back(value_of(sweep, row, load));
    const auto [least, largest] = std::ranges::minmax(loads);
    for (const auto& limits : limits_over(sweep, load, other)) {
        if (limits.size() < 2) continue;
        const auto by_limit = [](const auto& a, const auto& b) { return a.second < b.second; };
        const auto [lowest, highest] = std::minmax_element(limits.begin(), limits.end(), by_limit);
        if (lowest->second > largest || highest->second < least) continue;
        Series line{marks.empty() ? "torque limit" : "", {}, Mark::none, Line::dashed, mark_colour, 2.2, false};
        for (const auto& [place, limit] : limits) line.points.push_back(across ? Point{limit, place} : Point{place, limit});
        marks.push_back(std::move(line));
    }
}

/// Whether a case also ran at reference quality: its row has measured errors. Cases that end when they are steady state errors, too.
bool verified(const SweepView& sweep, std::size_t row) {
    if (std::ranges::count(sweep.columns, "settled_for", &SweepColumn::name) > 0) return false;
    for (std::size_t c = 0; c < sweep.columns.size(); ++c)
        if (sweep.columns[c].name.starts_with(tasks::error_prefix) && std::isfinite(sweep.number(row, c))) return true;
    return false;
}

}  // namespace

std::optional<double> load_limit(const SweepView& sweep, std::size_t row) {
    std::optional<tasks::Scene> scene = sweep.scene_of_case(row);
    if (!scene) return {};
    model::Parameters& p = scene->parameters;
    if (p.clamping.safety > 0.0) return {};  // the clamping force follows the load
    if (p.control.enabled) p.start.ratio = p.control.ratio.at(tasks::latest_end(*scene));
    const auto least = least_safety(*scene);
    if (!least) return {};
    return p.load.torque.at(0.0) + std::copysign(least->limit, least->load) - least->load;
}

std::vector<Series> map_marks(const SweepView& sweep, std::size_t x, std::size_t y) {
    std::vector<Series> marks;
    if (sweep.columns[x].name == "load_torque") add_limits(marks, sweep, x, y, true);
    if (sweep.columns[y].name == "load_torque") add_limits(marks, sweep, y, x, false);
    Series points{"verified", {}, Mark::diamond, Line::none, mark_colour};
    for (std::size_t row = 0; row < sweep.cells.size(); ++row)
        if (verified(sweep, row)) points.points.push_back({value_of(sweep, row, x), value_of(sweep, row, y)});
    if (!points.points.empty()) marks.push_back(std::move(points));
    return marks;
}

}  // namespace cvtflow::tools
