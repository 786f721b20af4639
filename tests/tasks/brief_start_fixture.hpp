#pragma once
/// The smallest scene after a millisecond of settling: tips touch, everything moves.

#include "tasks/scene/scene.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::tasks {

[[nodiscard]] Scene brief_scene();
/// Settled once per test program.
[[nodiscard]] const FrozenStart& brief_start();

}  // namespace cvtflow::tasks
