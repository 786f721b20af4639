#pragma once
/// A scene as readable text.

#include <string>

#include "tasks/scene/scene.hpp"

namespace cvtflow::tools {

/// `fine (order 3, each plate, 3 joint points, elastic pulleys), piecewise friction`; without a name if no preset matches.
[[nodiscard]] std::string detail_text(const tasks::Scene& scene);

}  // namespace cvtflow::tools
