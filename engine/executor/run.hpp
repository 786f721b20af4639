#pragma once
/// One Executor::run() as the executors see it: the next cycle, and the call of a task. Private to this folder.

#include <cstddef>
#include <span>

#include "engine/executor/executor.hpp"
#include "engine/executor/stamp_recorder.hpp"
#include "engine/thread/executor_options.hpp"

namespace cvtflow::engine {

/// Share `part` of `parts` of a list: contiguous, shares differ by one at most, the first ones are the longer ones.
[[nodiscard]] inline std::span<const int> share(std::span<const int> tasks, int part, int parts) noexcept {
    const auto p = static_cast<std::size_t>(part), count = static_cast<std::size_t>(parts);
    const std::size_t length = tasks.size() / count, longer = tasks.size() % count;
    return tasks.subspan(p * length + (p < longer ? p : longer), length + (p < longer ? 1 : 0));
}

class Run {
public:
    Run(const TaskGraph& graph, void* context, Controller& controller, StampRecorder* recorder) noexcept
        : graph_(graph), context_(context), controller_(controller), recorder_(recorder) {}

    [[nodiscard]] const TaskGraph& graph() const noexcept { return graph_; }

    /// The next cycle that has tasks, or Controller::stop, also if the controller names a cycle that does not exist.
    /// Called by one thread at a time. @param thread number of the caller's track
    [[nodiscard]] int decide(int thread) noexcept;

    void task(int task, int thread) const noexcept {
        const TaskCall call = graph_.call(task);
        if (recorder_ == nullptr) {
            call(context_);
            return;
        }
        const std::int64_t begin = ticks();
        call(context_);
        recorder_->add(thread, task, begin, ticks());
    }
    void tasks(std::span<const int> tasks, int thread) const noexcept {
        for (const int number : tasks) task(number, thread);
    }

    /// @throws std::out_of_range if the controller named a cycle that does not exist
    void reject() const;

private:
    const TaskGraph& graph_;
    void* context_;
    Controller& controller_;
    StampRecorder* recorder_;
    int rejected_ = Controller::stop;
};

/// The cycle `first` and all that follow, all tasks in order, on the calling thread.
inline void run_serially(Run& run, int first) noexcept {
    for (int cycle = first; cycle != Controller::stop; cycle = run.decide(0)) run.tasks(run.graph().topological(cycle), 0);
}

/// Checks, first decision and stamps that all executors share. `execute` runs the cycle `first` and all that follow.
class RunningExecutor : public Executor {
public:
    void run(const TaskGraph& graph, void* context, Controller& controller) final;

protected:
    /// @throws std::invalid_argument for less than one thread or a recorder with fewer tracks than threads
    explicit RunningExecutor(const ExecutorOptions& options);

    /// The graph is frozen; `first` exists and has tasks.
    virtual void execute(Run& run, int first) = 0;

    [[nodiscard]] const ExecutorOptions& options() const noexcept { return options_; }

private:
    ExecutorOptions options_;
};

}  // namespace cvtflow::engine
