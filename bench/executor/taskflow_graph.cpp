/// Taskflow, with the whole run as one of its graphs.

#include "bench/executor/compared_executors.hpp"

#include <algorithm>
#include <exception>
#include <memory>
#include <optional>
#include <vector>

#include "engine/thread/pinning.hpp"
#include "engine/thread/worker_threads.hpp"

#if __has_include(<taskflow/taskflow.hpp>)
#include <taskflow/taskflow.hpp>
#define CVTFLOW_HAS_TASKFLOW
#endif

namespace cvtflow::bench {

using namespace engine;

#ifdef CVTFLOW_HAS_TASKFLOW
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

/// The run as a Taskflow, built when it begins: a node per task and, for every cycle, a node that opens it and one that leaves it. `decide`
/// is a condition task, whose result is opened. Leaving a cycle is a condition task as well, since only their edges may lead back.
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

/// The workers exist as long as the run; the calling thread sleeps, since only workers take part. If the system has no thread for a
/// worker, the calling thread runs everything.
void run_taskflow(Run& run, const ExecutorOptions& options, int first) {
    const std::unique_ptr<tf::Executor> executor = start_workers(options);
    if (executor == nullptr) {
        run_serially(run, first);
        return;
    }
    RunFlow flow(run, first, *executor);
    executor->run(flow.flow()).wait();
}

constexpr Way taskflow{"taskflow", run_taskflow};

constexpr auto make_taskflow = make<taskflow>;

std::string taskflow_version() {
    return "Taskflow " + std::to_string(TF_MAJOR_VERSION) + "." + std::to_string(TF_MINOR_VERSION) + "." + std::to_string(TF_PATCH_VERSION);
}

}  // namespace
#else
constexpr std::nullptr_t make_taskflow = nullptr;

[[nodiscard]] static std::string taskflow_version() { return ""; }
#endif

Runtime taskflow_runtime() {
    return {taskflow_version(),
            {{.name = "taskflow",
              .description = "a Taskflow graph for the whole run, a condition task from cycle to cycle",
              .parallel = true,
              .waiting = Waiting::fixed,
              .needs = "Taskflow's headers (-DCVTFLOW_PEERS=FOLDER)",
              .make = make_taskflow}}};
}

}  // namespace cvtflow::bench
