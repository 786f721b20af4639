#include "engine/executor/serial.hpp"

namespace cvtflow::engine {

void Serial::run(const TaskGraph& graph, void* context, Controller& controller) {
    require_frozen(graph);
    for (int cycle = controller.next(); cycle != Controller::stop; cycle = controller.next()) {
        if (cycle < 0 || cycle >= graph.cycles()) reject_cycle(graph, cycle);
        for (const int task : graph.topological(cycle)) {
            const auto [body, item] = graph.call(task);
            body(context, item);
        }
    }
}

}  // namespace cvtflow::engine
