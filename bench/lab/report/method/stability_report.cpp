#include "bench/lab/report/method/stability_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/method/analysis/stability.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

double ray(const engine::StagePlan& plan, double damping) {
    return bench::stability_reach(plan, {-damping, std::sqrt(1.0 - damping * damping)}, 1e-6);
}

std::string short_number(double value) { return value < 1e4 ? fmt::format("{:.4g}", value) : fmt::format("{:.2e}", value); }

double evaluations_per_second(const StabilityResult& result) {
    return static_cast<double>(result.plan.stages.size()) / result.limit->predicted.step;
}

}  // namespace

StabilityResult stability_of(const engine::StagePlan& plan) {
    return {plan, bench::real_stability(plan), bench::imaginary_stability(plan), ray(plan, 0.01), ray(plan, 0.05), {}, 0.0, 0.0};
}

std::string stability_table(const std::vector<StabilityResult>& results) {
    const auto right = [](const char* heading) { return Table::Column{heading, Align::right}; };
    const bool scene = !results.empty() && results.front().limit;
    std::vector<Table::Column> columns{{"method"}, right("stages"), right("real"), right("imag"), right("ray 1 %"), right("ray 5 %")};
    if (scene) columns.insert(columns.end(), {right("growth"), right("gain"), right("eval./s"), {"largest stable step"}});
    Table table(columns);
    for (const StabilityResult& result : results) {
        std::vector<std::string> cells{result.plan.name,           std::to_string(result.plan.stages.size()),
                                       short_number(result.real),  short_number(result.imaginary),
                                       short_number(result.ray_1), short_number(result.ray_5)};
        if (scene) {
            const std::vector<std::string> more{short_number(result.growth), short_number(result.gain),
                                                fmt::format("{:.3g}", evaluations_per_second(result)), limit_text(*result.limit)};
            cells.insert(cells.end(), more.begin(), more.end());
        }
        table.add(cells);
    }
    return table.text(2);
}

std::string stability_csv(const std::vector<StabilityResult>& results) {
    std::string text =
        "method,stages,real,imaginary,ray_1,ray_5,stage_growth,gain,predicted,limiting_real,limiting_imaginary,measured_stable,measured_"
        "unstable\n";
    for (const StabilityResult& result : results) {
        text += fmt::format("{},{},{:.9g},{:.9g},{:.9g},{:.9g}", result.plan.name, result.plan.stages.size(), result.real, result.imaginary,
                            result.ray_1, result.ray_5);
        if (result.limit) {
            const PlanLimit& limit = *result.limit;
            text += fmt::format(",{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}", result.growth, result.gain, limit.predicted.step,
                                limit.predicted.limiting.real(), limit.predicted.limiting.imag(), limit.measured.stable,
                                limit.measured.unstable);
        } else {
            text += ",,,,,,,";
        }
        text += "\n";
    }
    return text;
}

Plot stability_map(const StabilityResult& result, const bench::Eigenvalues& values, double step, const std::string& scene) {
    Plot plot;
    plot.title = fmt::format("Stability of {}", result.plan.name);
    const double reach = std::max({result.real, 1.0, step * extent_of(values).decay});
    double half = std::max({result.imaginary, result.ray_5, step * extent_of(values).oscillation, 1.0});
    const auto factor = bench::stability_function(result.plan);
    const auto stable = [factor](double x, double y) { return std::abs(factor({x, y})) <= 1.0; };
    for (double x = -reach; x < -1e-3; x *= 0.9) {
        while (half < 100.0 && stable(x, 1.05 * half)) half *= 1.1;  // shows the widest part completely
    }
    plot.x = {"Re hλ", reach > 20.0 ? Scale::symlog : Scale::linear, 1.0, -1.3 * reach, std::min(2.0, 0.3 * reach)};
    plot.y = {"Im hλ", Scale::linear, 1.0, -1.15 * half, 1.15 * half};
    plot.regions.push_back({"|R(hλ)| ≤ 1", stable});
    if (values.empty()) return plot;
    plot.subtitle = fmt::format("eigenvalues of {} times h = {}", scene, time_text(step));
    Series series{"hλ", {}, Mark::small_dot, Line::none, "#0072b2"}, outside{"hλ, growing", {}, Mark::cross, Line::none, "#d55e00"};
    for (const auto& value : values) {
        const auto z = step * value;
        const bool grows = std::log(std::abs(factor(z))) / step > std::max(value.real(), 0.0) + growth_rate_tolerance;
        (grows ? outside : series).points.push_back({z.real(), z.imag()});
    }
    plot.series = {series};
    if (!outside.points.empty()) plot.series.push_back(outside);
    return plot;
}

}  // namespace cvtflow::bench
