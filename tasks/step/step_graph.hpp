#pragma once
/// The step as a task graph over segments (ARCHITECTURE.md draws it), the accesses that its tasks declare for the race check, and the
/// bodies of its tasks: work of a segment in each cycle (context is the workspace, item the segment), and the data of links, their
/// neighbours and their tips that it reads.

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "engine/graph/task_graph.hpp"
#include "model/contact/friction_operator.hpp"
#include "tasks/step/assembly/assembly_kind.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// Sub-graphs between which the controller decides.
enum Cycle : int {
    evaluate_cycle,  ///< combine the stage state of the segment's links and halo, forces, accelerations: one slope
    detect_cycle,    ///< combine the step's result, probe its tips: is a transition due, is the state sound
    locate_cycle,    ///< find the earliest transition of each segment on the interpolant
    truncate_cycle,  ///< state at the earliest transition of all, phases changed there
    observe_cycle,   ///< losses and energies of every link at the step's start
    method_cycles,   ///< first number of the cycles of a step method
};

/// Fields of the workspace, for the race check. A unit of range is one link, except for `result`: one segment.
enum class Field {
    states_read,
    slopes_read,
    slope_written,
    state_kept,
    end_state,
    cut_state,
    window,
    load,
    account,
    phase,
    before,
    after,
    result,
    secant,  // slopes that a detect cycle or a method makes from the states at both ends: their methods combine results from states alone
    link_error,
    contact,
    velocity_read,
    velocity_kept,
    force,
    mean_tip_force,   // of friction inside a step
    further_assembly  // first number of its fields
};

struct AssemblyOptions {
    Assembly kind = Assembly::fused;
    bool parallel_cholesky = true;     ///< staged only: forward and reverse pass by segments, else one task each
    bool parallel_transitions = true;  ///< staged only: detection by segments, else one task
    bool operator==(const AssemblyOptions&) const = default;
};

class StepMethod;

/// Accesses of a segment to fields over links: its range, and that range with the layout's halo on each side (cyclic).
class LinkAccesses {
public:
    LinkAccesses(const Workspace& w, int segment) : layout_(w.layout()), own_(w.partition[segment]), segment_(segment) {}

    LinkAccesses& inside(Field field, bool write) { return range(field, own_.first, own_.last, write); }
    LinkAccesses& with_halo(Field field) { return with_halo(field, layout_.halo()); }
    /// Reads of the range and of the neighbours that contact of its tips depends on.
    LinkAccesses& with_near(Field field) { return with_halo(field, layout_.probe_halo()); }
    LinkAccesses& segment(Field field, bool write) { return range(field, segment_, segment_ + 1, write); }
    LinkAccesses& range(Field field, int begin, int end, bool write) {
        if (begin < end) list_.push_back({static_cast<int>(field), begin, end, write});
        return *this;
    }
    [[nodiscard]] std::vector<engine::Access> list() const { return list_; }

private:
    LinkAccesses& with_halo(Field field, int halo) {
        inside(field, false);
        for (int k = 0; k < std::min(halo, layout_.links - own_.size()); ++k) {
            neighbour(field, layout_.wrapped(own_.first - 1 - k));
            neighbour(field, layout_.wrapped(own_.last + k));
        }
        return *this;
    }
    void neighbour(Field field, int link) { range(field, link, link + 1, false); }

    const model::ChainLayout& layout_;
    Segment own_;
    int segment_;
    std::vector<engine::Access> list_;
};

/// Observation of one segment at the step's start: the same in every assembly.
void add_observe_task(engine::TaskGraph& graph, const Workspace& workspace, int segment);
/// Name of the three cycles about transitions in profiles.
inline constexpr const char* transition_stage = "transition";
/// Detection, location and truncation of one segment: the same in every assembly. @param detect false: without the first
void add_transition_tasks(engine::TaskGraph& graph, const Workspace& workspace, int segment, bool detect = true);

/// An assembly that a program knows beyond the product's (bench/staged).
struct FurtherAssembly {
    /// Makes the graph, which is not frozen. The context of its tasks is the workspace.
    engine::TaskGraph (*graph)(const Workspace& workspace, const AssemblyOptions& options);
    std::unique_ptr<AssemblyMemory> (*memory)(Workspace& workspace);
};
/// Adds Assembly::staged, once per process, before any workspace is made.
void add_assembly(const FurtherAssembly& staged);
/// Whether this program has it.
[[nodiscard]] bool has_assembly(Assembly kind) noexcept;
/// nullptr if there is no further assembly.
[[nodiscard]] std::unique_ptr<AssemblyMemory> further_memory(Workspace& workspace);

