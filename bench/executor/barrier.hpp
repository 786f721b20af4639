#pragma once
/// A team of std::jthreads that meets at a barrier after every level: the plainest of the parallel executors, and the one that
/// ThreadSanitizer sees through.

#include "engine/executor/run.hpp"

namespace cvtflow::bench {

/// The team exists during run(); the calling thread is its first member and the only one that calls the controller. It runs without threads
/// that the system refuses to start.
class Barrier final : public engine::RunningExecutor {
public:
    explicit Barrier(const engine::ExecutorOptions& options) : engine::RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "barrier"; }

private:
    void execute(engine::Run& run, int first) override;
};

}  // namespace cvtflow::bench
