#include "tools/program/arguments.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>

#include "engine/base/text.hpp"
#include "tasks/batch/batch.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/scene/units.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

std::vector<std::string> state_values(const tasks::Scene& scene) {
    std::vector<std::string> values;
    for (const std::string_view key : tasks::state_keys()) values.push_back(tasks::value_text(*tasks::find_parameter(key), scene));
    return values;
}

/// "detail.order = 0 (was 3), …"; empty if nothing changed.
std::string changes(const std::vector<std::string>& before, const std::vector<std::string>& now) {
    std::vector<std::string> texts;
    for (std::size_t i = 0; i < now.size(); ++i) {
        if (before[i] != now[i]) texts.push_back(fmt::format("{} = {} (was {})", tasks::state_keys()[i], now[i], before[i]));
    }
    return fmt::format("{}", fmt::join(texts, ", "));
}

constexpr std::string_view tolerance_key = "run.tolerance";
/// Setting that a tolerance on the command line implies.
constexpr std::string_view by_tolerance = "run.step_control=error";

/// Rewrites a message in terms of the command line: shortcuts were turned into settings.
std::string in_words_given(const std::string& message, const SceneArguments& arguments) {
    std::istringstream lines(message);
    std::vector<std::string> rewritten;
    for (std::string line; std::getline(lines, line);) {
        if (constexpr std::string_view settled = "--set start.state=: "; arguments.settle && line.starts_with(settled))
            line = "--settle: " + line.substr(settled.size());
        for (const Shortcut& shortcut : arguments.shortcuts) {
            if (!shortcut.value) continue;
            const bool beside = shortcut.key == tolerance_key && line.starts_with(fmt::format("--set {}: ", by_tolerance));
            const std::string as_setting =
                beside ? fmt::format("--set {}: ", by_tolerance) : fmt::format("--set {}={}: ", shortcut.key, *shortcut.value);
            if (!line.starts_with(as_setting)) continue;
            std::string problem = line.substr(as_setting.size());
            if (problem.starts_with(shortcut.key + ": ")) problem.erase(0, shortcut.key.size() + 2);
            line = fmt::format("{} {}: {}", shortcut.option, *shortcut.value, problem);
        }
        rewritten.push_back(line);
    }
    return fmt::format("{}", fmt::join(rewritten, "\n"));
}

/// A tolerance on the command line selects steps by local error, unless run.step_control is given too.
bool asks_for_tolerance_only(const SceneArguments& arguments) {
    const auto given = [&](const Shortcut& shortcut) { return shortcut.key == tolerance_key && shortcut.value; };
    const auto controls = [](const std::string& setting) { return setting.starts_with("run.step_control="); };
    return std::any_of(arguments.shortcuts.begin(), arguments.shortcuts.end(), given) &&
           std::none_of(arguments.settings.begin(), arguments.settings.end(), controls);
}

void apply_settings(tasks::Scene& scene, const SceneArguments& arguments) {
    std::vector<std::string> settings = arguments.settings;
    for (const Shortcut& shortcut : arguments.shortcuts) {
        if (shortcut.value) settings.push_back(shortcut.key + "=" + *shortcut.value);
    }
    if (arguments.settle) settings.emplace_back("start.state=");
    if (asks_for_tolerance_only(arguments)) settings.emplace_back(by_tolerance);
    try {
        tasks::set_values(scene, settings);
    } catch (const tasks::SceneError& error) {
        throw UsageError(in_words_given(error.what(), arguments));
    }
}

void apply_preset(tasks::Scene& scene, const std::string& preset) {
    try {
        tasks::apply_detail(scene, preset);
    } catch (const tasks::SceneError& error) {
        throw UsageError(fmt::format("--{}", error.what()));
    }
}

/// A family of methods reports an unknown member when the method is made.
void require_member(const tasks::Scene& scene, const std::string& own_method, const SceneArguments& arguments) {
    const std::string method = tasks::method_of(scene);
    if (tasks::Method::find(method)) return;
    const std::string problem = scene.method_place + "run.method: " + tasks::no_method(method);
    if (scene.run.method == own_method) throw tasks::SceneError(problem);
    throw UsageError(in_words_given(problem, arguments));
}

