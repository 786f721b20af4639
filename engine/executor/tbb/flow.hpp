#pragma once
/// The main executor: resident workers in a oneTBB flow graph.

#include "engine/executor/run.hpp"

namespace cvtflow::engine {

/// The graph's nodes are workers. Each fires once per run and stays; cycles are opened and tasks claimed on a board in shared memory
/// (resident_board.hpp), which takes 0.1 … 0.4 µs where handing a task to another thread through oneTBB takes about 1 µs.
/// The calling thread is one of the workers. Whether oneTBB sends all others, some or none only matters for speed.
class Flow final : public RunningExecutor {
public:
    explicit Flow(const ExecutorOptions& options) : RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "flow"; }

private:
    void execute(Run& run, int first) override;
};

}  // namespace cvtflow::engine
