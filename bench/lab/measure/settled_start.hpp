#pragma once
/// A state to measure at: that of the scene's file, or settled now.

#include <string>

#include "tasks/scene/scene.hpp"
#include "tasks/step/frozen_start.hpp"

namespace cvtflow::bench {

/// @param settle whether a geometric start may be settled   @param what "its errors", "its eigenvalues": what would mean nothing without
/// @throws tasks::SceneError if it may not but would have to be; tasks::SettlingFault
[[nodiscard]] tasks::FrozenStart settled_start(const tasks::Scene& scene, bool settle, const std::string& what);

/// Tips that touch.
[[nodiscard]] long touching_tips(const tasks::FrozenStart& start);

}  // namespace cvtflow::bench
