#pragma once
/// Taskflow, with the whole run as one of its graphs.

#include "engine/executor/run.hpp"

namespace cvtflow::bench {

/// One tf::Taskflow for the run, built when it begins: a node per task and, for every cycle, a node that opens it and one that leaves it. A
/// condition task asks the controller and names the cycle to open, so that cycles follow each other inside one run of the graph. The
/// executor's workers live as long as the run; the calling thread sleeps meanwhile, since Taskflow lets none but its workers take part.
/// Where the system has no thread for a worker the calling thread runs everything.
class TaskflowGraph final : public engine::RunningExecutor {
public:
    explicit TaskflowGraph(const engine::ExecutorOptions& options) : engine::RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "taskflow"; }

private:
    void execute(engine::Run& run, int first) override;
};

}  // namespace cvtflow::bench
