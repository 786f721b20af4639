#pragma once
/// The step as a task graph over segments (ARCHITECTURE.md draws it), and the accesses that its tasks declare for the race check.

#include <algorithm>
#include <memory>
#include <vector>

#include "engine/graph/task_graph.hpp"
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

}  // namespace cvtflow::tasks
