#pragma once
/// A oneTBB flow graph that is started and waited for in every cycle: the form in which others have used it for right-hand sides
/// (OpenModelica's --parmodauto).

#include "engine/executor/run.hpp"

namespace cvtflow::bench {

/// The graph is built once per run. Its messages are small tasks from oneTBB's pool, which grows during the first cycles.
class FlowPerCycle final : public engine::RunningExecutor {
public:
    explicit FlowPerCycle(const engine::ExecutorOptions& options) : engine::RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "flow_per_cycle"; }

private:
    void execute(engine::Run& run, int first) override;
};

}  // namespace cvtflow::bench
