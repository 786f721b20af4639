#include "bench/executor/compared_executors.hpp"

#include <algorithm>
#include <exception>
#include <memory>
#include <optional>
#include <taskflow/taskflow.hpp>
#include <vector>

#include "engine/thread/pinning.hpp"
#include "engine/thread/worker_threads.hpp"

namespace cvtflow::bench {

using namespace engine;

namespace {

/// Pins workers for their lifetime.
class WorkerPins final : public tf::WorkerInterface {
public:
    WorkerPins(bool requested, int workers) : requested_(requested), pins_(static_cast<std::size_t>(workers)) {}
    void scheduler_prologue(tf::Worker& worker) override {
        pins_[worker.id()].emplace(requested_, processors_, static_cast<int>(worker.id()));
    }
    void scheduler_epilogue(tf::Worker& worker, std::exception_ptr /*none: bodies do not throw*/) override { pins_[worker.id()].reset(); }

private:
    bool requested_;
    Processors processors_;
    std::vector<std::optional<Pin>> pins_;  ///< [worker]
};

/// The run as a Taskflow: `decide` is a condition task, whose result is opened. Leaving a cycle is a condition task as well, since only
/// their edges may lead back.
///
///     begin ─► decide ┄► open[c] ─► tasks of the cycle ─► leave[c] ┄► decide … or nothing, at the end
class RunFlow {
public:
    RunFlow(Run& run, int first, const tf::Executor& executor) : run_(run), next_(first), executor_(executor) {
        for (int task = 0; task < run.graph().size(); ++task)
            tasks_.push_back(flow_.emplace([this, task]() noexcept { run_.task(task, thread()); }));
        for (int task = 0; task < run.graph().size(); ++task) {
            for (const int after : run.graph().successors(task)) node(task).precede(node(after));
        }
        tf::Task begin = flow_.emplace([] {});
        tf::Task decide = flow_.emplace([this]() noexcept { return next_; });  // an index that no successor has ends the flow
        begin.precede(decide);
        for (int cycle = 0; cycle < run.graph().cycles(); ++cycle) decide.precede(cycle_between(cycle, decide));
    }
    [[nodiscard]] tf::Taskflow& flow() noexcept { return flow_; }

private:
    /// @return the node that opens the cycle
    tf::Task cycle_between(int cycle, tf::Task& decide) {
        tf::Task open = flow_.emplace([] {});
        if (run_.graph().topological(cycle).empty()) return open;  // never asked for; a node that nothing precedes would run at once
        tf::Task leave = flow_.emplace([this]() noexcept {
            next_ = run_.decide(thread());
            return 0;
        });
        for (const int task : run_.graph().topological(cycle)) {
            if (run_.graph().predecessor_count(task) == 0) open.precede(node(task));
            if (run_.graph().successors(task).empty()) node(task).precede(leave);
        }
        leave.precede(decide);
        return open;
    }
    [[nodiscard]] tf::Task& node(int task) noexcept { return tasks_[static_cast<std::size_t>(task)]; }
    [[nodiscard]] int thread() const noexcept { return executor_.this_worker_id(); }

    Run& run_;
    int next_;
    const tf::Executor& executor_;
    tf::Taskflow flow_;
    std::vector<tf::Task> tasks_;
};

/// nullptr: the system has no thread for a worker.
std::unique_ptr<tf::Executor> start_workers(const ExecutorOptions& options) {
    const int workers = startable_threads(options.threads);
    if (workers < options.threads) note_shortage(options.threads, std::max(1, workers));
    if (workers == 0) return nullptr;
    try {
        return std::make_unique<tf::Executor>(static_cast<std::size_t>(workers), std::make_shared<WorkerPins>(options.pin, workers));
    } catch (const std::exception&) {
        note_shortage(options.threads, 1);  // a thread went between our trial and its start
        return nullptr;
    }
}

}  // namespace

void TaskflowGraph::execute(Run& run, int first) {
    const std::unique_ptr<tf::Executor> executor = start_workers(options());
    if (executor == nullptr) {
        run_serially(run, first);
        return;
    }
    RunFlow flow(run, first, *executor);
    executor->run(flow.flow()).wait();
}

}  // namespace cvtflow::bench
