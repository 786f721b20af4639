#pragma once
/// The smallest scene, to be integrated from its geometric start, or after a millisecond of settling: tips touch, everything moves.

#include <string>
#include <vector>

#include "tasks/scene/scene.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::tasks {

inline constexpr double settling_begin = -10e-3;  ///< [s]

[[nodiscard]] inline Scene ready_tiny() { return read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml", StartState::ignored); }
[[nodiscard]] inline model::Parameters tiny_parameters() { return ready_tiny().parameters; }

[[nodiscard]] Scene brief_scene();
/// Settled once per test program.
[[nodiscard]] const FrozenStart& brief_start();

namespace test {

/// With its state on file, settled once per process. Serial, until 20 us with outputs every 10 us; settings "key=value" are applied on top.
[[nodiscard]] Scene settled_tiny(const std::vector<std::string>& settings = {});

}  // namespace test

}  // namespace cvtflow::tasks
