#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/method/catalogue.hpp"
#include "engine/method/order.hpp"
#include "tasks/frozen_step.hpp"
#include "tasks/scene/units.hpp"
#include "tools/command.hpp"
#include "tools/scene_arguments.hpp"
#include "tools/settled_start.hpp"
#include "tools/text.hpp"

namespace cvtflow::tools {

namespace {

struct LocalErrorArguments {
    SceneArguments scene;
    std::string steps = "320ns,160ns,80ns,40ns,20ns,10ns,5ns";
    std::string friction;
};

/// "80ns, 4e-8" → descending seconds.
std::vector<double> read_steps(const std::string& list) {
    std::vector<double> steps;
    for (const std::string& word : CLI::detail::split(list, ',')) {
        const auto parsed = tasks::parse_quantity(word);
        const auto* quantity = std::get_if<tasks::Quantity>(&parsed);
        const bool time = quantity != nullptr && (!quantity->has_unit || quantity->dimension == tasks::dimension_of("s"));
        if (!time || !(quantity->value > 0.0))
            throw tasks::SceneError(fmt::format("--steps {}: '{}' is not a time above 0, such as 40ns", list, word));
        steps.push_back(quantity->value);
    }
    std::sort(steps.rbegin(), steps.rend());
    return steps;
}

std::string cell(double error) { return error > 0.0 ? fmt::format("{:.3e}", error) : "0"; }

/// log(e/e')/log(h/h') between a row and the one above it.
std::string slope(double error, double above, double ratio) {
    return error > 0.0 && above > 0.0 ? fmt::format("{:.2f}", std::log(above / error) / std::log(ratio)) : "";
}

std::string error_table(const std::vector<tasks::LocalError>& errors) {
    using tasks::LocalError;
    constexpr double LocalError::*parts[] = {&LocalError::positions, &LocalError::velocities, &LocalError::axial_force,
                                             &LocalError::tension};
    const auto right = [](const char* heading) { return Table::Column{heading, Align::right}; };
    Table table({right("step"), right("positions"), right("slope"), right("velocities"), right("slope"), right("axial force"),
                 right("slope"), right("tension"), right("slope")});
    for (std::size_t i = 0; i < errors.size(); ++i) {
        std::vector<std::string> cells{time_text(errors[i].step)};
        for (const auto part : parts) {
            cells.push_back(cell(errors[i].*part));
            cells.push_back(i == 0 ? "" : slope(errors[i].*part, errors[i - 1].*part, errors[i - 1].step / errors[i].step));
        }
        table.add(cells);
    }
    return table.text(2);
}

ExitStatus local_error(const LocalErrorArguments& arguments) {
    const std::vector<double> steps = read_steps(arguments.steps);
    const LoadedScene loaded = load_scene(arguments.scene);
    const tasks::Scene& scene = loaded.scene;
    if (!loaded.notice.empty()) fmt::print(stderr, "cvtflow: {}\n", loaded.notice);
    const tasks::FrozenStart start = settled_start(scene, arguments.scene.settle, "its errors");
    const engine::StagePlan& plan = *engine::find_method(scene.run.method);
    fmt::print("{}: error of one step of {} (order {}: slope {} where the solution is smooth), phases held, {} touching\n", scene.name,
               plan.name, engine::order_of(plan), engine::order_of(plan) + 1, plural(touching_tips(start), "tip"));
    model::Parameters parameters = scene.parameters;
    for (const model::FrictionLaw law : {model::FrictionLaw::piecewise, model::FrictionLaw::smoothed}) {
        const std::string name = law == model::FrictionLaw::piecewise ? "piecewise" : "smoothed";
        const bool wanted = arguments.friction.empty() ? law == scene.parameters.detail.friction
                                                       : arguments.friction == name || arguments.friction == "both";
        if (!wanted) continue;
        parameters.detail.friction = law;
        const std::vector<tasks::LocalError> errors = tasks::local_errors(model::Variator(parameters), plan, start, steps);
        fmt::print("\n{} friction\n{}", name, error_table(errors));
    }
    return ExitStatus::finished;
}

}  // namespace

Action declare_local_error(CLI::App& app) {
    const auto arguments = std::make_shared<LocalErrorArguments>();
    declare_scene(app, arguments->scene);
    declare_shortcut(app, arguments->scene, "--method", "run.method", "NAME");
    app.add_option("--steps", arguments->steps, "Step lengths, separated by commas")->type_name("LIST")->capture_default_str();
    app.add_option("--friction", arguments->friction, "Friction law: piecewise, smoothed or both (default: the scene's)")
        ->type_name("LAW")
        ->check(CLI::IsMember({"piecewise", "smoothed", "both"}));
    declare_fresh_start(app, arguments->scene);
    app.footer(
        "Relative errors in the Euclidean norm against 32 steps of rk4 over the same time, from the scene's settled start.\n"
        "slope: of the error over the step length, between a row and the one above; where rounding is reached, it falls to 0.");
    return [arguments] { return local_error(*arguments); };
}

}  // namespace cvtflow::tools
