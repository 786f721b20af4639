#include "bench/lab/report/method/stability_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/method/analysis/stability.hpp"
#include "bench/method/laboratory_methods.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

/// Limits of the drawing: of the complex plane, and of friction.
constexpr double map_left = -15.0, map_right = 25.0, map_height = 15.0, much_friction = 1e4;

std::string reach_text(double reach) { return std::isinf(reach) ? "any" : fmt::format("{:.4g}", reach); }

/// "to 2", "without limit".
std::string to_text(double reach) { return std::isinf(reach) ? "without limit" : fmt::format("to {:.4g}", reach); }

std::string figure(double value) { return fmt::format("{:.3g}", value); }

std::string oscillator_lines(const ProgramResult& r) {
    std::string text = field("test equation", "q' = v, v' = -omega^2 q - c v, friction c inside the step");
    text += field("without friction", fmt::format("stable to h omega = {:.4g}", r.first));
    text += field("with any friction", r.any.friction > 0.0 ? fmt::format("stable to h omega = {:.4g}, the minimum, at h c = {:.3g}",
                                                                          r.any.oscillation, r.any.friction)
                                                            : fmt::format("stable to h omega = {:.4g} as well", r.any.oscillation));
    return text + field("friction alone", fmt::format("stable {} in h c", to_text(r.second)));
}

std::string linear_lines(const ProgramResult& r) {
    std::string text = field("test equation", "u' = lambda u with its exact Jacobian");
    text += field("real axis", "stable " + to_text(r.first));
    text += field("imaginary axis", r.second > 0.02 ? "stable " + to_text(r.second) : "weakly unstable");
    return text + field("damped by 1, 5 %", fmt::format("stable {}, {}", to_text(r.ray_1), to_text(r.ray_5)));
}

template <class Row>
std::string table_of(const std::vector<ProgramResult>& results, bool oscillator, const std::vector<std::string>& headings, Row row) {
    std::vector<Table::Column> columns{{"method"}};
    for (const std::string& heading : headings) columns.push_back({heading, Align::right});
    for (const char* heading : {"growth", "gain", "left"}) columns.push_back({heading, Align::right});
    Table table(columns);
    bool any = false;
    for (const ProgramResult& r : results) {
        if (r.oscillator() != oscillator) continue;
        std::vector<std::string> cells{r.program.name};
        for (const double value : row(r)) cells.push_back(reach_text(value));
        for (const double value : {r.worst.growth, r.worst.gain, r.worst.left}) cells.push_back(figure(value));
        table.add(cells);
        any = true;
    }
    return any ? table.text(2) : "";
}

}  // namespace

ProgramResult program_result(const tasks::MethodProgram& program) {
    ProgramResult r{program, analysis_of(program).stability(), 0.0, 0.0, {}, 0.0, 0.0, {}, {}, 0.0};
    const bench::ProgramStability& s = r.stability;
    r.worst = bench::worst_stages(s);
    const auto ray = [&](double damping) { return bench::reach(s, 0.0, 0.0, -damping, std::sqrt(1.0 - damping * damping)); };
    if (r.oscillator()) {
        r.first = bench::reach(s, 0.0, 0.0, 1.0, 0.0);
        r.second = bench::reach(s, 0.0, 0.0, 0.0, 1.0);
        r.any = bench::limit_with_any_friction(s);
    } else {
        r.first = bench::reach(s, 0.0, 0.0, -1.0, 0.0);
        r.second = bench::reach(s, 0.0, 0.0, 0.0, 1.0);
        r.ray_1 = ray(0.01);
        r.ray_5 = ray(0.05);
    }
    return r;
}

std::string program_figures(const ProgramResult& r) {
    std::string text = r.oscillator() ? oscillator_lines(r) : linear_lines(r);
    text += field("stages grow", fmt::format("to {:.4g} for decaying components", r.worst.growth));
    text += field("errors of a stage", fmt::format("amplified by {:.4g} at the end of the step", r.worst.gain));
    return text + field("stiffest component", fmt::format("factor {:.2g} per step", r.worst.left));
}

