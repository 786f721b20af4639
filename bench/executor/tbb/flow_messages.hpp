#pragma once
/// A oneTBB flow graph that persists through the whole run and goes from cycle to cycle by messages: the textbook form.

#include "engine/executor/run.hpp"

namespace cvtflow::bench {

/// One wait per run. Its messages are small tasks from oneTBB's pool, which grows during the first cycles.
class FlowMessages final : public engine::RunningExecutor {
public:
    explicit FlowMessages(const engine::ExecutorOptions& options) : engine::RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "flow_messages"; }

private:
    void execute(engine::Run& run, int first) override;
};

}  // namespace cvtflow::bench
