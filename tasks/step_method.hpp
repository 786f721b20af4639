#pragma once
/// How one step is taken. The controller decides when a step begins, whether it is accepted and where it is cut; a step method decides which
/// cycles of the task graph lead from the start to the result.

#include "engine/graph/task_graph.hpp"
#include "tasks/workspace.hpp"

namespace cvtflow::tasks {

class StepMethod {
public:
    /// What begin() and next() answer instead of a cycle.
    static constexpr int done = -2;     ///< the step is taken: workspace.row combines its result from the slots
    static constexpr int failed = -3;   ///< it could not be taken: see fault()

    virtual ~StepMethod() = default;

    /// Begins the step from workspace.states[0] at workspace.time over workspace.h: the first cycle to run.
    [[nodiscard]] virtual int begin() = 0;
    /// After every cycle that it has named: the next one, or done, or failed.
    [[nodiscard]] virtual int next() = 0;

    /// Adds the method's own cycles to a graph that is not frozen yet, numbered from method_cycles on. Bodies get the workspace as context
    /// and find the method at workspace.method. Called again whenever segments change.
    virtual void add_tasks(engine::TaskGraph& graph) const { (void)graph; }

    /// true: at a transition the step is taken again up to there, and the search for it uses positions and velocities at both ends only.
    /// false: the state at a transition is that of the cubic through workspace.states[0], slopes[0], end_state and an evaluation at the end,
    /// so slopes[0] must hold the slope at the start when the step is done.
    [[nodiscard]] virtual bool retakes() const noexcept { return false; }
    /// The next step does not begin where the last one ended: a transition has been carried out, or somebody has set the state.
    virtual void restart() noexcept {}
    /// Why a step failed.
    [[nodiscard]] virtual Fault fault() const noexcept { return {}; }

protected:
    StepMethod() = default;
    StepMethod(const StepMethod&) = default;
    StepMethod& operator=(const StepMethod&) = default;
};

/// Ends an evaluation of the right-hand side whose links are done: slope of everything behind the links, and counts it.
/// @param tail state behind the links   @param slope whole slope vector
void close_evaluation(Workspace& workspace, double time, const double* tail, double* slope) noexcept;

}  // namespace cvtflow::tasks
