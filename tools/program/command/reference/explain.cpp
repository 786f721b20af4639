#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <functional>
#include <memory>
#include <optional>

#include "tasks/batch/sweep/sweep_keys.hpp"
#include "tasks/channel/channels.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/run_means.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/command/reference/terms.hpp"
#include "tools/program/program.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

std::vector<std::string> keys_where(const std::function<bool(const tasks::Parameter&)>& belongs) {
    std::vector<std::string> keys;
    for (const tasks::Parameter& parameter : tasks::parameter_table()) {
        if (belongs(parameter)) keys.emplace_back(parameter.key);
    }
    return keys;
}

/// The term, or the first one that begins with the word; '_' is a space. nullptr if there is none.
const Term* term_of(std::string word) {
    const auto spaced = [](std::string text) {
        std::ranges::replace(text, '_', ' ');
        return text;
    };
    word = spaced(std::move(word));
    for (const std::string& begin : {word, word + " "}) {
        for (const Term& term : terms)
            if (const std::string of = spaced(std::string(term.word)); of == word || (begin != word && of.starts_with(begin))) return &term;
    }
    return nullptr;
}

/// Meaning of a word that is no key: a term, a channel or a note. Empty if it is none.
std::string meaning_of(const std::string& word) {
    if (const Term* term = term_of(word)) return fmt::format("{}\n  {}\n", term->word, term->meaning);
    const auto channels = tasks::channels();
    if (const auto channel = std::ranges::find(channels, word, &tasks::Channel::name); channel != channels.end())
        return fmt::format("{}\n  {}\n  channel of records; unit: {}\n", channel->name, channel->description, channel->unit);
    if (const auto* note = std::ranges::find(tasks::note_kinds, word, &tasks::NoteKind::name); note != std::end(tasks::note_kinds))
        return fmt::format("{}\n  {}\n  note of runs and cases\n", note->name, note->meaning);
    return {};
}

/// A line with the keys, channels and terms whose meaning contains the word; empty if none does.
std::string found_in_meanings(const std::string& word) {
    std::string names;
    const auto search = [&](std::string_view name, std::string_view meaning) {
        const auto same = [](char a, char b) { return std::tolower(a) == std::tolower(b); };
        const std::string text = fmt::format("{}\n{}", name, meaning);
        if (std::search(text.begin(), text.end(), word.begin(), word.end(), same) == text.end()) return;
        names += (names.empty() ? "" : ", ") + std::string(name);
    };
    for (const tasks::Parameter& key : tasks::parameter_table()) search(key.key, key.meaning);
    for (const tasks::Channel& channel : tasks::channels()) search(channel.name, channel.description);
    for (const Term& term : terms) search(term.word, term.meaning);
    return names.empty() ? "" : fmt::format("{}\n  in the meaning of: {}\n", word, names);
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

/// @param scene whose values are stated; may be nullptr   @throws tasks::SceneError if the word has no meaning here
std::string explanation_of(const std::string& word, const tasks::Scene* scene) {
    if (tasks::names_sweep(word)) return tasks::explain_sweep(word);
    std::vector<std::string> keys = keys_where([&](const auto& key) { return key.key == word || key.section() == word; });
    if (const std::string meaning = keys.empty() ? meaning_of(word) : ""; !meaning.empty()) return meaning;
    if (keys.empty()) keys = keys_where([&](const auto& key) { return std::ranges::find(key.choices, word) != key.choices.end(); });
    const std::string found = keys.empty() ? found_in_meanings(word) : "";
    if (keys.empty() && found.empty()) return tasks::explain(word);
    std::string text = found;
    for (const std::string& key : keys)
        text += (text.empty() ? "" : "\n") + tasks::explain(key) + (scene != nullptr ? scene_lines(key, *scene) : "");
    return text;
}

ExitStatus explain(const ExplainArguments& arguments) {
    std::optional<LoadedScene> loaded;
    if (!arguments.scene.scene.empty()) loaded = load_scene(arguments.scene);
    std::string text, unknown;
    for (const std::string& word : arguments.words) {
        try {
            const std::string explanation = explanation_of(word, loaded ? &loaded->scene : nullptr);
            text += (text.empty() ? "" : "\n") + explanation;
        } catch (const tasks::SceneError& error) {
            unknown += fmt::format("{}{}", unknown.empty() ? "" : "\n", error.what());
        }
    }
    fmt::print("{}", text);
    if (!unknown.empty()) throw tasks::SceneError(unknown);
    return ExitStatus::finished;
}

}  // namespace

Action declare_explain(CLI::App& app) {
    const auto arguments = std::make_shared<ExplainArguments>();
    app.add_option(
           "KEY", arguments->words,
           "Key such as tip.radius, or a section such as tip for all its keys; for sweep files sweep.axes.key, sweep.axes, sweep; a "
           "channel, a note, a value such as palmgren, or a term such as creep (cvtflow list terms)")
        ->required()
        ->type_name("");
    app.add_option("--scene", arguments->scene.scene, "Print the value in this scene too; for run.step also the largest step of its method")
        ->type_name("SCENE");
    declare_changes(app, arguments->scene);
    return [arguments] { return explain(*arguments); };
}

Action declare_schema(CLI::App& app) {
    const auto sweep = std::make_shared<bool>(false);
    app.add_flag("--sweep", *sweep, "The schema of sweeps instead of scenes");
    return [sweep] {
        fmt::print("{}", *sweep ? tasks::sweep_schema() : tasks::json_schema());
        return ExitStatus::finished;
    };
}

}  // namespace cvtflow::tools
