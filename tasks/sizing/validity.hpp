#pragma once
/// The ranges in which errors are known (docs/validity.md, whose figures these are), for a scene.

#include <string>
#include <vector>

#include "tasks/sizing/sizing.hpp"

namespace cvtflow::tasks {

/// Sentences on what lies outside, in the order of the page. Empty: nothing does.
/// @param sizing of the scene's tables; without instants only what is constant is judged   @param automatic_step [s]
[[nodiscard]] std::vector<std::string> outside_validity(const Scene& scene, const Sizing& sizing, double automatic_step);

}  // namespace cvtflow::tasks
