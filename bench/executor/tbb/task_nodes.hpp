#pragma once
/// A task graph as a oneTBB flow graph: one continue_node per task, its edges, and per cycle a node that starts it.
/// Private to this folder.

#include <oneapi/tbb/flow_graph.h>

#include <deque>

#include "engine/executor/run.hpp"

namespace cvtflow::bench {

class TaskNodes {
public:
    using Message = oneapi::tbb::flow::continue_msg;
    using Node = oneapi::tbb::flow::continue_node<Message>;

    /// Built inside the arena in which it will run; graph and run outlive it.
    TaskNodes(oneapi::tbb::flow::graph& graph, const engine::Run& run);

    /// Tasks of the cycle run, in the order of their edges.
    void start(int cycle) { starts_[static_cast<std::size_t>(cycle)].try_put(Message()); }

    /// `end` receives a message from each task of the cycle without successors.
    void order_before(int cycle, oneapi::tbb::flow::receiver<Message>& end);

private:
    const engine::TaskGraph& tasks_;
    std::deque<Node> nodes_;                                         ///< [task]
    std::deque<oneapi::tbb::flow::broadcast_node<Message>> starts_;  ///< [cycle]
};

}  // namespace cvtflow::bench
