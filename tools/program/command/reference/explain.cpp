#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>

#include "tasks/batch/sweep/sweep_keys.hpp"
#include "tasks/method/automatic_method.hpp"
#include "tasks/method/stability/predicted_step.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tools/program/arguments/scene_arguments.hpp"
#include "tools/program/command/command.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

/// A section stands for all its keys.
std::vector<std::string> keys_of(const std::string& word) {
    std::vector<std::string> keys;
    for (const tasks::Parameter& parameter : tasks::parameter_table()) {
        if (parameter.section() == word) keys.emplace_back(parameter.key);
    }
    return keys.empty() ? std::vector{word} : keys;
}

struct ExplainArguments {
    std::vector<std::string> words;
    SceneArguments scene;
};

/// How far the scene's method is stable at the state that its runs begin with, and the step that is chosen there.
std::string step_lines(const tasks::Scene& scene) {
    const tasks::Simulation simulation(scene);
    if (simulation.needs_settling()) return "  stable:   known once it has settled (cvtflow settle)\n";
    const tasks::StepLimit limit =
        tasks::predicted_step_limit(simulation.variator(), scene.parameters, simulation.method_name(), tasks::frozen_start(simulation));
    const std::string chosen = scene.run.step.automatic()
                                   ? fmt::format("  auto is:  {} at the start\n", time_text(simulation.automatic_step()))
                                   : std::string(scene.run.step > limit.step ? "  warning:  run.step is beyond\n" : "");
    return fmt::format("  stable:   {} with {} up to {}\n{}", scene.name, simulation.method_name(), tasks::text_of(limit), chosen);
}

std::string scene_lines(const std::string& key, const tasks::Scene& scene) {
    const tasks::Parameter& parameter = *tasks::find_parameter(key);
    std::string text = fmt::format("  here:     {} in {}\n", tasks::readable_value(parameter, scene), scene.name);
    if (key == "run.method" && scene.run.method == tasks::automatic_method)
        text += fmt::format("  auto is:  {}\n", tasks::method_of(scene));
    if (key == "run.step" || key == "run.method") text += step_lines(scene);
    return text;
}

ExitStatus explain(const ExplainArguments& arguments) {
    std::optional<LoadedScene> loaded;
    if (!arguments.scene.scene.empty()) loaded = load_scene(arguments.scene);
    std::string text;
    for (const std::string& word : arguments.words) {
        if (tasks::names_sweep(word)) {
            text += (text.empty() ? "" : "\n") + tasks::explain_sweep(word);
            continue;
        }
        for (const std::string& key : keys_of(word)) {
            text += (text.empty() ? "" : "\n") + tasks::explain(key);
            if (loaded) text += scene_lines(key, loaded->scene);
        }
    }
    fmt::print("{}", text);
    return ExitStatus::finished;
}

}  // namespace

Action declare_explain(CLI::App& app) {
    const auto arguments = std::make_shared<ExplainArguments>();
    app.add_option("KEY", arguments->words,
                   "Key such as tip.radius, or a section such as tip for all its keys; of sweep files sweep.axes.key, sweep.axes, sweep")
        ->required()
        ->type_name("");
    app.add_option("--scene", arguments->scene.scene, "What the key is in this scene; with run.step, how far its method is stable there")
        ->type_name("SCENE");
    declare_changes(app, arguments->scene);
    return [arguments] { return explain(*arguments); };
}

}  // namespace cvtflow::tools
