#include "bench/staged/staged_assembly.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tasks/step/step_graph.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::bench {

using namespace tasks;

StagedBuffers::StagedBuffers(const model::ChainLayout& layout)
    : joint_stride(2 * layout.lateral() + 4), tip_stride(layout.link_size() + 1) {
    const std::size_t links = static_cast<std::size_t>(layout.links);
    joints.resize(links * static_cast<std::size_t>(joint_stride));
    tips.resize(links * static_cast<std::size_t>(tip_stride));
    moments.resize(links);
}

StagedFunctions staged_functions(const ChainModel& model, bool observe) {
    const std::vector<CompiledStages> compiled = compiled_stages();
    const auto row = std::ranges::find(compiled, model.isa(), &CompiledStages::isa);
    if (row == compiled.end()) throw std::logic_error("stages are not compiled for the model's instruction set");
    return row->functions(observe);
}

namespace {

using engine::Access;

/// Data that stages keep for later ones, beside the fields of a workspace.
class StagedMemory final : public AssemblyMemory {
public:
    explicit StagedMemory(Workspace& workspace)
        : functions(staged_functions(workspace.variator.chain(), workspace.layout().ledger)),
          state_(static_cast<std::size_t>(workspace.layout().size())),
          buffers_(workspace.layout()),
          w_(workspace) {
        touching_.reserve(static_cast<std::size_t>(workspace.layout().links));
    }

    const StagedFunctions functions;

    [[nodiscard]] double* state() noexcept { return state_.data(); }
    /// Links with a touching tip, ascending.
    [[nodiscard]] const std::vector<int>& touching() const noexcept { return touching_; }
    [[nodiscard]] StagedChain chain() noexcept {
        return {state_.data(),
                w_.pulleys.sheaves,
                w_.tips.phases.data(),
                w_.step.slope_out,
                w_.links.loads.data(),
                &buffers_,
                w_.layout().ledger ? w_.links.accounts.data() : nullptr};
    }
    void phases_changed() noexcept override {
        touching_.clear();
        for (int link = 0; link < w_.layout().links; ++link) {
            const model::Phase* first_phase = w_.tips.phases.data() + model::tips_per_link * link;
            if (std::any_of(first_phase, first_phase + model::tips_per_link,
                            [](model::Phase phase) { return phase != model::Phase::free; }))
                touching_.push_back(link);  // within what was reserved
        }
    }

private:
    model::LineVector<double> state_;  // of the stage, all links
    StagedBuffers buffers_;
    std::vector<int> touching_;
    Workspace& w_;
};

// Its fields, for the race check.
constexpr Field own_field(int number) { return static_cast<Field>(static_cast<int>(Field::further_assembly) + number); }
constexpr Field stage_state = own_field(0), moment = own_field(1), joint = own_field(2), tip_forces = own_field(3);
constexpr Field joint_account = own_field(4), link_account = own_field(5), tip_account = own_field(6);

[[nodiscard]] Workspace& of(void* workspace) noexcept { return *static_cast<Workspace*>(workspace); }
[[nodiscard]] StagedMemory& memory_of(Workspace& w) noexcept { return static_cast<StagedMemory&>(*w.further); }

/// Stage state of one segment's links.
void combine_segment(void* workspace, int segment) noexcept {
    Workspace& w = of(workspace);
    const Segment& bounds = w.partition[segment];
    const model::ChainLayout& layout = w.layout();
    const int begin = layout.link_begin(bounds.first);
    const int end = begin + bounds.size() * layout.link_block();
    double* state = memory_of(w).state() + begin;
    const std::size_t bytes = static_cast<std::size_t>(end - begin) * sizeof(double);
    if (w.step.evaluate_end) {
        std::memcpy(state, w.end_state + begin, bytes);
    } else {
        engine::combine(w.step.row, w.step.h, w.slots(), begin, end, state);
        if (w.step.row.keep >= 0) std::memcpy(w.states[static_cast<std::size_t>(w.step.row.keep)] + begin, state, bytes);
    }
    if (!layout.ledger) return;
    std::fill_n(w.links.accounts.begin() + model::account_parts * bounds.first, model::account_parts * bounds.size(), model::Account{});
}

/// Contact forces of one batch of touching links; as many batches as segments, of equal size whatever the segments hold.
void contact_batch(void* workspace, int batch) noexcept {
    Workspace& w = of(workspace);
    StagedMemory& memory = memory_of(w);
    const auto cut = [&](int k) {
        return memory.touching().size() * static_cast<std::size_t>(k) / static_cast<std::size_t>(w.partition.size());
    };
    const StagedChain chain = memory.chain();
    for (std::size_t k = cut(batch); k < cut(batch + 1); ++k) memory.functions.contact(w.variator.chain(), chain, memory.touching()[k]);
}

/// Elasticity and plates of one segment's links, joints of the pins strictly between them.
void chain_segment(void* workspace, int segment) noexcept {
    Workspace& w = of(workspace);
    memory_of(w).functions.chain_forces(w.variator.chain(), memory_of(w).chain(), w.partition[segment].first, w.partition[segment].last);
}

/// Joint of the pin between a segment and the one before it.
void boundary_pin(void* workspace, int segment) noexcept {
    Workspace& w = of(workspace);
    memory_of(w).functions.joint(w.variator.chain(), memory_of(w).chain(), w.partition[segment].first);
}

void forward_segment(void* workspace, int segment) noexcept {
    Workspace& w = of(workspace);
    memory_of(w).functions.forward(w.variator.chain(), memory_of(w).chain(), w.partition[segment].first, w.partition[segment].last);
}

void reverse_segment(void* workspace, int segment) noexcept {
    Workspace& w = of(workspace);
    memory_of(w).functions.reverse(w.variator.chain(), memory_of(w).chain(), w.partition[segment].first, w.partition[segment].last);
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
        const auto of_links = [&] { return LinkAccesses(w, s); };
        tasks.combine.push_back(graph.add({"combine" + number, evaluate_cycle, combine_segment, s,
                                           of_links()
                                               .inside(Field::states_read, false)
                                               .inside(Field::slopes_read, false)
                                               .inside(Field::end_state, false)
                                               .inside(Field::state_kept, true)
                                               .inside(stage_state, true)
                                               .inside(joint_account, true)
                                               .inside(link_account, true)
                                               .inside(tip_account, true)
                                               .list()}));
        // Which links a batch holds depends on the phases: what it writes are the tips of those, which no other batch holds.
        tasks.contact.push_back(
            graph.add({"contact" + number,
                       evaluate_cycle,
                       contact_batch,
                       s,
                       {whole(w, stage_state, false), whole(w, Field::phase, false), of_links().segment(tip_forces, true).list()[0],
                        of_links().segment(Field::load, true).list()[0], of_links().segment(tip_account, true).list()[0]},
                       "contact forces"}));
    }
}

