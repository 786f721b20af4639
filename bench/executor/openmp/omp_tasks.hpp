#pragma once
/// OpenMP's tasks with `depend`: its runtime finds out from addresses what our graph already knows.

#include "bench/executor/openmp/omp_region.hpp"

namespace cvtflow::bench {

/// One parallel region for the whole run. Its master creates the tasks of a cycle, each with a dependence on those before it, takes part in
/// them, and asks the controller when all have finished. The threads belong to the OpenMP runtime and outlive the run.
/// The runtime allocates memory for every task of every cycle: what OpenMP calls a task graph is built anew each time.
class OmpTasks final : public OmpExecutor {
public:
    explicit OmpTasks(const engine::ExecutorOptions& options) : OmpExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "omp_tasks"; }

private:
    void execute(engine::Run& run, int first) override;
};

}  // namespace cvtflow::bench
