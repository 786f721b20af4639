#pragma once
/// oneTBB as a parallel loop: forked and joined at every level.

#include "engine/executor/run.hpp"

namespace cvtflow::bench {

/// One parallel_for with static partitioner per level, in an own arena.
class TbbLoop final : public engine::RunningExecutor {
public:
    explicit TbbLoop(const engine::ExecutorOptions& options) : engine::RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "tbb_loop"; }

private:
    void execute(engine::Run& run, int first) override;
};

}  // namespace cvtflow::bench
