#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "bench/lab/command/command.hpp"
#include "bench/study/method_trial.hpp"
#include "tasks/method/implicit/catalogue.hpp"
#include "tasks/method/implicit/linear_plan.hpp"
#include "tasks/run/run.hpp"
#include "tasks/scene/toml/units.hpp"
#include "tasks/tuning/relative_error.hpp"
#include "tools/program/arguments/scene_arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output/interrupt.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

struct NewtonArguments {
    SceneArguments scene;
    std::string steps = "1us,2us,4us";
    std::string duration = "100us";
    std::string reference = "12.5ns";
    std::vector<std::string> methods;
};

double time_of(const std::string& option, const std::string& word) {
    const auto parsed = tasks::parse_quantity(word);
    const auto* quantity = std::get_if<tasks::Quantity>(&parsed);
    const bool time = quantity != nullptr && (!quantity->has_unit || quantity->dimension == tasks::dimension_of("s"));
    if (!time || !(quantity->value > 0.0)) throw UsageError(fmt::format("{} {}: not a time above 0, such as 2us", option, word));
    return quantity->value;
}

/// All variants of Newton's method, then the linearly implicit methods.
std::vector<std::string> all_methods() {
    std::vector<std::string> names;
    for (const tasks::NewtonVariant& variant : tasks::newton_variants()) names.emplace_back(variant.name);
    for (const tasks::LinearPlan& plan : tasks::linear_plans()) names.push_back(plan.name);
    return names;
}

tasks::FrozenStart start_of(const tasks::Scene& scene) {
    tasks::Simulation simulation(scene);
    if (simulation.needs_settling()) {
        print_error(fmt::format("settling {} first", time_text(scene.parameters.start.settling_time)));
        tasks::SilentObserver nobody;
        if (const tasks::Fault fault = simulation.advance({.until = 0.0}, nobody, catch_interrupts())) throw tasks::SettlingFault(fault);
    }
    return tasks::frozen_start(simulation);
}

std::vector<std::string> cells_of(const std::string& method, const TrialEnd& end, const TrialEnd& reference, double duration) {
    std::vector<std::string> cells{method, time_text(end.step)};
    if (end.newton) {
        const tasks::NewtonStatistics& n = *end.newton;
        const double steps = static_cast<double>(std::max(1L, n.steps));
        cells.insert(cells.end(), {fmt::format("{:.2f}", static_cast<double>(n.iterations) / steps), std::to_string(n.most),
                                   fmt::format("{:.2f}", static_cast<double>(n.jacobians) / steps),
                                   fmt::format("{:.2f}", static_cast<double>(n.backtracks) / steps),
                                   fmt::format("{} / {}", n.refreshed, n.steps), fmt::format("{} / {}", n.unconverged, n.steps)});
    } else {
        cells.insert(cells.end(), {"", "", "", "", "", ""});
    }
    cells.push_back(fmt::format("{:.0f}", end.wall / duration));
    if (end.fault) {
        cells.insert(cells.end(), {"-", "-"});
    } else {
        cells.push_back(fmt::format("{:.1e}", tasks::relative_error(end.axial_force, reference.axial_force)));
        cells.push_back(fmt::format("{:.1e}", tasks::relative_error(end.tension, reference.tension)));
    }
    return cells;
}

ExitStatus newton(const NewtonArguments& arguments) {
    const double duration = time_of("--duration", arguments.duration), tight = time_of("--reference", arguments.reference);
    std::vector<double> steps;
    for (const std::string& word : CLI::detail::split(arguments.steps, ',')) steps.push_back(time_of("--steps", word));
    const std::vector<std::string> methods = arguments.methods.empty() ? all_methods() : arguments.methods;
    for (const std::string& method : methods) require_method(method);
    const LoadedScene loaded = load_scene(arguments.scene);
    if (!loaded.notice.empty()) print_error(loaded.notice);
    const model::Parameters& parameters = loaded.scene.parameters;
    const tasks::FrozenStart start = start_of(loaded.scene);
    const TrialEnd reference = try_method(parameters, start, "rk4", tight, duration);
    if (reference.fault) throw tasks::SceneError(fmt::format("--reference {}: {}", arguments.reference, reference.fault.message()));
    fmt::print("{}: {} against rk4 with {}, with transitions ({}), one thread\n\n", loaded.scene.name, time_text(duration),
               time_text(reference.step), plural(reference.counters.detected, "transition"));
    const auto right = [](const char* heading) { return Table::Column{heading, Align::right}; };
    Table table({{"method", Align::left},
                 right("step"),
                 right("iterations"),
                 right("most"),
                 right("Jacobians"),
                 right("halvings"),
                 right("fell back"),
                 right("unconverged"),
                 right("s per s"),
                 right("axial force"),
                 right("tension")});
    for (const std::string& method : methods) {
        for (const double step : steps) {
            const TrialEnd end = try_method(parameters, start, method, step, duration);
            table.add(cells_of(method, end, reference, duration));
            if (end.fault) print_error(fmt::format("{} with {}: {}", method, time_text(step), end.fault.message()));
        }
    }
    fmt::print("{}", table.text(2));
    return ExitStatus::finished;
}

}  // namespace

Action declare_newton(CLI::App& app) {
    const auto arguments = std::make_shared<NewtonArguments>();
    declare_scene(app, arguments->scene);
    app.add_option("--steps", arguments->steps, "Step lengths, separated by commas")->type_name("LIST")->capture_default_str();
    app.add_option("--duration", arguments->duration, "Simulated time of each trial")->type_name("TIME")->capture_default_str();
    app.add_option("--reference", arguments->reference, "Step of rk4 that errors are measured against")
        ->type_name("TIME")
        ->capture_default_str();
    app.add_option("--methods", arguments->methods, "Methods to compare (default: all of both kinds)")->type_name("LIST")->delimiter(',');
    declare_fresh_start(app, arguments->scene);
    app.footer(
        "Iterations, Jacobians and halvings: per step of the trapezoidal rule. fell back: steps that needed an additional Jacobian;\n"
        "unconverged: steps that used the best iterate. s per s: wall seconds per simulated second. Errors: relative, of the axial forces\n"
        "of all tips and the tensions of all links at the end.");
    return [arguments] { return newton(*arguments); };
}

}  // namespace cvtflow::bench
