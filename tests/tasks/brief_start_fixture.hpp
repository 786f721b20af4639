#pragma once
/// The smallest scene after a millisecond of settling: tips touch, everything moves.

#include "tasks/frozen_step.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

[[nodiscard]] Scene brief_scene();
/// Settled once per test program.
[[nodiscard]] const FrozenStart& brief_start();

}  // namespace cvtflow::tasks
