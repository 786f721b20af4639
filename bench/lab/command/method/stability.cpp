#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "bench/lab/command/command.hpp"
#include "bench/lab/report/method/stability_report.hpp"
#include "bench/lab/settled_start.hpp"
#include "bench/method/analysis/eigenvalues.hpp"
#include "bench/method/analysis/stability.hpp"
#include "bench/study/spectrum.hpp"
#include "tasks/method/method.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

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
