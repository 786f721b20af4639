#pragma once
/// oneTBB as a parallel loop: forked and joined at every level.

#include "engine/executor/run.hpp"

namespace cvtflow::engine {

/// One parallel_for with static partitioner per level, in an own arena.
class TbbLoop final : public RunningExecutor {
public:
    explicit TbbLoop(const ExecutorOptions& options) : RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "tbb_loop"; }

private:
    void execute(Run& run, int first) override;
};

}  // namespace cvtflow::engine
