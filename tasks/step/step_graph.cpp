#include <stdexcept>
#include <string>

#include "tasks/step/assembly/segment_tasks.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

namespace {

FurtherAssembly& further_assembly() {
    static FurtherAssembly none{nullptr, nullptr};
    return none;
}

/// One task per segment and cycle, joints at segment borders computed by both neighbours: a single synchronisation per evaluation.
engine::TaskGraph fused_graph(const Workspace& w) {
    engine::TaskGraph graph;
    for (int s = 0; s < w.partition.size(); ++s) {
        const std::string number = "[" + std::to_string(s) + "]";
        // Slots that a stage reads are never the ones it writes: bench/method/analysis/order.hpp checks that.
        graph.add({"force" + number, evaluate_cycle, evaluate_segment, s,
                   LinkAccesses(w, s)
                       .with_halo(Field::states_read)
                       .with_halo(Field::slopes_read)
                       .with_halo(Field::end_state)
                       .inside(Field::slope_written, true)
                       .inside(Field::state_kept, true)
                       .inside(Field::load, true)
                       .inside(Field::account, true)
                       .inside(Field::phase, false)
                       .segment(Field::window, true)
                       .list(),
                   "all forces (fused)"});
        add_transition_tasks(graph, w, s);
        add_observe_task(graph, w, s);
    }
    return graph;
}

}  // namespace

void add_assembly(const FurtherAssembly& staged) { further_assembly() = staged; }

bool has_assembly(Assembly kind) noexcept { return kind == Assembly::fused || further_assembly().graph != nullptr; }

std::unique_ptr<AssemblyMemory> further_memory(Workspace& w) {
    return further_assembly().memory == nullptr ? nullptr : further_assembly().memory(w);
}

engine::TaskGraph step_graph(const Workspace& w, const AssemblyOptions& options, StepMethod* method) {
    if (!has_assembly(options.kind)) throw std::invalid_argument("assembly \"staged\" belongs to the laboratory: cvtflow-lab");
    engine::TaskGraph graph = options.kind == Assembly::fused ? fused_graph(w) : further_assembly().graph(w, options);
    if (method != nullptr) method->add_tasks(graph);
    graph.freeze();
    return graph;
}

void add_transition_tasks(engine::TaskGraph& graph, const Workspace& w, int s, bool detect) {
    const std::string number = "[" + std::to_string(s) + "]";
    const auto accesses = [&] {
        return LinkAccesses(w, s)
            .with_near(Field::states_read)
            .with_near(Field::slopes_read)
            .segment(Field::window, true)
            .segment(Field::result, true);
    };
    if (detect)
        graph.add({"detect" + number, detect_cycle, detect_segment, s,
                   accesses()
                       .inside(Field::secant, true)
                       .inside(Field::phase, false)
                       .inside(Field::before, false)
                       .inside(Field::end_state, true)
                       .inside(Field::after, true)
                       .inside(Field::link_error, true)
                       .list(),
                   transition_stage});
    graph.add(
        {"locate" + number, locate_cycle, locate_segment, s,
         accesses().with_near(Field::end_state).inside(Field::phase, false).inside(Field::before, false).inside(Field::after, false).list(),
         transition_stage});
    graph.add(
        {"truncate" + number, truncate_cycle, truncate_segment, s,
         accesses().with_near(Field::end_state).inside(Field::after, true).inside(Field::cut_state, true).inside(Field::phase, true).list(),
         transition_stage});
}

void add_observe_task(engine::TaskGraph& graph, const Workspace& w, int s) {
    graph.add({"observe[" + std::to_string(s) + "]", observe_cycle, observe_segment, s,
               LinkAccesses(w, s)
                   .with_halo(Field::states_read)
                   .inside(Field::phase, false)
                   .inside(Field::load, true)
                   .inside(Field::account, true)
                   .inside(Field::cut_state, true)
                   .segment(Field::window, true)
                   .list()});
}

}  // namespace cvtflow::tasks
