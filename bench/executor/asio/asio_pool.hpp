#pragma once
/// Boost.Asio as a thread pool: one queue of handlers, to which tasks are posted when those before them have finished.

#include "engine/executor/run.hpp"

namespace cvtflow::bench {

/// Threads that run one io_context; the calling thread is the first of them. Asio knows no graph: a counter per task says when it is ready,
/// and whoever finishes the last task of a cycle asks the controller. Handlers lie in memory of the run, one place per task, so that
/// nothing is allocated while it lasts. Threads that the system refuses to start are done without.
class AsioPool final : public engine::RunningExecutor {
public:
    explicit AsioPool(const engine::ExecutorOptions& options) : engine::RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "asio_pool"; }

private:
    void execute(engine::Run& run, int first) override;
};

}  // namespace cvtflow::bench
