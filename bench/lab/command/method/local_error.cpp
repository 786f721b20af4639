/// cvtflow-lab local-error: errors of single steps.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "bench/lab/choice.hpp"
#include "bench/lab/command/command.hpp"
#include "bench/lab/settled_start.hpp"
#include "bench/lab/show.hpp"
#include "bench/method/analysis/order.hpp"
#include "bench/study/method_run.hpp"
#include "bench/study/stability/frozen_step.hpp"
#include "tasks/method/method.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

struct LocalErrorArguments {
    SceneArguments scene;
    OutputArguments output;
    std::string steps = "320ns,160ns,80ns,40ns,20ns,10ns,5ns";
    std::vector<std::string> methods;
    std::string friction;
};

/// "80ns, 4e-8" → descending seconds.
std::vector<double> read_steps(const std::string& list) {
    std::vector<double> steps;
    for (const std::string& word : CLI::detail::split(list, ',')) steps.push_back(read_time("--steps " + list, word));
    std::sort(steps.rbegin(), steps.rend());
    return steps;
}

/// Friction laws to measure with, by their names.
std::vector<std::pair<model::FrictionLaw, std::string>> laws_of(const std::string& asked, model::FrictionLaw of_scene) {
    std::vector<std::pair<model::FrictionLaw, std::string>> chosen;
    for (std::size_t number = 0; number < model::friction_law_names.size(); ++number) {
        const auto law = static_cast<model::FrictionLaw>(number);
        const std::string name(model::friction_law_names[number]);
        if (asked.empty() ? law == of_scene : asked == name || asked == "both") chosen.emplace_back(law, name);
    }
    return chosen;
}

/// The errors of one method under one friction law, by descending step; null: a transition ended the step.
Json curve_of(const std::string& method, const std::string& friction, const std::vector<LocalError>& errors) {
    const tasks::Method found(method);
    const tasks::MethodProgram* program = found.program();
    Json rows = Json::array();
    for (const LocalError& error : errors)
        rows.push_back(
            named("step,positions,velocities,axial_force,tension", {error.step, number_json(error.positions), number_json(error.velocities),
                                                                    number_json(error.axial_force), number_json(error.tension)}));
    return named("method,friction,order,held,errors",  // held: phases
                 {method, friction, program != nullptr ? program->order : order_of(found.plan()), program == nullptr, rows});
}

ExitStatus local_error(const LocalErrorArguments& arguments) {
    const std::vector<double> steps = read_steps(arguments.steps);
    const LoadedScene loaded = load_scene(arguments.scene);
    const tasks::Scene& scene = loaded.scene;
    if (!loaded.notice.empty()) print_error(loaded.notice);
    std::vector<std::string> methods = arguments.methods;
    for (const std::string& method : methods) require_method(method);
    if (methods.empty()) methods.push_back(tasks::method_of(scene));
    const tasks::FrozenStart start = settled_start(scene, arguments.scene.settle, "its errors");
    Json curves = Json::array();
    for (const std::string& method : methods) {
        for (const auto& [law, name] : laws_of(arguments.friction, scene.parameters.detail.friction)) {
            model::Parameters parameters = scene.parameters;
            parameters.detail.friction = law;
            curves.push_back(curve_of(method, name, local_errors(parameters, method, start, steps)));
        }
    }
    show("local_error", {{"scene", scene.name}, {"touching", touching_tips(start)}, {"curves", std::move(curves)}}, arguments.output);
}

}  // namespace

Action declare_local_error(CLI::App& app) {
    const auto arguments = std::make_shared<LocalErrorArguments>();
    declare_scene(app, arguments->scene);
    declare_shortcut(app, arguments->scene, "--method", "run.method", "NAME");
    app.add_option("--methods", arguments->methods, "Methods, separated by commas")->type_name("LIST")->delimiter(',');
    app.add_option("--steps", arguments->steps, "Step lengths, separated by commas")->type_name("LIST")->capture_default_str();
    std::vector<std::string> names(model::friction_law_names.begin(), model::friction_law_names.end());
    names.emplace_back("both");
    app.add_option("--friction", arguments->friction, "Friction law: piecewise, smoothed or both (default: the scene's)")
        ->type_name("LAW")
        ->check(CLI::IsMember(names));
    declare_fresh_start(app, arguments->scene);
    declare_output(app, arguments->output);
    app.footer(
        "Relative errors in the Euclidean norm against rk4 over the same time, in 32 steps of at most 12.5 ns, from the settled start.\n"
        "slope: logarithmic slope of the error over the step length, between a row and the one above; 0 at the level of rounding.\n"
        "cut: a transition ended the step (only methods that are programs).");
    return [arguments] { return local_error(*arguments); };
}

}  // namespace cvtflow::bench
