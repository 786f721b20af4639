#pragma once
/// OpenMP as it is published for this model: forked and joined at every level.

#include "bench/executor/openmp/omp_region.hpp"

namespace cvtflow::bench {

/// One `parallel for` with static schedule per level. Its threads belong to the OpenMP runtime and outlive the run.
/// LLVM's runtime allocates memory in every loop, GNU's does not.
/// GNU's waits pause for milliseconds: when the system puts two threads on one processor a barrier takes 8 ms (measured), unless
/// OMP_WAIT_POLICY=passive is set.
class OmpFork final : public OmpExecutor {
public:
    explicit OmpFork(const engine::ExecutorOptions& options) : OmpExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "omp_fork"; }

private:
    void execute(engine::Run& run, int first) override;
};

}  // namespace cvtflow::bench
