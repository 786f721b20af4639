#pragma once
/// How one step is taken. The controller decides when a step begins, whether it is accepted and where it is cut; a step method decides
/// which cycles of the task graph lead from the start to the result. StageMethod is the method of tables.

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/graph/task_graph.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// A cycle of the step's graph, or none: the step is taken, or cannot be.
class NextCycle {
public:
    /// A cycle, by its number in the graph.
    constexpr NextCycle(int cycle) noexcept : cycle_(cycle) {}  // methods return their cycles' enumerators

    [[nodiscard]] static constexpr NextCycle done() noexcept { return {Answer::done, 0}; }
    [[nodiscard]] static constexpr NextCycle failed() noexcept { return {Answer::failed, 0}; }

    [[nodiscard]] constexpr bool is_cycle() const noexcept { return answer_ == Answer::cycle; }
    [[nodiscard]] constexpr bool is_done() const noexcept { return answer_ == Answer::done; }
    [[nodiscard]] constexpr bool has_failed() const noexcept { return answer_ == Answer::failed; }
    /// The number of the cycle, if there is one.
    [[nodiscard]] constexpr int cycle() const noexcept { return cycle_; }
    bool operator==(const NextCycle&) const = default;

private:
    enum class Answer { cycle, done, failed };
    constexpr NextCycle(Answer answer, int cycle) noexcept : answer_(answer), cycle_(cycle) {}

    Answer answer_ = Answer::cycle;
    int cycle_;
};

/// What a method keeps between its steps instead of the workspace, which it shows there when it is read.
class InnerState {
public:
    /// The present state and phases to the workspace.
    virtual void show() = 0;
    /// Works and losses of all steps, and energy now.
    [[nodiscard]] virtual const StepAccount& account() = 0;

protected:
    InnerState() = default;
    InnerState(const InnerState&) = default;
    InnerState& operator=(const InnerState&) = default;
    ~InnerState() = default;
};

class StepMethod {
public:
    virtual ~StepMethod() = default;

    /// Begins the step from workspace.states[0] at workspace.step.time over workspace.step.h: the first cycle to run.
    [[nodiscard]] virtual NextCycle begin() = 0;
    /// After every cycle that it has named: the next one; or done, and workspace.step.row combines the result from the slots; or failed,
    /// for which fault() has the reason.
    [[nodiscard]] virtual NextCycle next() = 0;

    /// Adds the method's own cycles to a graph that is not frozen yet, numbered from method_cycles on; their tasks are members of the
    /// method (engine::code_of). Called again whenever segments change.
    virtual void add_tasks(engine::TaskGraph& graph) { (void)graph; }

    /// The workspace's segments have changed.
    virtual void repartitioned() {}

    /// Of a method whose begin() takes a whole step by itself, contacts that begin and end included: nothing is searched for transitions or
    /// combined, and what it keeps is read here. nullptr: the workspace has everything.
    [[nodiscard]] virtual InnerState* inner() noexcept { return nullptr; }

    /// true: at a transition the step is taken again up to there, and the search for it uses positions and velocities at both ends only.
    /// false: the state at a transition is that of the cubic through workspace.states[0], slopes[0], end_state and an evaluation at the
    /// end, so slopes[0] must hold the slope at the start when the step is done.
    [[nodiscard]] virtual bool retakes() const noexcept { return false; }
    /// true, of a method that retakes(): no step is cut. Tips that are due change their phase at its end.
    [[nodiscard]] virtual bool keeps_steps() const noexcept { return false; }
    /// A run begins, or the state was set: discards the memory.
    virtual void restart() noexcept {}
    /// Tips have changed their phase since the last step.
    virtual void transition() noexcept { restart(); }
    /// The step just taken is not good enough; the next one begins where it began, phases and all, and is shorter.
    virtual void rejected() noexcept {}

    /// Row that combines the estimate of the local error from the slots once the step is done; nothing: the method makes none.
    [[nodiscard]] virtual std::optional<engine::PlanStep> error_row() const noexcept { return {}; }
    /// That estimate falls like the step to this power; 0 without an estimate.
    [[nodiscard]] virtual int error_power() const noexcept { return 0; }
    /// Longest step that the method can take now, at most `wanted` [s]. Called before a step of free length.
    [[nodiscard]] virtual double longest_step(double wanted) { return wanted; }

