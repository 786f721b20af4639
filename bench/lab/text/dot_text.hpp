#pragma once
/// Drawings of graphs, in Graphviz' language.

#include <string>

#include "engine/graph/task_graph.hpp"

namespace cvtflow::bench {

/// One cycle of a frozen graph, levels from left to right.
[[nodiscard]] std::string to_dot(const engine::TaskGraph& graph, int cycle);

}  // namespace cvtflow::bench
