#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>

#include "tasks/batch/sweep/sweep_keys.hpp"
#include "tasks/channel/channels.hpp"
#include "tasks/method/automatic_method.hpp"
#include "tasks/run/run_means.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/command/command.hpp"
#include "tools/program/command/reference/terms.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

/// A section is replaced by all its keys.
std::vector<std::string> keys_of(const std::string& word) {
    std::vector<std::string> keys;
    for (const tasks::Parameter& parameter : tasks::parameter_table()) {
        if (parameter.section() == word) keys.emplace_back(parameter.key);
    }
    return keys.empty() ? std::vector{word} : keys;
}

/// Meaning of a word that is no key: a term, a channel or a note. Empty if it is none.
std::string meaning_of(std::string_view word) {
    if (const auto* term = std::ranges::find(terms, word, &Term::word); term != std::end(terms))
        return fmt::format("{}\n  {}\n", term->word, term->meaning);
    const auto channels = tasks::channels();
    if (const auto channel = std::ranges::find(channels, word, &tasks::Channel::name); channel != channels.end())
        return fmt::format("{}\n  {}\n  channel of records; unit: {}\n", channel->name, channel->description, channel->unit);
    const auto notes = tasks::note_kinds();
    if (const auto note = std::ranges::find(notes, word, &tasks::NoteKind::name); note != notes.end())
        return fmt::format("{}\n  {}\n  note of runs and cases\n", note->name, note->meaning);
    return {};
}

struct ExplainArguments {
    std::vector<std::string> words;
    SceneArguments scene;
};

/// The largest step of the scene's method at the start of its runs, and the automatic step there.
std::string step_lines(const tasks::Scene& scene) {
    const tasks::Simulation simulation(scene);
    if (simulation.needs_settling()) return "  stable:   unknown until the scene has settled (cvtflow settle)\n";
    const tasks::LargestStep limit = largest_step(simulation);
    const std::string chosen = scene.run.step.automatic()
                                   ? fmt::format("  auto:     {} at the start\n", time_text(automatic_step(simulation)))
                                   : std::string(scene.run.step > limit.step ? "  warning:  run.step exceeds this limit\n" : "");
    return fmt::format("  stable:   {} with {} up to {}\n{}", scene.name, simulation.method().name(), tasks::text_of(limit), chosen);
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
        const std::vector<std::string> keys = keys_of(word);
        if (const std::string meaning = meaning_of(word); !meaning.empty() && !tasks::find_parameter(keys.front())) {
            text += (text.empty() ? "" : "\n") + meaning;
            continue;
        }
        for (const std::string& key : keys) {
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
    app.add_option(
           "KEY", arguments->words,
           "Key such as tip.radius, or a section such as tip for all its keys; for sweep files sweep.axes.key, sweep.axes, sweep; a "
           "channel, a note, or a term such as creep (cvtflow list terms)")
        ->required()
        ->type_name("");
    app.add_option("--scene", arguments->scene.scene, "Print the value in this scene too; for run.step also the largest step of its method")
        ->type_name("SCENE");
    declare_changes(app, arguments->scene);
    return [arguments] { return explain(*arguments); };
}

}  // namespace cvtflow::tools