std::string program_table(const std::vector<ProgramResult>& results) {
    const std::string oscillators =
        table_of(results, true, {"h omega", "with friction", "minimum at h c", "h c"}, [](const ProgramResult& r) {
            return std::vector{r.first, r.any.oscillation, r.any.friction, r.second};
        });
    const std::string linear = table_of(results, false, {"real", "imag", "ray 1 %", "ray 5 %"}, [](const ProgramResult& r) {
        return std::vector{r.first, r.second, r.ray_1, r.ray_5};
    });
    return oscillators + (!oscillators.empty() && !linear.empty() ? "\n" : "") + linear;
}

std::string limit_text(const ProgramLimit& limit) {
    if (std::isinf(limit.predicted.step)) {
        return fmt::format(
            "{}, {}", bench::text_of(limit.predicted),
            std::isinf(limit.measured.step) ? "and none was measured" : fmt::format("but {} measured", time_text(limit.measured.step)));
    }
    const std::string found = std::isinf(limit.measured.step) ? "none measured"
                                                              : fmt::format("{} measured ({:+.2f} %)", time_text(limit.measured.step),
                                                                            100.0 * (limit.measured.step / limit.predicted.step - 1.0));
    return fmt::format("{} predicted, {}", bench::text_of(limit.predicted), found);
}

std::string limit_lines(const std::vector<ProgramResult>& results) {
    std::string text;
    for (const ProgramResult& r : results) {
        if (r.limit) text += field(r.program.name, limit_text(*r.limit));
    }
    return text.empty() ? text : "\nLargest stable step\n" + text;
}

std::string program_csv(const std::vector<ProgramResult>& results) {
    std::string text =
        "method,equation,h_omega,h_omega_any_friction,limiting_h_c,h_c,real,imaginary,ray_1,ray_5,stage_growth,gain,left,stable_step,"
        "stable_step_measured\n";
    for (const ProgramResult& r : results) {
        text += r.program.name;
        text += r.oscillator()
                    ? fmt::format(",oscillator,{:.9g},{:.9g},{:.9g},{:.9g},,,,", r.first, r.any.oscillation, r.any.friction, r.second)
                    : fmt::format(",linear,,,,,{:.9g},{:.9g},{:.9g},{:.9g}", r.first, r.second, r.ray_1, r.ray_5);
        text += fmt::format(",{:.9g},{:.9g},{:.9g}", r.worst.growth, r.worst.gain, r.worst.left);
        text += r.limit ? fmt::format(",{:.9g},{:.9g}\n", r.limit->predicted.step, r.limit->measured.step) : ",,\n";
    }
    return text;
}

namespace {

/// The oscillation that limits the scene's step.
void add_point(Plot& plot, const ProgramResult& r) {
    const double h = r.step > 0.0 ? r.step : r.limit->predicted.step;
    if (!std::isfinite(h)) return;
    plot.series.push_back({fmt::format("the scene at {}", time_text(h)),
                           {{h * r.limit->predicted.oscillation, h * r.limit->predicted.friction}},
                           Mark::diamond,
                           Line::none,
                           ""});
}

}  // namespace

Plot program_map(const ProgramResult& r) {
    Plot plot;
    plot.title = fmt::format("Stability of {}", r.program.name);
    const auto stability = r.stability;
    const auto stable = [stability](double x, double y) { return stability.stable(x, y); };
    if (r.oscillator()) {
        plot.subtitle = "q' = v, v' = -ω² q - c v";
        plot.x = {"h ω", Scale::linear, 1.0, 0.0, 1.3 * r.first};
        plot.y = {"h c", Scale::symlog, 1.0, 0.0, std::isinf(r.second) ? much_friction : 2.0 * r.second};
        plot.regions.push_back({"spectral radius ≤ 1", stable});
        if (r.limit) add_point(plot, r);
    } else {
        plot.subtitle = "u' = λ u, exact Jacobian";
        plot.x = {"Re hλ", Scale::linear, 1.0, map_left, map_right};
        plot.y = {"Im hλ", Scale::linear, 1.0, -map_height, map_height};
        plot.regions.push_back({"|R(hλ)| ≤ 1", stable});
    }
    return plot;
}

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
