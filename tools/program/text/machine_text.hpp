#pragma once
/// A scene's machine in figures of the design, from its geometry: what a run has not computed yet.

#include <string>

#include "tasks/scene/scene.hpp"

namespace cvtflow::tools {

/// Lines of `check`: running radii, arcs, frequency of passing pins, torque limit of the driven pulley and safety factor, with a warning
/// where the load exceeds the limit. Empty without pulleys.
[[nodiscard]] std::string machine_lines(const tasks::Scene& scene);

}  // namespace cvtflow::tools
