#pragma once
/// Reads one value of a scene: type, unit, dimension and range are those of its row in the parameter table.

#include <vector>

#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml_tree.hpp"

namespace cvtflow::tasks {

/// Sets the member of `parameter` in `scene` to the value of `node`. Errors are appended to `problems`, with the position of the number,
/// text or list element concerned, and leave the member unchanged.
void read_value(const Parameter& parameter, const Node& node, Scene& scene, std::vector<Problem>& problems);

}  // namespace cvtflow::tasks
