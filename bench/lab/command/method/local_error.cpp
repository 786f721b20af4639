#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "bench/lab/command/command.hpp"
#include "bench/lab/measure/settled_start.hpp"
#include "bench/lab/report/method/local_error_report.hpp"
#include "bench/method/analysis/order.hpp"
#include "bench/study/method_run.hpp"
#include "tasks/method/method.hpp"
#include "tasks/scene/units.hpp"
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
    for (const std::string& word : CLI::detail::split(list, ',')) {
        const auto parsed = tasks::parse_quantity(word);
        const auto* quantity = std::get_if<tasks::Quantity>(&parsed);
        const bool time = quantity != nullptr && (!quantity->has_unit || quantity->dimension == tasks::dimension_of("s"));
        if (!time || !(quantity->value > 0.0))
            throw UsageError(fmt::format("--steps {}: '{}' is not a time above 0, such as 40ns", list, word));
        steps.push_back(quantity->value);
    }
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

std::string heading(const std::string& scene, const std::string& method, long touching) {
    const tasks::Method found(method);
    if (const tasks::MethodProgram* program = found.program()) {
        return fmt::format("{}: error of one step of {} (order {}: slope {} where the solution is smooth), {} touching at its start\n",
                           scene, method, program->order, program->order + 1, plural(touching, "tip"));
    }
    const int order = bench::order_of(found.plan());
    return fmt::format("{}: error of one step of {} (order {}: slope {} where the solution is smooth), phases held, {} touching\n", scene,
                       method, order, order + 1, plural(touching, "tip"));
}

void write_files(OutputFolder& folder, const std::vector<ErrorCurve>& curves, const std::string& scene) {
    folder.write("local-error.csv", error_csv(curves));
    folder.write("local-error.json", error_json(curves, scene));
    for (const std::string_view name : model::friction_law_names) {
        const std::string friction(name);
        if (std::none_of(curves.begin(), curves.end(), [&](const ErrorCurve& curve) { return curve.friction == friction; })) continue;
        folder.write(fmt::format("local-error-axial-force-{}.svg", friction),
                     svg(error_plot(curves, friction, &LocalError::axial_force, "axial force of all tips", scene)));
        folder.write(fmt::format("local-error-velocities-{}.svg", friction),
                     svg(error_plot(curves, friction, &LocalError::velocities, "velocities of all links", scene)));
    }
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
    std::vector<ErrorCurve> curves;
    for (const std::string& method : methods) {
        fmt::print("{}{}", curves.empty() ? "" : "\n", heading(scene.name, method, touching_tips(start)));
        for (const auto& [law, name] : laws_of(arguments.friction, scene.parameters.detail.friction)) {
            model::Parameters parameters = scene.parameters;
            parameters.detail.friction = law;
            curves.push_back({method, name, local_errors(parameters, method, start, steps)});
            fmt::print("\n{} friction\n{}", name, error_table(curves.back().errors));
        }
    }
    OutputFolder folder(arguments.output);
    write_files(folder, curves, scene.name);
    if (!folder.written().empty()) fmt::print("\n{}", folder.written());
    return ExitStatus::finished;
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
        "Relative errors in the Euclidean norm against rk4 over the same time, in 32 steps of at most 12.5 ns, from the scene's settled "
        "start.\n"
        "slope: logarithmic slope of the error over the step length, between a row and the one above; 0 at the level of rounding.\n"
        "cut: a transition ended the step (only methods that are programs).");
    return [arguments] { return local_error(*arguments); };
}

}  // namespace cvtflow::bench
