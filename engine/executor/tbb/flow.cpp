#include "engine/executor/tbb/flow.hpp"

#include <oneapi/tbb/flow_graph.h>

#include <deque>

#include "engine/executor/tbb/resident_board.hpp"
#include "engine/executor/tbb/tbb_section.hpp"
#include "engine/thread/pinning.hpp"

namespace cvtflow::engine {

namespace flow = oneapi::tbb::flow;

void Flow::execute(Run& run, int first) {
    using Message = flow::continue_msg;
    ResidentBoard board(run, options(), first);
    const Processors processors;
    TbbSection section(options().threads, options().present_arena);
    section.execute([&](oneapi::tbb::task_group_context& context) {
        flow::graph graph(context);
        flow::broadcast_node<Message> start(graph);
        std::deque<flow::continue_node<Message>> workers;
        // Worker 0 last: the calling thread takes the newest task, and so has the first share, as in the other executors.
        for (int worker = options().threads - 1; worker >= 0; --worker) {
            auto& node = workers.emplace_back(graph, [&, worker](const Message&) noexcept {
                const Pin pin(options().pin, processors, worker);
                board.work(worker);
            });
            flow::make_edge(start, node);
        }
        start.try_put(Message());
        graph.wait_for_all();
    });
}

}  // namespace cvtflow::engine
