#pragma once
/// The reference executor: one task after the other.

#include "engine/executor/run.hpp"

namespace cvtflow::engine {

/// Runs every cycle in its topological order, on the calling thread.
class Serial final : public RunningExecutor {
public:
    explicit Serial(const ExecutorOptions& options = {}) : RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "serial"; }

private:
    void execute(Run& run, int first) override { run_serially(run, first); }
};

}  // namespace cvtflow::engine
