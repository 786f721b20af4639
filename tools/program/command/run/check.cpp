#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <optional>

#include "tasks/batch/batch.hpp"
#include "tasks/method/auto_step.hpp"
#include "tasks/run/run_recorder.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/units.hpp"
#include "tasks/sizing/sizing.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/program.hpp"
#include "tools/program/text/scene_text.hpp"
#include "tools/program/text/sizing_text.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

/// Number of steps over a span without transitions; the step divides the output interval.
long steps_over(double span, double interval, double step) {
    const double per_interval = std::max(1.0, std::ceil(interval / step * (1.0 - 1e-12)));
    return std::lround(std::ceil(span / interval * per_interval * (1.0 - 1e-12)));
}

std::string size_line(const model::ChainLayout& at) {
    return fmt::format("{} ({} links x {}{}), {} unknowns", plural(at.coordinates(), "coordinate"), at.links, at.link_size(),
                       at.pulley_size == 0 ? "" : fmt::format(" + pulleys {}", at.pulley_size), count_text(at.size()));
}

std::string start_line(const tasks::Scene& scene, const tasks::Simulation& simulation) {
    if (!scene.state_file.empty() && !simulation.needs_settling()) return "state file " + scene.state_file;
    const model::Start& start = scene.parameters.start;
    if (start.layout == model::StartLayout::ring) return fmt::format("geometric ring at {:.4g} rad/s", start.ring_speed);
    const std::string geometric = fmt::format("geometric at ratio {:.4g}", start.ratio);
    return simulation.needs_settling() ? fmt::format("{}, settles for {}", geometric, time_text(start.settling_time))
                                       : geometric + ", no settling";
}

/// Text, and the fault that ends the first steps, if one does.
struct Estimate {
    std::string text;
    std::string objection;
};

/// Estimated cost. A step takes one evaluation per stage, a transition one or two further steps.
/// @param step run.step, or the automatic one at the start [s]
Estimate cost_lines(const tasks::Scene& scene, const tasks::Simulation& simulation, double step) {
    const tasks::RunSettings& run = scene.run;
    const long stages = static_cast<long>(simulation.method().evaluations_per_step());
    const double until = tasks::latest_end(scene);
    const long running = steps_over(until, run.output_interval, step);
    const long settling = simulation.needs_settling() ? steps_over(scene.parameters.start.settling_time, run.output_interval, step) : 0;
    const std::string length = run.step.automatic() ? "auto, " + time_text(step) + " at the start" : time_text(step);
    std::string text = field("run", fmt::format("until {}{}, {} with step {}", run.until.automatic() ? "steady, at the latest about " : "",
                                                time_text(until), simulation.method().name(), length));
    text += field("schedule", fmt::format("{}, {}", run.schedule,
                                          run.segments == 0 ? "segments chosen automatically" : plural(run.segments, "segment")));
    text += field("steps",
                  settling == 0 ? count_text(running) : fmt::format("{} + {} for settling", count_text(running), count_text(settling)));
    text += field("evaluations", stages == 0 ? "depends on the method's iterations"
                                             : fmt::format("{}, plus transitions", count_text(stages * (running + settling))));
    const long outputs = std::lround(std::floor(until / run.output_interval * (1.0 + 1e-12))) + 1;
    const double state_interval = std::max<double>(run.state_interval, run.output_interval);
    const long states = std::lround(std::floor(until / state_interval * (1.0 + 1e-12))) + 1;
    text += field("record", fmt::format("{} every {}, {} every {}, up to {}", plural(outputs, "row"), time_text(run.output_interval),
                                        plural(states, "state"), time_text(state_interval),
                                        size_text(tasks::record_bytes(scene, simulation.workspace().variator.chain()))));
    constexpr double trial = 0.05;  // [s]
    std::string untried;
    tasks::Fault fault;
    const double wall = tasks::step_wall(scene, trial, untried, &fault);
    const std::string takes = duration_text(wall * static_cast<double>(running + settling));
    const char* about = takes.starts_with("less") ? "" : run.until.automatic() ? "at most about " : "about ";
    text += field("time", wall > 0.0 ? fmt::format("{}{} on one thread (measured on its first steps)", about, takes)
                                     : "not measured: " + untried);
    return {text, fault ? fault.message() : wall > 0.0 ? "" : untried};
}

/// The largest step at the start of the run; empty if the start has yet to settle.
std::string largest_step_line(const tasks::Scene& scene, const tasks::Simulation& simulation) {
    if (simulation.needs_settling()) return "";
    const tasks::LargestStep limit = largest_step(simulation);
    return field("stable to", tasks::text_of(limit) + (scene.run.step.value_or(0.0) > limit.step ? "; run.step exceeds this limit" : ""));
}

