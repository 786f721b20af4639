#include "engine/executor/executor.hpp"

#include <stdexcept>
#include <string>

namespace cvtflow::engine {

void require_frozen(const TaskGraph& graph) {
    if (!graph.frozen()) throw std::logic_error("executor: the graph is not frozen");
}

void reject_cycle(const TaskGraph& graph, int cycle) {
    throw std::out_of_range("executor: the controller asked for cycle " + std::to_string(cycle) + " of " + std::to_string(graph.cycles()));
}

}  // namespace cvtflow::engine