/// Graph of a step, with the cycles of `method` if it has any. Frozen. The context of its run is the workspace; `method` must outlive it.
/// @throws std::invalid_argument for an assembly that this program does not have
[[nodiscard]] engine::TaskGraph step_graph(const Workspace& workspace, const AssemblyOptions& options, StepMethod* method = nullptr);

// Work of segments.

/// Stage state of a segment's links and of `halo` links on each side, as workspace.step.row combines it, in the segment's window, which is
/// returned.
const double* fill_window(Workspace& workspace, int segment, int halo) noexcept;

/// A link of pin halves beside a segment, which follows it by itself.
struct alignas(model::cache_line) GhostLink {
    using Block = std::array<double, model::max_link_block>;
    Block start, slope;  ///< state and slope of which workspace.step.row is made
    Block middle;        ///< result of the last row
    Block before;        ///< state at the start of the step before
};

/// fill_window() with the halo of the layout, by a kernel, where workspace.step.row is a state plus a multiple of a slope.
/// @param ghosts [2] the links before and behind the segment; nullptr: the workspace's slots have them
const double* advance_window(Workspace& workspace, int segment, model::LinkAdvance* kernel, GhostLink* ghosts) noexcept;

/// A link and those of its neighbours that its tips depend on, at a time between those of states that are kept.
struct NearBlocks {
    static constexpr int most = 2 * model::ChainLayout{.rigid = true}.probe_halo() + 1;
    double numbers[most * model::max_link_block];

    [[nodiscard]] double* place(const model::ChainLayout& layout, int from_link) noexcept {
        return numbers + (layout.probe_halo() + from_link) * layout.link_block();
    }
};

inline void show(const model::TipProbe& probe, model::TipIndicator* tips) noexcept {
    for (int tip = 0; tip < model::tips_per_link; ++tip) tips[tip] = {probe.depth[tip], probe.slip[tip]};
}

/// The four tips of a link whose state is given.
inline void indicate(const Workspace& w, const double* state, const model::SheaveMotion* sheaves, model::TipIndicator* tips,
                     model::TipProbe& probe) noexcept {
    w.variator.chain().probe(state, sheaves, w.parameters.detail.stick_slip, probe);
    show(probe, tips);
}

/// Whether a tip may change in this step: it will have kept its phase for the dwell time. The answer does not depend on cuts of the step.
[[nodiscard]] inline bool may_change(const Workspace& w, int tip) noexcept {
    return w.step.search_until - w.tips.changed[at(tip)] >= w.step.dwell;
}

/// Faster than sound in steel (5.9 km/s): no chain does that, so the integration has become unstable, long before anything is infinite.
inline constexpr double fastest_pin = 1e4;  // m/s
/// Whether the state behind the links is finite at the step's end.
[[nodiscard]] Fault check_tail(const Workspace& workspace) noexcept;
/// The first fault in a state of the whole chain: not finite, too fast, or tips where contact cannot be described. state [unknowns]
[[nodiscard]] Fault find_fault(const Workspace& workspace, const double* state) noexcept;

/// State behind the links at the step's end, as workspace.step.row combines it; with slopes from states also those, at both ends.
void close_tail(Workspace& workspace) noexcept;

/// Stage state of the segment and its halo, forces, slope of its links.
void evaluate_segment(void* workspace, int segment) noexcept;
/// Losses and stored energies of its links at the step's start, kinetic ones too, into workspace.links.accounts; on
/// workspace.pulleys.observed_sheaves.
void observe_segment(void* workspace, int segment) noexcept;
/// Result of the step for its links; their tips at the step's end.
void detect_segment(void* workspace, int segment) noexcept;
/// Earliest transition of its tips.
void locate_segment(void* workspace, int segment) noexcept;
/// State of its links at theta; its tips take the phase that is due there.
void truncate_segment(void* workspace, int segment) noexcept;

}  // namespace cvtflow::tasks
