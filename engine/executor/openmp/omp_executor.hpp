#pragma once
/// What executors on OpenMP share: the runtime's threads.

#include "engine/executor/run.hpp"

namespace cvtflow::engine {

/// The runtime keeps its threads from run to run. Where OMP_WAIT_POLICY=active is set they wait for the next one on their processors,
/// without end, and whatever runs in between has these processors not to itself.
class OmpExecutor : public RunningExecutor {
public:
    void release_threads() noexcept override;

protected:
    using RunningExecutor::RunningExecutor;
};

}  // namespace cvtflow::engine