/// The scene begins with a geometric start, since `changed` made its state useless. @throws UsageError if the chain does not close
void without_state(tasks::Scene& scene, const std::string& changed) {
    constexpr std::string_view ours = "start.state=";
    try {
        tasks::set_value(scene, ours);
    } catch (const tasks::SceneError& error) {  // its lines begin with a setting that the user did not give
        std::string text = error.what();
        const std::string blamed = fmt::format("--set {}: ", ours);
        for (std::size_t at = 0; (at = text.find(blamed, at)) != std::string::npos;) text.replace(at, blamed.size(), changed + ": ");
        throw UsageError(text);
    }
}

/// A run length given as a bare number is in seconds: what that means, if it is long. Empty if it has a unit or is short.
std::string bare_until(const tasks::Scene& scene, const SceneArguments& arguments) {
    constexpr double usual = 1.0;  // longer runs are rare [s]
    std::string given;
    for (const std::string& setting : arguments.settings)
        if (setting.starts_with("run.until=")) given = "--set " + setting;
    for (const Shortcut& shortcut : arguments.shortcuts)
        if (shortcut.key == "run.until" && shortcut.value) given = fmt::format("{} {}", shortcut.option, *shortcut.value);
    const std::string value = given.substr(given.find_last_of(" =") + 1);
    if (given.empty() || scene.run.until < usual || value.find_first_not_of("0123456789.") != std::string::npos) return "";
    return fmt::format("{}: a number without a unit is in seconds; \"{} ms\" are milliseconds", given, value);
}

/// "a, b" as {"a", "b"}.
std::vector<std::string> names_of(const std::string& list) {
    std::vector<std::string> names;
    std::istringstream rest(list);
    for (std::string name; std::getline(rest, name, ',');) {
        const auto first = name.find_first_not_of(' ');
        if (first != std::string::npos) names.push_back(name.substr(first, name.find_last_not_of(' ') - first + 1));
    }
    return names;
}

}  // namespace

void require_method(const std::string& method) {
    if (method == tasks::automatic_method || tasks::Method::find(method)) return;
    throw UsageError(tasks::no_method(method));
}

