#include "bench/executor/tbb/flow_per_cycle.hpp"

#include "bench/executor/tbb/pinned_section.hpp"
#include "bench/executor/tbb/task_nodes.hpp"

namespace cvtflow::bench {

using namespace engine;

void FlowPerCycle::execute(Run& run, int first) {
    PinnedSection section(options());
    section.execute([&](oneapi::tbb::task_group_context& context) {
        oneapi::tbb::flow::graph graph(context);
        TaskNodes nodes(graph, run);
        for (int cycle = first; cycle != Controller::stop; cycle = run.decide(0)) {
            nodes.start(cycle);
            graph.wait_for_all();
        }
    });
}

}  // namespace cvtflow::bench
