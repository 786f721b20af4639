#pragma once
/// Drawings of graphs, in Graphviz' language.

#include <string>

#include "engine/graph/task_graph.hpp"

namespace cvtflow::engine {

/// One cycle of a frozen graph, levels from left to right.
[[nodiscard]] std::string to_dot(const TaskGraph& graph, int cycle);

}  // namespace cvtflow::engine
