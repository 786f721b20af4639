#pragma once
/// The one inversion of control: an executor runs cycles of a graph, and between cycles asks a controller which one comes next.

#include <string_view>

#include "engine/graph/task_graph.hpp"

namespace cvtflow::engine {

/// Decides between cycles. Called by one thread at a time, after all tasks of the previous cycle; sees all that they wrote.
class Controller {
public:
    static constexpr int stop = -1;

    virtual ~Controller() = default;
    /// Number of the cycle to run next, or stop.
    [[nodiscard]] virtual int next() noexcept = 0;

protected:
    Controller() = default;
    Controller(const Controller&) = default;
    Controller& operator=(const Controller&) = default;
};

class Executor {
public:
    virtual ~Executor() = default;

    /// Asks the controller for a cycle, runs it, and repeats until the controller returns stop. Allocates nothing per cycle.
    /// @param context handed to every task's body
    /// @throws std::logic_error for a graph that is not frozen; std::out_of_range for a cycle that the graph does not have
    virtual void run(const TaskGraph& graph, void* context, Controller& controller) = 0;

    /// Releases worker threads between runs; the next run creates them again. Called by the thread that called run().
    virtual void release_threads() noexcept {}

    /// Name in the catalogue.
    [[nodiscard]] virtual std::string_view name() const noexcept = 0;

protected:
    Executor() = default;
    Executor(const Executor&) = default;
    Executor& operator=(const Executor&) = default;
};

}  // namespace cvtflow::engine
