#include "engine/executor/tbb/flow.hpp"

#include <oneapi/tbb/flow_graph.h>

#include <deque>

#include "engine/executor/tbb/edge_board.hpp"
#include "engine/executor/tbb/resident_board.hpp"
#include "engine/executor/tbb/tbb_section.hpp"

namespace cvtflow::engine {

namespace flow = oneapi::tbb::flow;

template <class Board>
static void work_on(Run& run, const ExecutorOptions& options, int first) {
    using Message = flow::continue_msg;
    Board board(run, options, first);
    const Processors processors;
    TbbSection section(options);
    section.execute([&](oneapi::tbb::task_group_context& context) {
        flow::graph graph(context);
        flow::broadcast_node<Message> start(graph);
        std::deque<flow::continue_node<Message>> workers;
        // Worker 0 last: the calling thread takes the newest task, and so has the first share, as in the other executors.
        for (int worker = options.threads - 1; worker >= 0; --worker) {
            auto& node = workers.emplace_back(graph, [&, worker](const Message&) noexcept {
                const Pin pin(options.pin, processors, worker);
                board.work(worker);
            });
            flow::make_edge(start, node);
        }
        start.try_put(Message());
        graph.wait_for_all();
    });
}

void Flow::execute(Run& run, int first) { work_on<ResidentBoard>(run, options(), first); }
void FlowEdges::execute(Run& run, int first) { work_on<EdgeBoard>(run, options(), first); }

}  // namespace cvtflow::engine