    /// What it remembers from step to step beside the workspace's state, phases and times of their changes, for checkpoints: load() after
    /// restart() continues bitwise from where save() was called. Empty for methods without memory.
    virtual void save(std::vector<double>& memory) const { memory.clear(); }
    /// memory [what save() wrote]
    virtual void load(std::span<const double> memory) { (void)memory; }
    /// Steps between two observations of losses and energies, so that these cost about a hundredth of the steps. The default is that of a
    /// leapfrog, whose step costs as much as five evaluations.
    [[nodiscard]] virtual long observation_stride() const noexcept { return 24; }
    /// Memory that its steps touch beside the workspace [B]; nothing: not counted.
    [[nodiscard]] virtual std::optional<std::size_t> bytes() const noexcept { return {}; }
    /// Why a step failed.
    [[nodiscard]] virtual Fault fault() const noexcept { return {}; }
    /// Counters of the method since its construction, one line for the summary of a run; may be empty.
    [[nodiscard]] virtual std::string report() const { return {}; }

protected:
    StepMethod() = default;
    StepMethod(const StepMethod&) = default;
    StepMethod& operator=(const StepMethod&) = default;
};

/// Ends an evaluation of the right-hand side whose links are done: slope of everything behind the links, and counts it.
/// @param tail state behind the links   @param slope whole slope vector; time [s], tail [unknowns behind the links], slope [unknowns, per
/// second]
void close_evaluation(Workspace& workspace, double time, const double* tail, const model::SheaveForces& chain, double* slope) noexcept;

/// The next numbers of a memory (StepMethod::save), which comes from files and hosts and may be anything; it then begins behind
/// them. @throws std::invalid_argument if there are fewer
[[nodiscard]] std::span<const double> pop_front(std::span<const double>& memory, std::size_t count);

/// The next number as one of first … last. @throws std::invalid_argument if it is out of range
[[nodiscard]] int pop_integer(std::span<const double>& memory, int first, int last);

/// A step by a table of stages (engine::CompiledPlan): one evaluate cycle per stage. Where the last stage is evaluated at the result, its
/// slope is the next step's first, unless a transition or a caller has changed the state in between; where a step was rejected, its
/// first slope still holds. Neither is evaluated again.
class StageMethod : public StepMethod {
public:
    /// Uses the workspace's plan. @param error_power of its error estimate
    explicit StageMethod(Workspace& workspace, int error_power = 0) noexcept
        : w_(workspace), plan_(&workspace.plan), error_power_(error_power) {}

    [[nodiscard]] NextCycle begin() override;
    [[nodiscard]] NextCycle next() override;
    void restart() noexcept override { slope_at_ = SlopeAt::nowhere; }
    void transition() noexcept override { slope_at_ = SlopeAt::nowhere; }
    void rejected() noexcept override { slope_at_ = SlopeAt::start; }
    [[nodiscard]] std::optional<std::size_t> bytes() const noexcept override { return 0; }  // all stages are in the workspace
    void save(std::vector<double>& memory) const override;
    void load(std::span<const double> memory) override;  ///< memory [what save() wrote]
    [[nodiscard]] std::optional<engine::PlanStep> error_row() const noexcept override;
    [[nodiscard]] int error_power() const noexcept override { return error_power_; }
    [[nodiscard]] long observation_stride() const noexcept override { return std::max(1L, 100L / w_.plan.stages()); }

protected:
    /// Takes the following steps with another plan, whose slots the workspace must have. The slope at hand stays good.
    void use(const engine::CompiledPlan& plan) noexcept;

    [[nodiscard]] Workspace& workspace() noexcept { return w_; }

private:
    /// Where the slope at the next step's start is to be found: slope slot 0, or the last stage's.
    enum class SlopeAt { nowhere, start, last };

    int start_stage(int stage);
    void bring_slope() noexcept;

    Workspace& w_;
    const engine::CompiledPlan* plan_;
    int error_power_;
    int stage_ = 0;
    SlopeAt slope_at_ = SlopeAt::nowhere;
};

}  // namespace cvtflow::tasks
