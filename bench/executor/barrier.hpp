#pragma once
/// A team of std::jthreads that meets at a barrier after every level: the plainest of the parallel executors, and the one that
/// ThreadSanitizer sees through.

#include "engine/executor/run.hpp"

namespace cvtflow::bench {

/// The team lives from the beginning of run() to its end; the calling thread is its first member and the only one that meets the
/// controller. Threads that the system refuses to start are done without.
class Barrier final : public engine::RunningExecutor {
public:
    explicit Barrier(const engine::ExecutorOptions& options) : engine::RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "barrier"; }

private:
    void execute(engine::Run& run, int first) override;
};

}  // namespace cvtflow::bench
