#pragma once
/// Arguments that several commands share: a scene and its changes; sweeps.

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "tasks/batch/sweep/sweep.hpp"
#include "tasks/scene/scene.hpp"

namespace CLI {
class App;
}

namespace cvtflow::tools {

/// An option that abbreviates a setting: `--until "1 ms"` for `--set run.until="1 ms"`.
struct Shortcut {
    std::string option;                ///< "--until"
    std::string key;                   ///< "run.until"
    std::optional<std::string> value;  ///< argument of the option; nothing: none was given
};

struct SceneArguments {
    std::string scene;                  ///< path or name of a ready scene
    std::vector<std::string> settings;  ///< key=value
    std::string detail;                 ///< preset; empty: the scene's
    std::deque<Shortcut> shortcuts;     ///< applied after `settings`; a deque: options point into it
    bool settle = false;                ///< ignore the scene's state file
};

/// Declares SCENE, --set and --detail. The arguments must outlive the parsing.
void declare_scene(CLI::App& app, SceneArguments& arguments);
/// Declares --set and --detail alone, for commands that name the scene otherwise.
void declare_changes(CLI::App& app, SceneArguments& arguments);
/// Declares --settle.
void declare_fresh_start(CLI::App& app, SceneArguments& arguments);
void declare_shortcut(CLI::App& app, SceneArguments& arguments, std::string option, std::string key, const std::string& type);

struct LoadedScene {
    tasks::Scene scene;
    std::string notice;  ///< message for the user; may be empty
};

/// The scene with all changes applied at once. If they change the layout of the state vector, the scene's state file no longer fits and is
/// dropped (notice). A state given with --set start.state is kept, and the simulation reports that it does not fit.
/// @throws tasks::SceneError
[[nodiscard]] LoadedScene load_scene(const SceneArguments& arguments);

/// An option that may be repeated, with one value each time. @param type of the value, in the help
void declare_repeated(CLI::App& app, const char* option, std::vector<std::string>& values, const std::string& meaning, const char* type);

/// @throws tasks::SceneError  `no method 'rk5' (did you mean 'rk4'?)`
void require_method(const std::string& method);
/// Wall time [s] from text with a unit. @throws tasks::SceneError that names the option
[[nodiscard]] double seconds_of(const std::string& option, const std::string& text);

/// Reads a sweep; scenes by name come from the ready ones.
[[nodiscard]] tasks::Sweep load_sweep(const std::string& path);

}  // namespace cvtflow::tools
