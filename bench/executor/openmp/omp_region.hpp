#pragma once
/// OpenMP with one parallel region for the whole run.

#include "engine/executor/run.hpp"

namespace cvtflow::bench {

/// The runtime keeps its threads from run to run. Where OMP_WAIT_POLICY=active is set they wait for the next one on their processors,
/// without end, and whatever runs in between has these processors not to itself.
class OmpExecutor : public engine::RunningExecutor {
public:
    void release_threads() noexcept override;

protected:
    using engine::RunningExecutor::RunningExecutor;
};

/// Levels end at OpenMP's barriers; the calling thread meets the controller between two of them. The threads belong to the OpenMP
/// runtime and outlive the run.
/// GNU's waits pause for milliseconds: when the system puts two threads on one processor a barrier takes 8 ms (measured), unless
/// OMP_WAIT_POLICY=passive is set.
class OmpRegion final : public OmpExecutor {
public:
    explicit OmpRegion(const engine::ExecutorOptions& options) : OmpExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "omp_region"; }

private:
    void execute(engine::Run& run, int first) override;
};

}  // namespace cvtflow::bench
