#pragma once
/// The step as a task graph over segments. (ARCHITECTURE.md draws it.)

#include "engine/graph/task_graph.hpp"
#include "tasks/step/assembly/assembly_kind.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// Sub-graphs between which the controller decides.
enum Cycle : int {
    evaluate_cycle,  ///< combine the stage state of own links and halo, forces, accelerations: one slope
    detect_cycle,    ///< combine the step's result, probe its tips: is a transition due, is the state sound
    locate_cycle,    ///< find the earliest transition of each segment on the interpolant
    truncate_cycle,  ///< state at the earliest transition of all, phases changed there
    observe_cycle,   ///< losses and energies of every link at the step's start
    method_cycles,   ///< first number of a step method's own cycles
};

/// Fields of the workspace, for the race check. A unit of range is one link, except for `verdict`: one segment.
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
    verdict,
    secant,  // slopes that a detect cycle makes from the states at both ends: their methods combine results from states alone
    link_error,
    stage_state,
    moment,
    joint,
    tips,
    joint_account,
    link_account,
    tip_account,
    contact,
    velocity_read,
    velocity_kept,
    velocity_slope,
    force,
    impulse  // of friction inside a step
};

struct AssemblyOptions {
    Assembly kind = Assembly::fused;
    bool parallel_cholesky = true;     ///< staged only: forward and reverse pass by segments, else one task each
    bool parallel_transitions = true;  ///< staged only: detection by segments, else one task
    bool operator==(const AssemblyOptions&) const = default;
};

class StepMethod;

/// Graph of a step, with the cycles of `method` if it has any. Frozen. The context of its run is the workspace; `method` must outlive it.
[[nodiscard]] engine::TaskGraph step_graph(const Workspace& workspace, const AssemblyOptions& options, StepMethod* method = nullptr);

/// Graph of the fused assembly: one task per segment and cycle, joints at segment borders computed by both neighbours,
/// a single synchronisation per evaluation. Not frozen. The context of its tasks is the workspace.
[[nodiscard]] engine::TaskGraph fused_graph(const Workspace& workspace);

/// Graph of the staged assembly. Evaluate: combine the stage state by segments; contact forces in uniform batches of touching links beside
/// chain forces by segments; the boundary pins; forward pass; reverse pass. Not frozen.
[[nodiscard]] engine::TaskGraph staged_graph(const Workspace& workspace, const AssemblyOptions& options);

}  // namespace cvtflow::tasks