void declare_repeated(CLI::App& app, const char* option, std::vector<std::string>& values, const std::string& meaning, const char* type) {
    CLI::Option* made = app.add_option(option, values, meaning)->type_name(type);
    made->expected(1)->allow_extra_args(false)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void declare_scene(CLI::App& app, SceneArguments& arguments) {
    app.add_option("SCENE", arguments.scene, "Scene file, or name of a ready scene (cvtflow list scenes)")->required()->type_name("");
    declare_changes(app, arguments);
}

void declare_changes(CLI::App& app, SceneArguments& arguments) {
    declare_repeated(app, "--set", arguments.settings, "Change a key of the scene; may be repeated (cvtflow list keys)", "KEY=VALUE");
    app.add_option("--detail", arguments.detail, "Level of detail (cvtflow list detail)")->type_name("PRESET");
}

void declare_fresh_start(CLI::App& app, SceneArguments& arguments) {
    app.add_flag("--settle", arguments.settle, "Start from the geometric start and settle it, even if the scene names a state file");
}

void declare_shortcut(CLI::App& app, SceneArguments& arguments, std::string option, std::string key, const std::string& type) {
    Shortcut& shortcut = arguments.shortcuts.emplace_back(Shortcut{std::move(option), std::move(key), {}});
    const std::string meaning(tasks::find_parameter(shortcut.key)->meaning);
    app.add_option(shortcut.option, shortcut.value, fmt::format("{} ({})", meaning, shortcut.key))
        ->type_name(type)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

double seconds_of(const std::string& option, const std::string& text) {
    const auto parsed = tasks::parse_quantity(text);
    const auto* quantity = std::get_if<tasks::Quantity>(&parsed);
    const bool time = quantity != nullptr && quantity->has_unit && quantity->dimension == tasks::dimension_of("s");
    if (!time || !(quantity->value > 0.0))
        throw UsageError(fmt::format("{} {}: expected a time such as \"30 s\" or \"10 min\"", option, text));
    return quantity->value;
}

LoadedScene load_scene(const SceneArguments& arguments) {
    const auto start = arguments.settle ? tasks::StartState::ignored : tasks::StartState::required;
    LoadedScene loaded{tasks::read_scene(find_scene(arguments.scene), start), {}};
    tasks::Scene& scene = loaded.scene;
    const std::string own_state = scene.state_file, own_method = scene.run.method;
    const std::vector<std::string> before = state_values(scene);
    if (!arguments.detail.empty()) apply_preset(scene, arguments.detail);
    apply_settings(scene, arguments);
    const std::string changed = changes(before, state_values(scene));
    if (!changed.empty() && !own_state.empty() && scene.state_file == own_state) {
        without_state(scene, changed);
        loaded.notice = fmt::format("{}: the state in {} no longer fits; the run settles again", changed, own_state);
    }
    require_member(scene, own_method, arguments);
    std::vector<std::string> notices = tasks::idle_keys(scene);
    for (const std::string& notice : {bare_until(scene, arguments), loaded.notice})
        if (!notice.empty()) notices.insert(notices.begin(), notice);
    loaded.notice = fmt::format("{}", fmt::join(notices, "\n"));
    return loaded;
}

void declare_tuning(CLI::App& app, TuningArguments& arguments) {
    std::vector<std::string> names;
    for (const tasks::Figure& figure : tasks::figures()) names.emplace_back(figure.name);
    app.add_option("--accuracy", arguments.accuracy, "Target: largest error of the outputs, e.g. \"1 %\"")->type_name("SHARE");
    app.add_option("--outputs", arguments.outputs,
                   fmt::format("Outputs whose error counts, separated by commas: {}, or as in a sweep, \"slip median\" (default: slip, "
                               "efficiency, tight_tension, tips)",
                               fmt::join(names, ", ")))
        ->type_name("LIST");
    app.add_option("--methods", arguments.methods,
                   "Methods to choose from, separated by commas (default: the default method and the cheapest of the catalogue)")
        ->type_name("LIST");
    app.add_option("--budget", arguments.budget, "Wall time of the search, references included, e.g. \"2 min\"")->type_name("TIME");
    const tasks::PointTimes usual;
    app.add_option("--settling", arguments.settle,
                   fmt::format("Simulated time before the averages begin (default: {:g} ms)", 1e3 * usual.settle))
        ->type_name("TIME");
    app.add_option("--average", arguments.average,
                   fmt::format("Simulated time that the averages cover (default: {:g} ms)", 1e3 * usual.average))
        ->type_name("TIME");
}

tasks::TuneSettings tune_settings(const TuningArguments& arguments, bool quiet) {
    tasks::TuneSettings settings;
    if (arguments.accuracy) {
        const auto accuracy = tasks::read_accuracy(*arguments.accuracy);
        if (!accuracy)
            throw UsageError(fmt::format("--accuracy {}: expected a share above 0 and up to 50 %, such as \"1 %\"", *arguments.accuracy));
        settings.accuracy = *accuracy;
    }
    settings.outputs = names_of(arguments.outputs);
    settings.methods = names_of(arguments.methods);
    for (const std::string& method : settings.methods) require_method(method);
    if (arguments.budget) settings.budget = seconds_of("--budget", *arguments.budget);
    if (arguments.settle) settings.times.settle = seconds_of("--settling", *arguments.settle);
    if (arguments.average) settings.times.average = seconds_of("--average", *arguments.average);
    if (!quiet) settings.progress = [](const std::string& what) { print_error(what); };
    return settings;
}

tasks::Sweep load_sweep(const std::string& path) {
    std::error_code unreadable;
    std::string file = path;
    for (const auto& folder : scene_folders()) {  // a ready sweep by its name
        if (path.find('/') != std::string::npos || path.ends_with(".toml") || std::filesystem::exists(file, unreadable)) break;
        file = (folder / "sweeps" / (path + ".toml")).string();
    }
    if (std::filesystem::exists(file, unreadable)) return tasks::read_sweep(file, find_scene);
    if (path.find('/') != std::string::npos || path.ends_with(".toml")) return tasks::read_sweep(path, find_scene);
    std::vector<std::string> names;
    for (const ReadyScene& ready : ready_sweeps()) names.push_back(ready.name);
    const auto scenes = tasks::ready_scenes();
    const bool scene = std::ranges::find(scenes, path, &tasks::ReadyScene::name) != scenes.end();
    throw tasks::SceneError(fmt::format("no sweep '{}'; ready sweeps: {}{}", path, fmt::join(names, ", "),
                                        scene ? fmt::format("; to run the scene of that name: cvtflow run {}", path) : ""));
}

}  // namespace cvtflow::tools
