/// cvtflow-lab local-error: local errors as text, CSV and pictures.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "bench/lab/command/command.hpp"
#include "bench/lab/plot/plot.hpp"
#include "bench/lab/settled_start.hpp"
#include "bench/method/analysis/order.hpp"
#include "bench/study/method_run.hpp"
#include "bench/study/stability/frozen_step.hpp"
#include "tasks/method/method.hpp"
#include "tasks/scene/units.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

/// One method under one friction law.
struct ErrorCurve {
    std::string method;
    std::string friction;            ///< "piecewise" or "smoothed"
    std::vector<LocalError> errors;  ///< errors by descending step; NaN: a transition ended the step
};

constexpr std::array parts{&LocalError::positions, &LocalError::velocities, &LocalError::axial_force, &LocalError::tension};

std::string error_text(double error) {
    if (std::isnan(error)) return "cut";
    return error > 0.0 ? fmt::format("{:.3e}", error) : "0";
}

/// log(e/e')/log(h/h') between a row and the one above it.
std::string slope(double error, double above, double ratio) {
    return error > 0.0 && above > 0.0 ? fmt::format("{:.2f}", std::log(above / error) / std::log(ratio)) : "";
}

/// A row per step, errors of the four parts with their slopes.
std::string error_table(const std::vector<LocalError>& errors) {
    const auto right = [](const char* heading) { return Table::Column{heading, Align::right}; };
    Table table({right("step"), right("positions"), right("slope"), right("velocities"), right("slope"), right("axial force"),
                 right("slope"), right("tension"), right("slope")});
    for (std::size_t i = 0; i < errors.size(); ++i) {
        std::vector<std::string> cells{time_text(errors[i].step)};
        for (const auto part : parts) {
            cells.push_back(error_text(errors[i].*part));
            cells.push_back(i == 0 ? "" : slope(errors[i].*part, errors[i - 1].*part, errors[i - 1].step / errors[i].step));
        }
        table.add(cells);
    }
    return table.text(2);
}

/// A row per method and step.
std::string error_csv(const std::vector<ErrorCurve>& curves) {
    std::string text = "method,friction,step,positions,velocities,axial_force,tension\n";
    for (const ErrorCurve& curve : curves) {
        for (const LocalError& error : curve.errors) {
            text += fmt::format("{},{},{:.17g}", curve.method, curve.friction, error.step);
            for (const auto part : parts) text += std::isnan(error.*part) ? "," : fmt::format(",{:.9g}", error.*part);
            text += "\n";
        }
    }
    return text;
}

/// One part of all methods under one friction law, against the step, both logarithmic. @param name of the part, as in the title
Plot error_plot(const std::vector<ErrorCurve>& curves, const std::string& friction, double LocalError::*part, const std::string& name,
                const std::string& scene) {
    static constexpr std::array marks{Mark::dot, Mark::ring, Mark::square, Mark::diamond, Mark::triangle, Mark::cross};
    Plot plot;
    plot.title = fmt::format("Error of one step: {}", name);
    plot.subtitle = fmt::format("{}, {} friction, relative to tight rk4", scene, friction);
    plot.x = {"step [s]", Scale::logarithmic, 1.0, {}, {}};
    plot.y = {"relative error", Scale::logarithmic, 1.0, {}, {}};
    for (const ErrorCurve& curve : curves) {
        if (curve.friction != friction) continue;
        Series series{curve.method, {}, marks[plot.series.size() % marks.size()], Line::solid, ""};
        for (const LocalError& error : curve.errors)
            series.points.push_back({error.step, std::isfinite(error.*part) && error.*part < 1e6 ? error.*part : NAN});
        plot.series.push_back(std::move(series));
    }
    return plot;
}

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
