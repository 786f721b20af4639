#include "tools/program/arguments.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>

#include "engine/base/text.hpp"
#include "tasks/method/method.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tasks/scene/units.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::tools {

namespace {

/// "detail.plates = lumped (was each), …" of the keys that determine the state; empty if nothing changed.
std::string changes(const tasks::Scene& before, const tasks::Scene& now) {
    const auto of_state = [keys = tasks::state_keys()](const tasks::Parameter& row) {
        return std::ranges::find(keys, row.key) != keys.end();
    };
    std::vector<std::string> texts;
    for (const tasks::KeyDifference& each : tasks::differing_keys(now, before, of_state))
        texts.push_back(fmt::format("{} = {} (was {})", each.key->key, each.a, each.b));
    return fmt::format("{}", fmt::join(texts, ", "));
}

/// A setting, and how the command line states it.
struct Given {
    std::string setting;   ///< key=value
    std::string words;     ///< "--set key=value", "--until 1ms", "--settle"
    std::string key = {};  ///< key of a shortcut
};

/// All settings in the order in which they apply. A tolerance selects steps by local error, unless run.step_control is given too.
std::vector<Given> given_settings(const SceneArguments& arguments) {
    constexpr std::string_view by_tolerance = "run.step_control=error";
    std::vector<Given> all;
    for (const std::string& setting : arguments.settings) all.push_back({setting, "--set " + setting});
    for (const Shortcut& shortcut : arguments.shortcuts) {
        if (shortcut.value) all.push_back({shortcut.key + "=" + *shortcut.value, shortcut.option + " " + *shortcut.value, shortcut.key});
    }
    if (arguments.settle) all.push_back({"start.state=", "--settle"});
    const auto tolerance = std::ranges::find(all, "run.tolerance", &Given::key);
    const auto controls = [&](const Given& each) { return each.setting.starts_with("run.step_control=") && each.setting != by_tolerance; };
    if (tolerance != all.end() && std::ranges::none_of(all, controls))
        all.push_back({std::string(by_tolerance), tolerance->words, tolerance->key});
    return all;
}

/// Rewrites a message about settings in terms of the command line.
std::string in_words_given(const std::string& message, const std::vector<Given>& given) {
    std::istringstream lines(message);
    std::vector<std::string> rewritten;
    for (std::string line; std::getline(lines, line);) {
        for (const Given& each : given) {
            const std::string as_setting = fmt::format("--set {}: ", each.setting);
            if (!line.starts_with(as_setting)) continue;
            std::string problem = line.substr(as_setting.size());
            if (!each.key.empty() && problem.starts_with(each.key + ": ")) problem.erase(0, each.key.size() + 2);
            line = fmt::format("{}: {}", each.words, problem);
        }
        rewritten.push_back(line);
    }
    return fmt::format("{}", fmt::join(rewritten, "\n"));
}

void apply_settings(tasks::Scene& scene, const std::vector<Given>& given) {
    std::vector<std::string> settings;
    for (const Given& each : given) settings.push_back(each.setting);
    try {
        tasks::set_values(scene, settings);
    } catch (const tasks::SceneError& error) {
        throw UsageError(in_words_given(error.what(), given));
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
void require_member(const tasks::Scene& scene, const std::string& own_method, const std::vector<Given>& given) {
    const std::string method = tasks::method_of(scene);
    if (tasks::Method::find(method)) return;
    const std::string problem = scene.method_place + "run.method: " + tasks::no_method(method);
    if (scene.run.method == own_method) throw tasks::SceneError(problem);
    throw UsageError(in_words_given(problem, given));
}

/// A run length given as a bare number is in seconds: what that means, if it is long. Empty if it has a unit or is short.
std::string bare_until(const tasks::Scene& scene, const std::vector<Given>& given) {
    constexpr double usual = 1.0;  // longer runs are rare [s]
    std::string words;
    for (const Given& each : given)
        if (each.setting.starts_with("run.until=")) words = each.words;
    const std::string value = words.substr(words.find_last_of(" =") + 1);
    if (words.empty() || scene.run.until < usual || value.find_first_not_of("0123456789.") != std::string::npos) return "";
    return fmt::format("{}: a number without a unit is in seconds; \"{} ms\" are milliseconds", words, value);
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
    LoadedScene loaded{tasks::read_scene(tasks::find_scene(arguments.scene), start), {}};
    tasks::Scene& scene = loaded.scene;
    const tasks::Scene stated = scene;
    const std::vector<Given> given = given_settings(arguments);
    if (!arguments.detail.empty()) apply_preset(scene, arguments.detail);
    apply_settings(scene, given);
    const std::string changed = changes(stated, scene);
    if (!changed.empty() && !stated.state_file.empty() && scene.state_file == stated.state_file) {
        apply_settings(scene, {{"start.state=", changed}});  // a geometric start, to which the chain may not close
        loaded.notice = fmt::format("{}: the state in {} no longer fits; the run settles again", changed, stated.state_file);
    }
    require_member(scene, stated.run.method, given);
    std::vector<std::string> notices = tasks::idle_keys(scene);
    for (const std::string& notice : {bare_until(scene, given), loaded.notice})
        if (!notice.empty()) notices.insert(notices.begin(), notice);
    loaded.notice = fmt::format("{}", fmt::join(notices, "\n"));
    return loaded;
}

tasks::Sweep load_sweep(const std::string& path) {
    std::error_code unreadable;
    if (path.find('/') != std::string::npos || std::filesystem::exists(path, unreadable)) return tasks::read_sweep(path, tasks::find_scene);
    std::vector<std::string> names;
    for (const tasks::ReadyScene& ready : tasks::ready_sweeps()) {
        if (ready.name == path) return tasks::read_sweep(ready.path.string(), tasks::find_scene);
        names.push_back(ready.name);
    }
    const auto scenes = tasks::ready_scenes();
    const bool scene = std::ranges::find(scenes, path, &tasks::ReadyScene::name) != scenes.end();
    const std::string ready = fmt::format("{}", fmt::join(names, ", "));
    for (const std::filesystem::directory_entry& file : std::filesystem::directory_iterator(".", unreadable))
        if (file.path().extension() == ".toml") names.push_back(file.path().filename().string());
    throw tasks::SceneError(fmt::format("no sweep '{}'{}; ready sweeps: {}{}", path, engine::did_you_mean(engine::closest(path, names)),
                                        ready, scene ? fmt::format("; to run the scene of that name: cvtflow run {}", path) : ""));
}

}  // namespace cvtflow::tools
