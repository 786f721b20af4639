#include <algorithm>
#include <cstring>
#include <string>

#include "tasks/step/assembly/segment_tasks.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

namespace {

using engine::Access;

[[nodiscard]] Workspace& of(void* workspace) noexcept { return *static_cast<Workspace*>(workspace); }

/// Stage state of one segment's links.
void combine_segment(void* workspace, int segment) noexcept {
    Workspace& w = of(workspace);
    const Segment& own = w.partition[segment];
    const model::ChainLayout& layout = w.layout();
    const int begin = layout.link_begin(own.first);
    const int end = begin + own.size() * layout.link_block();
    const std::size_t bytes = static_cast<std::size_t>(end - begin) * sizeof(double);
    if (w.step.evaluate_end) {
        std::memcpy(w.staged.state + begin, w.end_state + begin, bytes);
    } else {
        engine::combine(w.step.row, w.step.h, w.slots(), begin, end, w.staged.state + begin);
        if (w.step.row.keep >= 0) std::memcpy(w.states[static_cast<std::size_t>(w.step.row.keep)] + begin, w.staged.state + begin, bytes);
    }
    if (!layout.ledger) return;
    std::fill_n(w.links.accounts.begin() + model::account_parts * own.first, model::account_parts * own.size(), model::Account{});
}

/// Contact forces of one batch of touching links; as many batches as segments, of equal size whatever the segments hold.
void contact_batch(void* workspace, int batch) noexcept {
    Workspace& w = of(workspace);
    const auto cut = [&](int k) { return static_cast<int>(static_cast<long>(w.tips.touching_count) * k / w.partition.size()); };
    const model::StagedChain chain = w.staged_chain();
    for (int k = cut(batch); k < cut(batch + 1); ++k)
        w.stages.contact(w.variator.chain(), chain, w.tips.touching[static_cast<std::size_t>(k)]);
}

/// Elasticity and plates of one segment's links, joints of the pins strictly between them.
void chain_segment(void* workspace, int segment) noexcept {
    Workspace& w = of(workspace);
    w.stages.chain_forces(w.variator.chain(), w.staged_chain(), w.partition[segment].first, w.partition[segment].last);
}

/// Joint of the pin between a segment and the one before it.
void boundary_pin(void* workspace, int segment) noexcept {
    Workspace& w = of(workspace);
    w.stages.joint(w.variator.chain(), w.staged_chain(), w.partition[segment].first);
}

void forward_segment(void* workspace, int segment) noexcept {
    Workspace& w = of(workspace);
    w.stages.forward(w.variator.chain(), w.staged_chain(), w.partition[segment].first, w.partition[segment].last);
}

void reverse_segment(void* workspace, int segment) noexcept {
    Workspace& w = of(workspace);
    w.stages.reverse(w.variator.chain(), w.staged_chain(), w.partition[segment].first, w.partition[segment].last);
}

/// All segments in one task.
void forward_all(void* workspace, int) noexcept {
    for (int segment = 0; segment < of(workspace).partition.size(); ++segment) forward_segment(workspace, segment);
}

void reverse_all(void* workspace, int) noexcept {
    for (int segment = 0; segment < of(workspace).partition.size(); ++segment) reverse_segment(workspace, segment);
}

void detect_all(void* workspace, int) noexcept {
    for (int segment = 0; segment < of(workspace).partition.size(); ++segment) detect_segment(workspace, segment);
}

/// Numbers of the tasks of each stage.
struct StageTasks {
    std::vector<int> combine, contact, chain, boundary, forward, reverse;
};

[[nodiscard]] Access whole(const Workspace& w, Field field, bool write) { return {static_cast<int>(field), 0, w.layout().links, write}; }

void add_force_stages(engine::TaskGraph& graph, const Workspace& w, StageTasks& tasks) {
    for (int s = 0; s < w.partition.size(); ++s) {
        const std::string number = "[" + std::to_string(s) + "]";
        const auto own = [&] { return LinkAccesses(w, s); };
        tasks.combine.push_back(graph.add({"combine" + number, evaluate_cycle, combine_segment, s,
                                           own()
                                               .own(Field::states_read, false)
                                               .own(Field::slopes_read, false)
                                               .own(Field::end_state, false)
                                               .own(Field::state_kept, true)
                                               .own(Field::stage_state, true)
                                               .own(Field::joint_account, true)
                                               .own(Field::link_account, true)
                                               .own(Field::tip_account, true)
                                               .list()}));
        // Which links a batch holds depends on the phases: what it writes are the tips of those, which no other batch holds.
        tasks.contact.push_back(
            graph.add({"contact" + number,
                       evaluate_cycle,
                       contact_batch,
                       s,
                       {whole(w, Field::stage_state, false), whole(w, Field::phase, false), own().segment(Field::tips, true).list()[0],
                        own().segment(Field::load, true).list()[0], own().segment(Field::tip_account, true).list()[0]},
                       "contact forces"}));
        tasks.chain.push_back(graph.add({"chain" + number, evaluate_cycle, chain_segment, s,
                                         own()
                                             .own(Field::stage_state, false)
                                             .own(Field::slope_written, true)
                                             .own(Field::moment, true)
                                             .inner_pins(Field::joint, true)
                                             .inner_pins(Field::joint_account, true)
                                             .own(Field::link_account, true)
                                             .list(),
                                         "chain forces"}));
        tasks.boundary.push_back(
            graph.add({"boundary" + number, evaluate_cycle, boundary_pin, s,
                       own().with_halo(Field::stage_state).first_pin(Field::joint, true).first_pin(Field::joint_account, true).list(),
                       "boundary pins"}));
    }
}

void add_solve_stages(engine::TaskGraph& graph, const Workspace& w, bool by_segments, StageTasks& tasks) {
    const std::string cholesky = "Cholesky";
    if (!by_segments) {
        const auto all = [&](Field field, bool write) { return whole(w, field, write); };
        tasks.forward.push_back(graph.add({"forward",
                                           evaluate_cycle,
                                           forward_all,
                                           0,
                                           {all(Field::slope_written, true), all(Field::moment, false), all(Field::joint, false),
                                            all(Field::tips, false), all(Field::stage_state, false)},
                                           cholesky}));
        tasks.reverse.push_back(graph.add({"reverse", evaluate_cycle, reverse_all, 0, {all(Field::slope_written, true)}, cholesky}));
        return;
    }
    for (int s = 0; s < w.partition.size(); ++s) {
        const std::string number = "[" + std::to_string(s) + "]";
        auto reads = LinkAccesses(w, s)
                         .own(Field::slope_written, true)
                         .own(Field::moment, false)
                         .with_halo(Field::joint)
                         .own(Field::stage_state, false)
                         .list();
        reads.push_back(whole(w, Field::tips, false));
        tasks.forward.push_back(graph.add({"forward" + number, evaluate_cycle, forward_segment, s, reads, cholesky}));
        tasks.reverse.push_back(graph.add(
            {"reverse" + number, evaluate_cycle, reverse_segment, s, LinkAccesses(w, s).own(Field::slope_written, true).list(), cholesky}));
    }
}

/// Every task of one stage before every task of the next.
void barrier(engine::TaskGraph& graph, const std::vector<int>& before, const std::vector<int>& after) {
    for (const int first : before) {
        for (const int second : after) graph.order(first, second);
    }
}

}  // namespace