/// Torque from an option's text [N*m].
double torque_of(const std::string& text) {
    const auto parsed = tasks::parse_quantity(text);
    const auto* quantity = std::get_if<tasks::Quantity>(&parsed);
    constexpr double largest = 1e6;  // [N*m]
    if (quantity == nullptr || quantity->value == 0.0 || !(std::abs(quantity->value) <= largest) ||
        (quantity->has_unit && quantity->dimension != tasks::dimension_of("N*m")))
        throw UsageError(fmt::format("--for-torque {}: expected a torque, such as \"220 N*m\"", text));
    return quantity->value;
}

/// Options of `check` beside the scene.
struct CheckArguments {
    SceneArguments scene;
    std::optional<std::string> torque;  ///< torque of shaft 1
    double safety = 1.3;                ///< safety factor for `torque`
    bool json = false;
};

/// The sizing that the options ask for, with the forces of shaft 1.
tasks::Sizing sizing_of(const CheckArguments& arguments, const tasks::Scene& scene) {
    if (!(arguments.safety > 0.0)) throw UsageError("--safety: expected a positive number");
    tasks::Sizing sizing =
        arguments.torque ? tasks::size_for_torque(scene, torque_of(*arguments.torque), arguments.safety) : size_scene(scene);
    for (tasks::SizedPoint& point : sizing.points) size_driving(scene, point);
    return sizing;
}

ExitStatus check(const CheckArguments& options) {
    const SceneArguments& arguments = options.scene;
    const LoadedScene loaded = load_scene(arguments);
    const tasks::Scene& scene = loaded.scene;
    const tasks::Simulation simulation(scene);
    if (!loaded.notice.empty()) print_error(loaded.notice);
    const tasks::Sizing sizing = sizing_of(options, scene);
    const double automatic = automatic_step(simulation);
    const std::vector<std::string> outside = outside_validity(scene, sizing, automatic);
    if (options.json) {
        fmt::print("{}", sizing_json(scene, sizing, outside));
        return ExitStatus::finished;
    }
    if (options.torque) {
        if (!sizing.objection.empty()) throw UsageError(fmt::format("--for-torque: {}: {}", scene.name, sizing.objection));
        fmt::print("{}{}", machine_lines(scene), sizing_lines(scene, sizing));
        return ExitStatus::finished;
    }
    std::string text = fmt::format("{}: {}\n", scene.name, scene.description.empty() ? "no description" : scene.description);
    text += field("file", scene.path.string());
    text += field("detail", detail_text(scene));
    text += field("size", size_line(simulation.workspace().layout()));
    text += field("start", start_line(scene, simulation));
    for (const std::string& difference : simulation.start_differences()) text += field("", difference);
    const Estimate estimate = cost_lines(scene, simulation, scene.run.step.value_or(automatic));
    fmt::print("{}{}{}{}{}{}", text, machine_lines(scene), sizing_lines(scene, sizing), validity_lines(outside), estimate.text,
               largest_step_line(scene, simulation));
    if (estimate.objection.empty()) return ExitStatus::finished;
    print_error(fmt::format("{}: the run fails in its first steps: {}", scene.name, estimate.objection));
    return ExitStatus::error;
}

}  // namespace

Action declare_check(CLI::App& app) {
    const auto arguments = std::make_shared<CheckArguments>();
    SceneArguments& scene = arguments->scene;
    declare_scene(app, scene);
    declare_shortcut(app, scene, "--method", "run.method", "NAME");
    declare_shortcut(app, scene, "--step", "run.step", "TIME");
    declare_shortcut(app, scene, "--until", "run.until", "TIME");
    declare_fresh_start(app, scene);
    CLI::Option* torque = app.add_option("--for-torque", arguments->torque,
                                         "Size for this torque on shaft 1 over all ratios, instead of for the scene's tables")
                              ->type_name("TORQUE");
    app.add_option("--safety", arguments->safety, "Safety factor for that torque (default: 1.3)")->type_name("NUMBER")->needs(torque);
    app.add_flag("--json", arguments->json, "Print clamping forces and pressures as JSON");
    app.footer(
        "Exit status: 0 if the scene is valid and its first steps succeed, else 1, or 2 where options are wrong (all problems are "
        "printed).");
    return [arguments] { return check(*arguments); };
}

}  // namespace cvtflow::tools
