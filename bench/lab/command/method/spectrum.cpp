#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "bench/lab/command/command.hpp"
#include "bench/lab/report/method/spectrum_report.hpp"
#include "bench/lab/settled_start.hpp"
#include "bench/method/analysis/eigenvalues.hpp"
#include "bench/study/spectrum.hpp"
#include "engine/method/catalogue.hpp"
#include "model/observe/observation.hpp"
#include "tasks/method/auto_step.hpp"
#include "tasks/method/method.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

struct SpectrumArguments {
    SceneArguments scene;
    OutputArguments output;
    bool extremal = false, attribute = false, quiet = false;
};

/// Reports progress on stderr.
class ProgressReporter {
public:
    explicit ProgressReporter(bool quiet) : quiet_(quiet) {}
    void operator()(const std::string& what) const {
        if (!quiet_) print_error(what);
    }

private:
    bool quiet_;
};

void find_values(SpectrumResult& result, const model::Variator& variator, const tasks::FrozenStart& start, bool extremal,
                 const ProgressReporter& report) {
    std::vector<double> matrix = jacobian(variator, start.time, start.state, start.phases);
    result.unknowns = static_cast<int>(start.state.size());
    result.complete = !extremal;
    if (!extremal) {
        if (result.unknowns > 1500)
            report(fmt::format("all {} eigenvalues: one or two minutes (--extremal: seconds)", count_text(result.unknowns)));
        result.values = bench::eigenvalues(std::move(matrix), result.unknowns);
        return;
    }
    const auto progress = [&](int dimension, int settled, int requested) {
        report(fmt::format("Krylov space of {}: {} of {} eigenvalues converged", dimension, settled, requested));
    };
    bench::ExtremalEigenvalues edge =
        bench::extremal_eigenvalues(std::move(matrix), result.unknowns, {.left_of = result.border, .progress = progress});
    result.values = std::move(edge.values);
    result.dimension = edge.dimension;
    result.residual = edge.residual;
}

/// Absent for methods that are programs.
std::optional<PlanLimit> limit_of(const SpectrumResult& result, const model::Variator& variator, const tasks::FrozenStart& start,
                                  const ProgressReporter& report) {
    if (tasks::find_program(result.method) != nullptr) return {};
    const engine::StagePlan plan = *engine::make_method(result.method);
    report(fmt::format("largest stable step of {}", result.method));
    PlanLimit limit{result.method, largest_stable_step(plan, result.values), {}};
    limit.measured = measured_stable_step(variator, plan, start, limit.predicted.step, extent_of(result.values).growth);
    return limit;
}

/// The limit that `check` states. Absent for tables of stages.
std::optional<tasks::LargestStep> program_limit_of(const tasks::Scene& scene, const model::Variator& variator,
                                                   const tasks::FrozenStart& start) {
    if (tasks::find_program(tasks::method_of(scene)) == nullptr) return {};
    tasks::AutoStep step(variator, scene.parameters, tasks::method_of(scene));
    (void)step.longest(start.time, start.state.data(), start.phases.data());
    return step.largest();
}

ExitStatus run_spectrum(const SpectrumArguments& arguments) {
    const ProgressReporter report(arguments.quiet);
    const LoadedScene loaded = load_scene(arguments.scene);
    const tasks::Scene& scene = loaded.scene;
    if (!loaded.notice.empty()) report(loaded.notice);
    const tasks::FrozenStart start = settled_start(scene, arguments.scene.settle, "its eigenvalues");
    const model::Variator variator(scene.parameters);
    SpectrumResult result;
    result.scene = scene.name;
    result.friction = model::friction_law_names[static_cast<std::size_t>(scene.parameters.detail.friction)];
    result.time = start.time;
    result.touching = touching_tips(start);
    model::Observer observer(variator);
    const model::Observation& seen = observer.observe(start.time, start.state.data(), start.phases.data());
    result.tight = seen.tight, result.slack = seen.slack;
    result.method = tasks::method_of(scene);
    result.step = scene.run.step.value_or(tasks::longest_automatic_step(result.method, scene.parameters));
    find_values(result, variator, start, arguments.extremal, report);
    result.limit = limit_of(result, variator, start, report);
    result.program_limit = program_limit_of(scene, variator, start);
    if (arguments.attribute) result.attribution = attribute(scene.parameters, start, result.border, report);
    OutputFolder folder(arguments.output);
    folder.write("spectrum.csv", spectrum_csv(result));
    folder.write("spectrum.json", spectrum_json(result));
    if (result.complete) {
        folder.write("spectrum-linear.svg", svg(spectrum_plot(result, Scale::linear)));
        folder.write("spectrum-symlog.svg", svg(spectrum_plot(result, Scale::symlog)));
    } else {
        folder.write("spectrum-edge.svg", svg(edge_plot(result)));  // in the complex plane they would be one line
    }
    if (result.attribution) folder.write("spectrum-slowed.svg", svg(slowed_plot(result)));
    fmt::print("{}{}", spectrum_text(result), folder.written());
    return ExitStatus::finished;
}

constexpr const char* spectrum_explanation =
    "Phases are fixed; the Jacobian is computed by central differences. --extremal finds the eigenvalues with Re < -1e6 1/s and the pair\n"
    "of the highest frequency, by Arnoldi's method, and draws their number over the rate of decay; the dense method finds all, drawn in "
    "the\n"
    "complex plane. The largest stable step keeps every eigenvalue inside the method's stability region. For tables of stages, steps of "
    "the\n"
    "full equations confirm it: velocities are disturbed by 1e-9 m/s, and the disturbance must not grow. For methods that are programs it "
    "is\n"
    "the one that cvtflow check states. --attribute: eigenvalues are proportional to 1/v0 of the contact that causes them, so a small\n"
    "change of v0 identifies it.";

}  // namespace

Action declare_spectrum(CLI::App& app) {
    const auto arguments = std::make_shared<SpectrumArguments>();
    declare_scene(app, arguments->scene);
    declare_shortcut(app, arguments->scene, "--state", "start.state", "FILE");
    declare_shortcut(app, arguments->scene, "--method", "run.method", "NAME");
    declare_shortcut(app, arguments->scene, "--step", "run.step", "TIME");
    declare_fresh_start(app, arguments->scene);
    app.add_flag("--extremal", arguments->extremal, "Compute extreme eigenvalues only: seconds instead of minutes");
    app.add_flag("--attribute", arguments->attribute,
                 "List the contacts that cause the eigenvalues, and the effect of ten times their saturation speed");
    declare_output(app, arguments->output);
    app.add_flag("-q,--quiet", arguments->quiet, "No progress; results are printed all the same");
    app.footer(spectrum_explanation);
    return [arguments] { return run_spectrum(*arguments); };
}

}  // namespace cvtflow::bench
