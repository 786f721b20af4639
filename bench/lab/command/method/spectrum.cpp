#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>

#include "bench/lab/command/command.hpp"
#include "bench/lab/command/method/limit.hpp"
#include "bench/lab/settled_start.hpp"
#include "bench/lab/show.hpp"
#include "bench/method/analysis/eigenvalues.hpp"
#include "bench/method/family/fitted.hpp"
#include "bench/study/spectrum.hpp"
#include "engine/method/catalogue.hpp"
#include "model/observe/observation.hpp"
#include "tasks/method/auto_step.hpp"
#include "tasks/method/method.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/report_columns.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

struct SpectrumArguments {
    SceneArguments scene;
    OutputArguments output;
    bool extremal = false, attribute = false, quiet = false;
};

using Report = std::function<void(const std::string&)>;  // progress, on stderr

constexpr double border = -1e6;  ///< real part left of which --extremal finds eigenvalues, and they are attributed [1/s]

/// The eigenvalues: all, or those at the edge, of which "dimension" and "residual" say how they were found.
Eigenvalues find_values(Json& results, std::vector<double> matrix, int unknowns, bool extremal, const Report& report) {
    if (!extremal) {
        if (unknowns > 1500) report(fmt::format("all {} eigenvalues: one or two minutes (--extremal: seconds)", count_text(unknowns)));
        return eigenvalues(std::move(matrix), unknowns);
    }
    const auto progress = [&](int dimension, int settled, int requested) {
        report(fmt::format("Krylov space of {}: {} of {} eigenvalues converged", dimension, settled, requested));
    };
    ExtremalEigenvalues edge = extremal_eigenvalues(std::move(matrix), unknowns, {.left_of = border, .progress = progress});
    results["dimension"] = edge.dimension;
    results["residual"] = edge.residual;
    return std::move(edge.values);
}

Json extent_json(const Extent& extent) {
    return named("max_decay,max_oscillation,below_1e6,below_1e7", {extent.decay, extent.oscillation, extent.below_1e6, extent.below_1e7});
}

/// The largest stable step: of a table of stages, predicted and measured; else the one that `check` states.
void add_limit(Json& results, const tasks::Scene& scene, const model::Variator& variator, const tasks::FrozenStart& start,
               const Eigenvalues& values, const Report& report) {
    const std::string method = tasks::method_of(scene);
    Json& limit = results["file"]["stable_step"];
    if (tasks::find_program(method) == nullptr) {
        report(fmt::format("largest stable step of {}", method));
        limit = limit_json(*engine::make_method(method), values, variator, start);
        return;
    }
    tasks::AutoStep step(variator, scene.parameters, method);
    (void)step.longest(start.time, start.state.data(), start.phases.data());
    limit = {{"method", method}, {"stated", step.largest().step}, {"rate", step.largest().rate}};  // an infinite step is null
    results["stated"] = tasks::text_of(step.largest());
}

void add_attribution(Json& file, const Attribution& attribution) {
    for (const SlowedSpectrum& spectrum : attribution.slowed) {
        Json row = extent_json(extent_of(spectrum.values));
        row["contacts"] = spectrum.contacts;
        row["eigenvalues"] = values_json(spectrum.values);
        file["slowed_tenfold"].push_back(std::move(row));
    }
    file["shares"] = attribution.shares;
}

/// Name of the cheapest polynomial for a step; empty: none is fitted to it.
std::string polynomial_for(const Extent& extent, double step) {
    constexpr double margin = 1.2;  // of a step's fit, as run.method = "fitted" takes
    const double real = margin * extent.decay * step, imaginary = margin * extent.oscillation * step;
    const bool fits = real >= min_fitted_real && real <= max_fitted_real && imaginary <= max_fitted_imaginary;
    return fits ? fmt::format("fitted-l{:.4g}-w{:.4g}", real, imaginary) : "";
}

ExitStatus run_spectrum(const SpectrumArguments& arguments) {
    const Report report = [&](const std::string& what) { say(arguments.quiet, what); };
    const LoadedScene loaded = load_scene(arguments.scene);
    const tasks::Scene& scene = loaded.scene;
    report(loaded.notice);
    const tasks::FrozenStart start = settled_start(scene, arguments.scene.settle, "its eigenvalues");
    const model::Variator variator(scene.parameters);
    model::Observer observer(variator);
    const model::Observation& seen = observer.observe(start.time, start.state.data(), start.phases.data());
    const std::string method = tasks::method_of(scene);
    const double step = scene.run.step.value_or(tasks::longest_automatic_step(method, scene.parameters));
    const int unknowns = static_cast<int>(start.state.size());
    Json results{{"border", border}, {"growth_tolerance", growth_rate_tolerance}};
    for (const ContactKind& kind : contact_kinds()) results["kinds"].push_back(kind.name);
    const Eigenvalues values =
        find_values(results, jacobian(variator, start.time, start.state, start.phases), unknowns, arguments.extremal, report);
    const Extent extent = extent_of(values);
    results["polynomial"] = polynomial_for(extent, step);
    results["file"] = named(
        "scene,provenance,time,friction,touching,unknowns,complete,tight_tension,slack_tension,extent",
        {scene.name, provenance_json(), start.time, model::friction_law_names[static_cast<std::size_t>(scene.parameters.detail.friction)],
         touching_tips(start), unknowns, !arguments.extremal, seen.tight, seen.slack, extent_json(extent)});
    Json& file = results["file"];
    if (!arguments.extremal) file["growth"] = {{"growing", extent.growing}, {"largest", extent.growth}};
    file["method"] = method;
    file["step"] = step;
    add_limit(results, scene, variator, start, values, report);
    file["eigenvalues"] = values_json(values);
    if (arguments.attribute) add_attribution(file, attribute(scene.parameters, start, border, report));
    show("spectrum", std::move(results), arguments.output);
}

constexpr const char* spectrum_explanation =
    "Phases are fixed; the Jacobian is computed by central differences. --extremal finds the eigenvalues with Re < -1e6 1/s and the pair\n"
    "of the highest frequency, by Arnoldi's method, and draws their number over the rate of decay; the dense method finds all, drawn in\n"
    "the complex plane. The largest stable step keeps every eigenvalue inside the method's stability region. For tables of stages, steps\n"
    "of the full equations confirm it: velocities are disturbed by 1e-9 m/s, and the disturbance must not grow. For methods that are\n"
    "programs it is the one that cvtflow check states. --attribute: eigenvalues are proportional to 1/v0 of the contact that causes them,\n"
    "so a small change of v0 identifies it.";

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
