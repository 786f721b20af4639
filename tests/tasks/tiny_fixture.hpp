#pragma once
/// The smallest scene, to be integrated from its geometric start, or after a millisecond of settling: tips touch, everything moves.

#include <string>
#include <vector>

#include "tasks/method/method.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/step/step_graph.hpp"

namespace cvtflow::tasks {

inline constexpr double settling_begin = -10e-3;  ///< [s]

[[nodiscard]] inline Scene ready_tiny() { return read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml", StartState::ignored); }
[[nodiscard]] inline model::Parameters tiny_parameters() { return ready_tiny().parameters; }

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