engine::TaskGraph staged_graph(const Workspace& w, const AssemblyOptions& options) {
    engine::TaskGraph graph;
    StageTasks tasks;
    add_force_stages(graph, w, tasks);
    add_solve_stages(graph, w, options.parallel_cholesky, tasks);
    barrier(graph, tasks.combine, tasks.contact);
    barrier(graph, tasks.combine, tasks.chain);
    barrier(graph, tasks.contact, tasks.boundary);
    barrier(graph, tasks.chain, tasks.boundary);
    barrier(graph, tasks.boundary, tasks.forward);
    for (std::size_t k = 0; k < tasks.forward.size(); ++k) graph.order(tasks.forward[k], tasks.reverse[k]);
    for (int s = 0; s < w.partition.size(); ++s) add_observe_task(graph, w, s);
    if (options.parallel_transitions) {
        for (int s = 0; s < w.partition.size(); ++s) add_transition_tasks(graph, w, s);
    } else {
        graph.add({"detect", detect_cycle, detect_all, 0, {}, transition_stage});
        for (int s = 0; s < w.partition.size(); ++s) {
            const std::string number = "[" + std::to_string(s) + "]";
            graph.add({"locate" + number, locate_cycle, locate_segment, s, locate_accesses(w, s), transition_stage});
            graph.add({"truncate" + number, truncate_cycle, truncate_segment, s, truncate_accesses(w, s), transition_stage});
        }
    }
    return graph;
}

}  // namespace cvtflow::tasks
