#pragma once
/// The method of one step. The controller decides when a step begins, whether it is accepted and where it is cut; a step method decides
/// which cycles of the task graph lead from the start to the result. StageMethod is the method of tables.

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "engine/base/archive.hpp"
#include "engine/graph/task_graph.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// Estimate of the local error of a step.
struct ErrorEstimate {
    int power = 0;           ///< power of the step to which it is proportional; 0: the method estimates none
    engine::PlanStep row{};  ///< row that combines it from the slots once the step is done
};

class StepMethod {
public:
    StepMethod(const StepMethod&) = delete;
    StepMethod& operator=(const StepMethod&) = delete;
    virtual ~StepMethod() = default;

    /// One step from workspace.states[0] at workspace.step.time over workspace.step.h: yields the cycles that it needs. At its end
    /// workspace.step.row combines the result from the slots. A step from where the last one has begun is that step again, only shorter.
    /// @return why it failed; empty: it is taken
    [[nodiscard]] virtual CycleSequence step() = 0;
    [[nodiscard]] virtual AtTransition at_transition() const noexcept { return AtTransition::interpolate; }

    /// Adds the method's cycles to a graph that is not frozen yet, numbered from method_cycles on; their tasks are members of the method
    /// (engine::code_of). Called again whenever segments change.
    virtual void add_tasks(engine::TaskGraph& graph) { (void)graph; }

    /// The workspace's segments have changed.
    virtual void repartitioned() {}

    /// A run begins, or the state was set: discards the memory.
    virtual void restart() noexcept {}
    /// Tips have changed their phase since the last step.
    virtual void phases_changed() noexcept { restart(); }

    [[nodiscard]] virtual ErrorEstimate error_estimate() const noexcept { return {}; }
    /// Longest step that the method can take now, at most `requested` [s]. Called before a step of free length.
    [[nodiscard]] virtual double longest_step(double requested) { return requested; }

    /// A run begins at the workspace's state, after restart().
    virtual void start() {}
    /// All that a state has to keep of the method between two steps, without the workspace's state, phases and times of their changes: what
    /// is read after restart() continues bit for bit.
    virtual void visit(engine::Archive& archive) { (void)archive; }
    /// Steps between two observations of losses and energies, so that these cost about a hundredth of the steps. The default is that of a
    /// leapfrog, whose step costs as much as five evaluations.
    [[nodiscard]] virtual long observation_stride() const noexcept { return 24; }
    /// Memory that its steps touch beside the workspace [B]; nothing: not counted.
    [[nodiscard]] virtual std::optional<std::size_t> bytes() const noexcept { return {}; }
    /// Counters of the method since its construction, one line for the summary of a run; may be empty.
    [[nodiscard]] virtual std::string report() const { return {}; }
    /// Memory for the frame of step().
    [[nodiscard]] FrameMemory* frame_memory() const noexcept { return &frame_; }

protected:
    StepMethod() = default;

private:
    static constexpr std::size_t frame_bytes = 2048;  ///< more than any step() has

    mutable FrameMemory frame_{frame_bytes};
};

/// Ends an evaluation of the right-hand side whose links are done: slope of everything behind the links, and counts it.
/// @param time [s]   @param tail state behind the links   @param slope whole slope vector
void close_evaluation(Workspace& workspace, double time, const double* tail, const model::SheaveForces& chain, double* slope) noexcept;
/// Ends the evaluation in the evaluate cycle of a stage (step.row).
void close_evaluation(Workspace& workspace) noexcept;

/// Chooses the plan of every step of a StageMethod.
class PlanChoice {
public:
    virtual ~PlanChoice() = default;

    /// Plan for the step from workspace.step.time over workspace.step.h, valid until the next call; the workspace must have its slots.
    /// @param again the last step once more, shorter
    [[nodiscard]] virtual const engine::CompiledPlan& choose(bool again) = 0;
    /// StepMethod::longest_step() [s].
    [[nodiscard]] virtual double longest_step(double requested) = 0;

    virtual void restart() noexcept = 0;
    virtual void visit(engine::Archive& archive) = 0;  ///< as StepMethod
};

/// A step by a table of stages (engine::CompiledPlan): one evaluate cycle per stage. Where the last stage is evaluated at the result, its
/// slope is the next step's first, unless a transition or a caller has changed the state in between; where a step was rejected, its
/// first slope still holds. Neither is evaluated again.
class StageMethod final : public StepMethod {
public:
    /// @param error_power of its error estimate   @param choice of the plan; nullptr: the workspace's
    explicit StageMethod(Workspace& workspace, int error_power = 0, std::unique_ptr<PlanChoice> choice = nullptr) noexcept
        : w_(workspace), choice_(std::move(choice)), plan_(&workspace.plan), error_power_(error_power) {}

    [[nodiscard]] CycleSequence step() override;
    void restart() noexcept override;
    void phases_changed() noexcept override {
        slope_at_ = SlopeAt::nowhere;
        begun_ = never;
    }
    [[nodiscard]] double longest_step(double requested) override {
        return choice_ == nullptr ? requested : choice_->longest_step(requested);
    }
    [[nodiscard]] std::optional<std::size_t> bytes() const noexcept override { return 0; }  // all stages are in the workspace
    void visit(engine::Archive& archive) override;
    [[nodiscard]] ErrorEstimate error_estimate() const noexcept override {
        return {error_power_, plan_->has_error() ? plan_->error() : engine::PlanStep{}};
    }
    [[nodiscard]] long observation_stride() const noexcept override {
        return choice_ != nullptr ? 8L : std::max(1L, 100L / w_.plan.stages());  // a chosen plan has a dozen stages and more
    }

private:
    /// Place of the slope at the next step's start: slope slot 0, or the last stage's.
    enum class SlopeAt { nowhere, start, last };
    static constexpr double never = -1e300;  ///< [s]

    void prepare_stage(const engine::PlanStep& stage);
    void bring_slope() noexcept;
    /// Place of the slope at the state: a step that was rejected has left it in slot 0.
    [[nodiscard]] SlopeAt slope_now() const noexcept { return w_.step.time == begun_ ? SlopeAt::start : slope_at_; }

    Workspace& w_;
    const std::unique_ptr<PlanChoice> choice_;
    const engine::CompiledPlan* plan_;  ///< plan of the present or last step
    int error_power_;
    double begun_ = never;  ///< begin of the last step; never: no step since restart() [s]
    SlopeAt slope_at_ = SlopeAt::nowhere;
};

}  // namespace cvtflow::tasks
