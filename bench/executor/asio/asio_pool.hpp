#pragma once
/// Boost.Asio as a thread pool: one queue of handlers, to which tasks are posted when those before them have finished.

#include "engine/executor/run.hpp"

namespace cvtflow::bench {

/// Threads that run one io_context; the calling thread is the first of them. Asio has no graphs: a counter per task shows when it is ready,
/// and the thread that finishes the last task of a cycle calls the controller. Handlers are in memory of the run, one place per task, so
/// that nothing is allocated while it lasts. The pool runs without threads that the system refuses to start.
class AsioPool final : public engine::RunningExecutor {
public:
    explicit AsioPool(const engine::ExecutorOptions& options) : engine::RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "asio_pool"; }

private:
    void execute(engine::Run& run, int first) override;
};

}  // namespace cvtflow::bench
