#pragma once
/// A step by a table of stages (engine::CompiledPlan): one evaluate cycle per stage. Where the last stage is evaluated at the result, its
/// slope is the next step's first, unless a transition or a caller has changed the state in between; where a step was rejected, its
/// first slope still holds. Neither is evaluated again.

#include <algorithm>

#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

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
