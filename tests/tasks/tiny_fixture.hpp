#pragma once
/// The smallest scene, to be integrated from its geometric start.

#include <string>

#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

inline constexpr double settling_begin = -10e-3;  ///< [s]

[[nodiscard]] inline Scene ready_tiny() { return read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml", StartState::ignored); }
[[nodiscard]] inline model::Parameters tiny_parameters() { return ready_tiny().parameters; }

}  // namespace cvtflow::tasks
