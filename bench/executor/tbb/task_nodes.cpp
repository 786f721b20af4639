#include "bench/executor/tbb/task_nodes.hpp"

#include "bench/executor/tbb/pinned_section.hpp"

namespace cvtflow::bench {

using namespace engine;

namespace flow = oneapi::tbb::flow;

TaskNodes::TaskNodes(flow::graph& graph, const Run& run) : tasks_(run.graph()) {
    for (int task = 0; task < tasks_.size(); ++task) {
        nodes_.emplace_back(graph, [&run, task](const Message&) noexcept { run.task(task, slot()); });
    }
    for (int task = 0; task < tasks_.size(); ++task) {
        for (const int after : tasks_.successors(task)) {
            flow::make_edge(nodes_[static_cast<std::size_t>(task)], nodes_[static_cast<std::size_t>(after)]);
        }
    }
    for (int cycle = 0; cycle < tasks_.cycles(); ++cycle) {
        auto& start = starts_.emplace_back(graph);
        for (const int task : tasks_.topological(cycle)) {
            if (tasks_.predecessor_count(task) == 0) flow::make_edge(start, nodes_[static_cast<std::size_t>(task)]);
        }
    }
}

void TaskNodes::order_before(int cycle, flow::receiver<Message>& end) {
    for (const int task : tasks_.topological(cycle)) {
        if (tasks_.successors(task).empty()) flow::make_edge(nodes_[static_cast<std::size_t>(task)], end);
    }
}

}  // namespace cvtflow::bench
