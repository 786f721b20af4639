#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/lab/command/command.hpp"
#include "bench/lab/plot/plot.hpp"
#include "bench/lab/report/method/spectrum_report.hpp"
#include "bench/lab/settled_start.hpp"
#include "bench/method/analysis/eigenvalues.hpp"
#include "bench/method/analysis/stability.hpp"
#include "bench/study/spectrum.hpp"
#include "bench/study/stability/stable_step.hpp"
#include "tasks/method/method.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

/// A method and its limits by a scene's spectrum.
struct StabilityResult {
    engine::StagePlan plan;
    double real = 0.0, imaginary = 0.0;  ///< reach along the axes
    double ray_1 = 0.0, ray_5 = 0.0;     ///< reach along rays of damping ratio 1 % and 5 %
    std::optional<PlanLimit> limit;      ///< limit on a scene, if any
    double growth = 0.0, gain = 0.0;     ///< growth of stages and of their errors over the scene's decays at the limit; only with a scene
};

double ray(const engine::StagePlan& plan, double damping) {
    return bench::stability_reach(plan, {-damping, std::sqrt(1.0 - damping * damping)}, 1e-6);
}

std::string short_number(double value) { return value < 1e4 ? fmt::format("{:.4g}", value) : fmt::format("{:.2e}", value); }

double evaluations_per_second(const StabilityResult& result) {
    return static_cast<double>(result.plan.stages.size()) / result.limit->predicted.step;
}

/// Reaches, and over [-length, 0] nothing yet.
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

/// |R(z)| ≤ 1, and the eigenvalues times the step. @param values may be empty   @param step [s]
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

struct StabilityArguments {
    std::vector<std::string> methods;
    SceneArguments scene;
    OutputArguments output;
    bool all = false, quiet = false;
    double step = 0.0;
};

std::vector<engine::StagePlan> chosen(const StabilityArguments& arguments) {
    std::vector<engine::StagePlan> plans;
    for (const std::string& name : arguments.methods) {
        const std::optional<tasks::Method> method = tasks::Method::find(name);
        if (!method) throw UsageError(tasks::no_method(name));
        if (method->program() != nullptr) throw UsageError(name + " is no table of stages: cvtflow check states its limit on a scene");
        plans.push_back(method->plan());
    }
    return plans;
}

/// A scene's eigenvalues, and where methods are tried.
struct Ground {
    std::string scene;
    tasks::FrozenStart start;
    std::optional<model::Variator> variator;
    bench::Eigenvalues values;
};

Ground ground_of(const StabilityArguments& arguments) {
    const LoadedScene loaded = load_scene(arguments.scene);
    if (!loaded.notice.empty() && !arguments.quiet) print_error(loaded.notice);
    Ground ground{loaded.scene.name, settled_start(loaded.scene, arguments.scene.settle, "its eigenvalues"), {}, {}};
    ground.variator.emplace(loaded.scene.parameters);
    const int size = static_cast<int>(ground.start.state.size());
    if (!arguments.quiet) print_error(fmt::format("eigenvalues of {}", ground.scene));
    std::vector<double> matrix = jacobian(*ground.variator, ground.start.time, ground.start.state, ground.start.phases);
    ground.values = arguments.all ? bench::eigenvalues(std::move(matrix), size)
                                  : bench::extremal_eigenvalues(std::move(matrix), size, {.progress = {}}).values;
    return ground;
}

void try_on(StabilityResult& result, const Ground& ground) {
    const std::string& name = result.plan.name;
    const Extent extent = extent_of(ground.values);
    PlanLimit limit{name, largest_stable_step(result.plan, ground.values), {}};
    limit.measured = measured_stable_step(*ground.variator, result.plan, ground.start, limit.predicted.step, extent.growth);
    result.growth = bench::stage_growth(result.plan, limit.predicted.step * extent.decay);
    result.gain = bench::perturbation_gain(result.plan, limit.predicted.step * extent.decay);
    result.limit = limit;
}

std::vector<StabilityResult> analyse(const std::vector<engine::StagePlan>& plans, const StabilityArguments& arguments,
                                     const std::optional<Ground>& ground, OutputFolder& folder) {
    std::vector<StabilityResult> results;
    for (const engine::StagePlan& plan : plans) {
        if (!arguments.quiet) print_error(plan.name);
        results.push_back(stability_of(plan));
        if (ground) try_on(results.back(), *ground);
        const double step = arguments.step > 0.0 ? arguments.step : ground ? results.back().limit->predicted.step : 1.0;
        const std::string picture = fmt::format("stability-{}.svg", plan.name);
        if (folder.wants(picture))
            folder.write(picture, svg(stability_map(results.back(), ground ? ground->values : bench::Eigenvalues{}, step,
                                                    ground ? ground->scene : "")));
    }
    folder.write("stability.csv", stability_csv(results));
    return results;
}

ExitStatus stability(const StabilityArguments& arguments) {
    const std::vector<engine::StagePlan> plans = chosen(arguments);
    OutputFolder folder(arguments.output);
    std::optional<Ground> ground;
    if (!arguments.scene.scene.empty()) ground = ground_of(arguments);
    const std::string table = stability_table(analyse(plans, arguments, ground, folder));
    fmt::print("{}{}", table, folder.written());
    return ExitStatus::finished;
}

constexpr const char* stability_explanation =
    "real, imag, ray: extent of |R(z)| <= 1 along the axes and along rays of that damping ratio. With --scene also growth, gain: largest\n"
    "stage value and largest amplification of a stage's error over the scene's decays at the largest stable step; and that step, "
    "predicted\n"
    "from the eigenvalues and confirmed by steps about the state (cvtflow-lab spectrum --help). Maps show eigenvalues times the largest\n"
    "stable step, or times --step; --all includes the inner ones (one or two minutes at full detail).";

}  // namespace

Action declare_stability(CLI::App& app) {
    const auto arguments = std::make_shared<StabilityArguments>();
    app.add_option("METHOD", arguments->methods, "Tables of stages (cvtflow list methods --all)")->required()->type_name("");
    app.add_option("--scene", arguments->scene.scene, "Scene whose eigenvalues are used")->type_name("SCENE");
    declare_changes(app, arguments->scene);
    declare_fresh_start(app, arguments->scene);
    app.add_option("--step", arguments->step, "Step of the map")->type_name("SECONDS")->check(CLI::PositiveNumber);
    app.add_flag("--all", arguments->all, "Use all eigenvalues instead of the extreme ones");
    declare_output(app, arguments->output);
    app.add_flag("-q,--quiet", arguments->quiet, "No progress; results are printed all the same");
    app.footer(stability_explanation);
    return [arguments] { return stability(*arguments); };
}

}  // namespace cvtflow::bench
