#pragma once
/// A step by a table of stages (engine::CompiledPlan): one evaluate cycle per stage.

#include "tasks/step_method.hpp"

namespace cvtflow::tasks {

class StageMethod final : public StepMethod {
public:
    /// Uses the workspace's plan.
    explicit StageMethod(Workspace& workspace) noexcept : w_(workspace) {}

    [[nodiscard]] int begin() override { return start_stage(0); }
    [[nodiscard]] int next() override;

private:
    int start_stage(int stage);

    Workspace& w_;
    int stage_ = 0;
};

}  // namespace cvtflow::tasks
