#pragma once
/// The state for a measurement: from the scene's state file, or settled now.

#include <string>

#include "tasks/scene/scene.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::bench {

/// @param settle whether a geometric start may be settled   @param what purpose in the message: "its errors", "its eigenvalues"
/// @throws tasks::SceneError if the start needs settling and `settle` is false; tasks::SettlingFault
[[nodiscard]] tasks::FrozenStart settled_start(const tasks::Scene& scene, bool settle, const std::string& what);

/// Number of touching tips.
[[nodiscard]] long touching_tips(const tasks::FrozenStart& start);

}  // namespace cvtflow::bench
