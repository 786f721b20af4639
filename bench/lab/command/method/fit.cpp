#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>

#include "bench/lab/command/command.hpp"
#include "bench/lab/text/text.hpp"
#include "bench/method/family/fitted.hpp"
#include "bench/study/run_watch.hpp"
#include "bench/study/spectrum.hpp"
#include "tasks/method/auto_step.hpp"
#include "tasks/method/spectral_bound.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/step/integration_state.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

struct FitArguments {
    SceneArguments scene;
    int order = 3;
    double ripple = 0.2;
    double margin = 1.2;
    bool eigenvalues = false;
};

struct FitExtent {
    double real, imaginary;
    std::vector<std::complex<double>> eigenvalues;
};

FitExtent extent_by_power_iteration(const model::Variator& variator, const tasks::FrozenStart& start) {
    tasks::SpectralBound bound(variator);
    const int evaluations = bound.estimate(start.time, start.state.data(), start.phases.data());
    fmt::print("{}",
               field("spectrum", fmt::format("friction to -{:.4g} 1/s, elasticity to {:.4g} rad/s, by power iteration ({} evaluations)",
                                             bound.real(), bound.imaginary(), evaluations)));
    return {bound.real(), bound.imaginary(), {}};
}

FitExtent extent_by_eigenvalues(const model::Variator& variator, const tasks::FrozenStart& start) {
    FitExtent extent{0.0, 0.0, bench::spectrum(variator, start.time, start.state, start.phases)};
    for (const auto& value : extent.eigenvalues) {
        extent.real = std::max(extent.real, -value.real());
        extent.imaginary = std::max(extent.imaginary, std::abs(value.imag()));
    }
    fmt::print("{}", field("spectrum", fmt::format("to -{:.4g} 1/s, {:.4g} rad/s, all {} eigenvalues", extent.real, extent.imaginary,
                                                   extent.eigenvalues.size())));
    return extent;
}

std::optional<bench::FittedMethod> fitted(const FitArguments& arguments, const FitExtent& extent, double step) {
    const bench::FitRequest request{std::max(arguments.margin * extent.real * step, bench::min_fitted_real),
                                    arguments.margin * extent.imaginary * step, arguments.order, arguments.ripple, 0.01};
    if (extent.eigenvalues.empty()) return bench::fit(request);
    std::vector<std::complex<double>> points;
    for (const auto& value : extent.eigenvalues) points.push_back(arguments.margin * step * value);
    return bench::fit(request, points);
}

ExitStatus run_fit(const FitArguments& arguments) {
    const LoadedScene loaded = load_scene(arguments.scene);
    const tasks::Simulation simulation(loaded.scene);
    if (simulation.needs_settling())
        throw tasks::SceneError(
            fmt::format("{}: the start is not settled, so its spectrum is meaningless (cvtflow settle)", loaded.scene.name));
    const tasks::FrozenStart start = frozen_start(simulation);
    const double step = loaded.scene.run.step.value_or(tasks::longest_automatic_step(simulation.method().name(), loaded.scene.parameters));
    fmt::print("{}: polynomial for steps of {}\n", loaded.scene.name, time_text(step));
    const FitExtent extent = arguments.eigenvalues ? extent_by_eigenvalues(simulation.workspace().variator, start)
                                                   : extent_by_power_iteration(simulation.workspace().variator, start);
    const auto began = std::chrono::steady_clock::now();
    const auto method = fitted(arguments, extent, step);
    const double milliseconds = 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    if (!method)
        throw tasks::SceneError(
            fmt::format("no polynomial of up to {} stages is stable for steps of {}", bench::max_fitted_stages, time_text(step)));
    const auto stages = method->plan.stages.size() - 1;
    fmt::print("{}", field("fit", fmt::format("{} stages, {} iterations, largest |R|/bound {:.4f}, {:.1f} ms", stages, method->iterations,
                                              method->largest, milliseconds)));
    fmt::print("{}", field("cost", fmt::format("{:.3g} evaluations per simulated second", static_cast<double>(stages) / step)));
    if (!arguments.eigenvalues) {
        fmt::print("{}", field("name", fmt::format("fitted-l{:.4g}-w{:.4g}{}{}", arguments.margin * extent.real * step,
                                                   arguments.margin * extent.imaginary * step, arguments.order == 2 ? "-p2" : "",
                                                   arguments.ripple == 0.2 ? "" : fmt::format("-r{:g}", arguments.ripple))));
    }
    fmt::print("{}", method_figures(method->plan, arguments.margin * extent.real * step));
    return ExitStatus::finished;
}

}  // namespace

Action declare_fit(CLI::App& app) {
    const auto arguments = std::make_shared<FitArguments>();
    declare_scene(app, arguments->scene);
    declare_shortcut(app, arguments->scene, "--step", "run.step", "TIME");
    app.add_option("--order", arguments->order, "Order of the method")->check(CLI::IsMember({2, 3}))->capture_default_str();
    app.add_option("--ripple", arguments->ripple, "|R| allowed along the real axis")->check(CLI::Range(0.01, 1.0))->capture_default_str();
    app.add_option("--margin", arguments->margin, "Factor on the measured spectrum")->check(CLI::Range(1.0, 10.0))->capture_default_str();
    app.add_flag("--eigenvalues", arguments->eigenvalues,
                 "Fit to all eigenvalues instead of their bounding region (minutes at full detail)");
    app.footer(
        "Measures the spectrum at the scene's settled start and fits the cheapest stability polynomial to it, on RKC's recurrence.\n"
        "The printed name denotes the method without a scene: cvtflow-lab method fitted-l200-w2. run.method = \"fitted\" repeats the fit "
        "during a run.");
    return [arguments] { return run_fit(*arguments); };
}

}  // namespace cvtflow::bench