void add_chain_stages(engine::TaskGraph& graph, const Workspace& w, StageTasks& tasks) {
    for (int s = 0; s < w.partition.size(); ++s) {
        const std::string number = "[" + std::to_string(s) + "]";
        const Segment segment = w.partition[s];  // whose pins have the number of the link behind them
        const auto of_links = [&] { return LinkAccesses(w, s); };
        tasks.chain.push_back(graph.add({"chain" + number, evaluate_cycle, chain_segment, s,
                                         of_links()
                                             .inside(stage_state, false)
                                             .inside(Field::slope_written, true)
                                             .inside(moment, true)
                                             .range(joint, segment.first + 1, segment.last, true)
                                             .range(joint_account, segment.first + 1, segment.last, true)
                                             .inside(link_account, true)
                                             .list(),
                                         "chain forces"}));
        tasks.boundary.push_back(graph.add({"boundary" + number, evaluate_cycle, boundary_pin, s,
                                            of_links()
                                                .with_halo(stage_state)
                                                .range(joint, segment.first, segment.first + 1, true)
                                                .range(joint_account, segment.first, segment.first + 1, true)
                                                .list(),
                                            "boundary pins"}));
    }
}

void add_solve_stages(engine::TaskGraph& graph, const Workspace& w, bool by_segments, StageTasks& tasks) {
    const std::string cholesky = "Cholesky";
    if (!by_segments) {
        const auto all = [&](Field field, bool write) { return whole(w, field, write); };
        tasks.forward.push_back(graph.add(
            {"forward",
             evaluate_cycle,
             forward_all,
             0,
             {all(Field::slope_written, true), all(moment, false), all(joint, false), all(tip_forces, false), all(stage_state, false)},
             cholesky}));
        tasks.reverse.push_back(graph.add({"reverse", evaluate_cycle, reverse_all, 0, {all(Field::slope_written, true)}, cholesky}));
        return;
    }
    for (int s = 0; s < w.partition.size(); ++s) {
        const std::string number = "[" + std::to_string(s) + "]";
        auto reads =
            LinkAccesses(w, s).inside(Field::slope_written, true).inside(moment, false).with_halo(joint).inside(stage_state, false).list();
        reads.push_back(whole(w, tip_forces, false));
        tasks.forward.push_back(graph.add({"forward" + number, evaluate_cycle, forward_segment, s, reads, cholesky}));
        tasks.reverse.push_back(graph.add({"reverse" + number, evaluate_cycle, reverse_segment, s,
                                           LinkAccesses(w, s).inside(Field::slope_written, true).list(), cholesky}));
    }
}

/// Every task of one stage before every task of the next.
void barrier(engine::TaskGraph& graph, const std::vector<int>& before, const std::vector<int>& after) {
    for (const int first : before) {
        for (const int second : after) graph.order(first, second);
    }
}

[[nodiscard]] engine::TaskGraph staged_graph(const Workspace& w, const AssemblyOptions& options) {
    engine::TaskGraph graph;
    StageTasks tasks;
    add_force_stages(graph, w, tasks);
    add_chain_stages(graph, w, tasks);
    add_solve_stages(graph, w, options.parallel_cholesky, tasks);
    barrier(graph, tasks.combine, tasks.contact);
    barrier(graph, tasks.combine, tasks.chain);
    barrier(graph, tasks.contact, tasks.boundary);
    barrier(graph, tasks.chain, tasks.boundary);
    barrier(graph, tasks.boundary, tasks.forward);
    for (std::size_t k = 0; k < tasks.forward.size(); ++k) graph.order(tasks.forward[k], tasks.reverse[k]);
    for (int s = 0; s < w.partition.size(); ++s) add_observe_task(graph, w, s);
    const bool parallel = options.parallel_transitions;
    if (!parallel) graph.add({"detect", detect_cycle, detect_all, 0, {}, transition_stage});
    for (int s = 0; s < w.partition.size(); ++s) add_transition_tasks(graph, w, s, parallel);
    return graph;
}

[[nodiscard]] std::unique_ptr<AssemblyMemory> staged_memory(Workspace& w) { return std::make_unique<StagedMemory>(w); }

}  // namespace

void add_staged_assembly() { add_assembly({staged_graph, staged_memory}); }

}  // namespace cvtflow::bench
