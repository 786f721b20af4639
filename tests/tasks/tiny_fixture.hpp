#pragma once
/// The smallest scene, to be integrated from its geometric start, or after a millisecond of settling: tips touch, everything moves.

#include <filesystem>
#include <string>
#include <vector>

#include "tasks/method/method.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/step/step_graph.hpp"

namespace cvtflow::tasks {

inline constexpr double settling_begin = -10e-3;  ///< [s]

[[nodiscard]] inline std::filesystem::path scene_file(const std::string& name) { return CVTFLOW_SOURCE_DIR "/scenes/" + name + ".toml"; }

/// A ready scene at a level of detail (empty: its own), to settle from the geometric start, with settings "key=value".
[[nodiscard]] inline Scene scene_of(const std::string& name, const std::string& level, const std::vector<std::string>& settings = {},
                                    const std::vector<std::string>& more = {}) {
    Scene scene = read_scene(scene_file(name), StartState::ignored);
    if (!level.empty()) apply_detail(scene, level);
    std::vector<std::string> all = settings;
    all.insert(all.end(), more.begin(), more.end());
    set_values(scene, all);
    return scene;
}

[[nodiscard]] inline Scene ready_tiny() { return scene_of("tiny", ""); }
[[nodiscard]] inline model::Parameters tiny_parameters() { return ready_tiny().parameters; }

/// Message of the error that an action throws; empty if it throws none.
template <class Error = SceneError, class Action>
[[nodiscard]] std::string message_of(const Action& action) {
    try {
        (void)action();
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}
[[nodiscard]] inline std::string message_of_settings(Scene scene, const std::vector<std::string>& settings) {
    return message_of([&] { set_values(scene, settings); });
}

namespace test {

/// Whether this test program has the laboratory's methods, executors and assembly as well: rows of tables that need them are omitted else.
[[nodiscard]] inline bool has_laboratory() { return has_assembly(Assembly::staged); }
/// The assemblies that it has.
[[nodiscard]] inline std::vector<Assembly> assemblies() {
    return has_laboratory() ? std::vector{Assembly::fused, Assembly::staged} : std::vector{Assembly::fused};
}
/// The named methods that it has.
[[nodiscard]] inline std::vector<std::string> known_methods(std::vector<std::string> names) {
    std::erase_if(names, [](const std::string& name) { return !may_be_method(name); });
    return names;
}

/// Scene `tiny` with its state on file, settled once per process. Serial, until 20 us with outputs every 10 us; then settings "key=value".
[[nodiscard]] Scene settled_tiny(const std::vector<std::string>& settings = {});

}  // namespace test

}  // namespace cvtflow::tasks
