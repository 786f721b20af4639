/// All cycles live in one graph. The last tasks of a cycle send to its `close`, which counts them, asks the controller and sends to the
/// `start` of the next cycle.
///
///              ┌─► task ─┐
///     start[c] ┤         ├─► close[c] ── decides c' ┄┄► start[c']
///              └─► task ─┘
///
/// The dotted arrow is a message without an edge: an edge into a continue_node would count as one more predecessor and the ring would
/// never begin; broadcast nodes do not count. `close` is lightweight, that is, it runs inside the last task instead of being a task of
/// its own that another thread may have to steal (about 1 µs). Cycles follow one another, so that one decision is made at a time, and
/// the reference counts of oneTBB order what the tasks wrote before it.

#include "bench/executor/tbb/flow_messages.hpp"

#include "bench/executor/tbb/pinned_section.hpp"
#include "bench/executor/tbb/task_nodes.hpp"

namespace cvtflow::bench {

using namespace engine;

namespace flow = oneapi::tbb::flow;

void FlowMessages::execute(Run& run, int first) {
    using Close = flow::continue_node<TaskNodes::Message, flow::lightweight>;
    PinnedSection section(options());
    section.execute([&](oneapi::tbb::task_group_context& context) {
        flow::graph graph(context);
        TaskNodes nodes(graph, run);
        std::deque<Close> closes;
        for (int cycle = 0; cycle < run.graph().cycles(); ++cycle) {
            auto& close = closes.emplace_back(graph, [&](const TaskNodes::Message&) noexcept {
                if (const int next = run.decide(slot()); next != Controller::stop) nodes.start(next);
            });
            nodes.order_before(cycle, close);
        }
        nodes.start(first);
        graph.wait_for_all();
    });
}

}  // namespace cvtflow::bench
