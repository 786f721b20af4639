#pragma once
/// The executors that the laboratory compares with those of the program, in the order of their rows in further_executors.cpp.

#include "engine/executor/run.hpp"

namespace cvtflow::bench {

// OpenMP with one parallel region for the whole run.

/// The runtime keeps its threads from run to run. With OMP_WAIT_POLICY=active they wait for the next run on their processors, without end,
/// and other work in between has to share these processors.
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

// A team of std::jthreads that meets at a barrier after every level: the simplest of the parallel executors, and the one that
// ThreadSanitizer can check.

/// The team exists during run(); the calling thread is its first member and the only one that calls the controller. It runs without threads
/// that the system refuses to start.
class Barrier final : public engine::RunningExecutor {
public:
    explicit Barrier(const engine::ExecutorOptions& options) : engine::RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "barrier"; }

private:
    void execute(engine::Run& run, int first) override;
};

// A oneTBB flow graph that persists through the whole run and goes from cycle to cycle by messages: the textbook form.

/// One wait per run. Its messages are small tasks from oneTBB's pool, which grows during the first cycles.
class FlowMessages final : public engine::RunningExecutor {
public:
    explicit FlowMessages(const engine::ExecutorOptions& options) : engine::RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "flow_messages"; }

private:
    void execute(engine::Run& run, int first) override;
};

// A oneTBB flow graph that is started and waited for in every cycle: the form that OpenModelica's --parmodauto uses for right-hand sides.

/// The graph is built once per run. Its messages are small tasks from oneTBB's pool, which grows during the first cycles.
class FlowPerCycle final : public engine::RunningExecutor {
public:
    explicit FlowPerCycle(const engine::ExecutorOptions& options) : engine::RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "flow_per_cycle"; }

private:
    void execute(engine::Run& run, int first) override;
};

// oneTBB as a parallel loop: forked and joined at every level.

/// One parallel_for with static partitioner per level, in a separate arena.
class TbbLoop final : public engine::RunningExecutor {
public:
    explicit TbbLoop(const engine::ExecutorOptions& options) : engine::RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "tbb_loop"; }

private:
    void execute(engine::Run& run, int first) override;
};

// The standard library's parallel algorithms: the simplest parallel code in C++.

/// One std::for_each(std::execution::par) per level. libstdc++ runs it as a parallel_for of oneTBB with the library's choice of chunks; it
/// has to stay in the executor's arena and below its context, neither of which the standard's algorithms take as an argument.
class StdPar final : public engine::RunningExecutor {
public:
    explicit StdPar(const engine::ExecutorOptions& options) : engine::RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "std_par"; }

private:
    void execute(engine::Run& run, int first) override;
};

// OpenMP as it is published for this model: forked and joined at every level.

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

// OpenMP's tasks with `depend`: its runtime derives from addresses the dependences that the graph already has.

/// One parallel region for the whole run. Its master creates the tasks of a cycle, each with a dependence on those before it, takes part in
/// them, and asks the controller when all have finished. The threads belong to the OpenMP runtime and outlive the run.
/// The runtime allocates memory for every task of every cycle: OpenMP builds its task graph again each time.
class OmpTasks final : public OmpExecutor {
public:
    explicit OmpTasks(const engine::ExecutorOptions& options) : OmpExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "omp_tasks"; }

private:
    void execute(engine::Run& run, int first) override;
};

// Boost.Asio as a thread pool: one queue of handlers, to which tasks are posted when those before them have finished.

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

// Taskflow, with the whole run as one of its graphs.

/// One tf::Taskflow for the run, built when it begins: a node per task and, for every cycle, a node that opens it and one that leaves it. A
/// condition task asks the controller and names the cycle to open, so that cycles follow each other inside one run of the graph. The
/// executor's workers exist as long as the run; the calling thread sleeps, since only workers take part. If the system has no thread for a
/// worker, the calling thread runs everything.
class TaskflowGraph final : public engine::RunningExecutor {
public:
    explicit TaskflowGraph(const engine::ExecutorOptions& options) : engine::RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "taskflow"; }

private:
    void execute(engine::Run& run, int first) override;
};

}  // namespace cvtflow::bench
