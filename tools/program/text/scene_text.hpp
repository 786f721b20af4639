#pragma once
/// A scene in the words of a person.

#include <string>

#include "tasks/scene/scene.hpp"

namespace cvtflow::tools {

/// `fine (order 3, each plate, 3 joint points, elastic pulleys), piecewise friction`; no preset's name if it is none.
[[nodiscard]] std::string detail_text(const tasks::Scene& scene);

}  // namespace cvtflow::tools
