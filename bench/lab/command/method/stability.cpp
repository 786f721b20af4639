#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/lab/command/command.hpp"
#include "bench/lab/command/method/limit.hpp"
#include "bench/lab/settled_start.hpp"
#include "bench/lab/show.hpp"
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

double ray(const engine::StagePlan& plan, double damping) {
    return bench::stability_reach(plan, {-damping, std::sqrt(1.0 - damping * damping)}, 1e-6);
}

/// Values between two ends, equally spaced in the picture: those of a symlog axis, linear up to 1, or of a linear one.
std::vector<double> places(double from, double to, bool symlog) {
    constexpr int count = 320;
    const auto placed = [&](double value) {
        const double size = std::abs(value);
        return symlog && size > 1.0 ? std::copysign(1.0 + std::log10(size), value) : value;
    };
    const auto value_at = [&](double place) {
        const double size = std::abs(place);
        return symlog && size > 1.0 ? std::copysign(std::pow(10.0, size - 1.0), place) : place;
    };
    const double first = placed(from), last = placed(to);
    std::vector<double> all;
    for (int k = 0; k < count; ++k) all.push_back(value_at(first + (last - first) * k / (count - 1)));
    return all;
}

/// |R(z)| ≤ 1, and the eigenvalues times the step. @param values may be empty   @param step [s]
Json stability_map(const engine::StagePlan& plan, double real, double imaginary, const Eigenvalues& values, double step) {
    const double reach = std::max({real, 1.0, step * extent_of(values).decay});
    double half = std::max({imaginary, ray(plan, 0.05), step * extent_of(values).oscillation, 1.0});
    const auto factor = bench::stability_function(plan);
    const auto stable = [factor](double x, double y) { return std::abs(factor({x, y})) <= 1.0; };
    for (double x = -reach; x < -1e-3; x *= 0.9) {
        while (half < 100.0 && stable(x, 1.05 * half)) half *= 1.1;  // shows the widest part completely
    }
    const bool symlog = reach > 20.0;
    const std::vector<double> x = places(-1.3 * reach, std::min(2.0, 0.3 * reach), symlog), y = places(-1.15 * half, 1.15 * half, false);
    Json inside = Json::array();
    for (const double up : y) {
        std::string row;
        for (const double across : x) row += stable(across, up) ? '1' : '0';
        inside.push_back(std::move(row));
    }
    Eigenvalues damped, growing;
    for (const auto& value : values) {
        const auto z = step * value;
        const bool grows = std::log(std::abs(factor(z))) / step > std::max(value.real(), 0.0) + growth_rate_tolerance;
        (grows ? growing : damped).push_back(z);
    }
    return named("x,y,symlog,inside,values,growing,step", {x, y, symlog, inside, values_json(damped), values_json(growing), step});
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
    say(arguments.quiet, loaded.notice);
    Ground ground{loaded.scene.name, settled_start(loaded.scene, arguments.scene.settle, "its eigenvalues"), {}, {}};
    ground.variator.emplace(loaded.scene.parameters);
    const int size = static_cast<int>(ground.start.state.size());
    say(arguments.quiet, fmt::format("eigenvalues of {}", ground.scene));
    std::vector<double> matrix = jacobian(*ground.variator, ground.start.time, ground.start.state, ground.start.phases);
    ground.values = arguments.all ? bench::eigenvalues(std::move(matrix), size)
                                  : bench::extremal_eigenvalues(std::move(matrix), size, {.progress = {}}).values;
    return ground;
}

/// A method's reach along the axes and along rays of damping ratio 1 % and 5 %; on a scene also its limit, and the growth of its stages and
/// of their errors over the scene's decays at that limit. "row": of stability.csv.
Json stability_of(const engine::StagePlan& plan, const StabilityArguments& arguments, const std::optional<Ground>& ground) {
    const double real = bench::real_stability(plan), imaginary = bench::imaginary_stability(plan);
    Json row = named(
        "method,stages,real,imaginary,ray_1,ray_5,stage_growth,gain,predicted,limiting_real,limiting_imaginary,measured_stable,"
        "measured_unstable",
        {plan.name, plan.stages.size(), real, imaginary, ray(plan, 0.01), ray(plan, 0.05), {}, {}, {}, {}, {}, {}, {}});
    Json result;
    double step = 1.0;
    if (ground) {
        const Json limit = limit_json(plan, ground->values, *ground->variator, ground->start);
        step = limit["predicted"];
        const double decay = step * extent_of(ground->values).decay;
        row["stage_growth"] = bench::stage_growth(plan, decay);
        row["gain"] = bench::perturbation_gain(plan, decay);
        for (const char* key : {"predicted", "measured_stable", "measured_unstable"}) row[key] = limit[key];
        row["limiting_real"] = limit["limiting"][0], row["limiting_imaginary"] = limit["limiting"][1];
        result["limit"] = limit;
    }
    result["row"] = std::move(row);
    if (arguments.step > 0.0) step = arguments.step;
    if (arguments.output.wants_pictures())
        result["map"] = stability_map(plan, real, imaginary, ground ? ground->values : Eigenvalues{}, step);
    return result;
}

ExitStatus stability(const StabilityArguments& arguments) {
    const std::vector<engine::StagePlan> plans = chosen(arguments);
    std::optional<Ground> ground;
    if (!arguments.scene.scene.empty()) ground = ground_of(arguments);
    Json methods = Json::array();
    for (const engine::StagePlan& plan : plans) {
        say(arguments.quiet, plan.name);
        methods.push_back(stability_of(plan, arguments, ground));
    }
    show("stability", {{"scene", ground ? ground->scene : ""}, {"methods", std::move(methods)}}, arguments.output);
}

constexpr const char* stability_explanation =
    "real, imag, ray: extent of |R(z)| <= 1 along the axes and along rays of that damping ratio. With --scene also growth, gain: largest\n"
    "stage value and largest amplification of a stage's error over the scene's decays at the largest stable step; and that step,\n"
    "predicted from the eigenvalues and confirmed by steps about the state (cvtflow-lab spectrum --help). Maps show eigenvalues times the\n"
    "largest stable step, or times --step; --all includes the inner ones (one or two minutes at full detail).";

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
