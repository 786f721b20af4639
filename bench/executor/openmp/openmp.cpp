/// The executors on OpenMP.

#include <omp.h>

#include <memory>
#include <vector>

#include "bench/executor/compared_executors.hpp"
#include "bench/executor/further_executors.hpp"
#include "engine/thread/floating_mode.hpp"
#include "engine/thread/pinning.hpp"

namespace cvtflow::bench {

using namespace engine;

void OmpExecutor::release_threads() noexcept { omp_pause_resource_all(omp_pause_hard); }

namespace {

/// Called by the whole team; all tasks have finished on return. Shares are those of schedule(static), without the loop construct,
/// in which LLVM's runtime allocates memory.
void run_level(const Run& run, std::span<const int> tasks, int thread, int team) noexcept {
    run.tasks(share(tasks, thread, team), thread);
#pragma omp barrier
}

}  // namespace

/// `cycle` is written by the first thread between the last level's barrier and the one that follows the decision; the others read it
/// after that.
void OmpRegion::execute(Run& run, int first) {
    const Processors processors;
    const FloatingMode mode;
    const int threads = team_grant(options().threads);
    int cycle = first;
#pragma omp parallel num_threads(threads)
    {
        const int thread = omp_get_thread_num(), team = omp_get_num_threads();
        const Pin pin(options().pin, processors, thread);
        const FloatingScope scope(mode);
        while (cycle != Controller::stop) {
            for (int level = 0, levels = run.graph().levels(cycle); level < levels; ++level) {
                run_level(run, run.graph().level(cycle, level), thread, team);
            }
#pragma omp master
            cycle = run.decide(thread);
#pragma omp barrier
        }
    }
}

namespace {

/// The team's threads, pinned. Regions of one team size that follow each other have the same threads under the same numbers.
class TeamPins {
public:
    TeamPins(bool requested, int threads) : threads_(threads), pins_(requested ? static_cast<std::size_t>(threads) : 0) {
        if (!requested) return;
#pragma omp parallel num_threads(threads_)
        {
            const int thread = omp_get_thread_num();
            pins_[static_cast<std::size_t>(thread)] = std::make_unique<Pin>(true, processors_, thread);
        }
    }
    ~TeamPins() {
        if (pins_.empty()) return;
#pragma omp parallel num_threads(threads_)
        pins_[static_cast<std::size_t>(omp_get_thread_num())].reset();
    }
    TeamPins(const TeamPins&) = delete;
    TeamPins& operator=(const TeamPins&) = delete;

private:
    int threads_;
    Processors processors_;
    std::vector<std::unique_ptr<Pin>> pins_;
};

void run_level(const Run& run, std::span<const int> tasks, int threads, const FloatingMode& mode) noexcept {
    if (tasks.size() == 1) {
        run.tasks(tasks, 0);
        return;
    }
#pragma omp parallel num_threads(threads)
    {
        const FloatingScope scope(mode);
        const int thread = omp_get_thread_num();
#pragma omp for schedule(static) nowait
        for (std::size_t i = 0; i < tasks.size(); ++i) run.task(tasks[i], thread);
    }
}

}  // namespace

void OmpFork::execute(Run& run, int first) {
    const int threads = team_grant(options().threads);
    const TeamPins pins(options().pin, threads);
    const FloatingMode mode;
    for (int cycle = first; cycle != Controller::stop; cycle = run.decide(0)) {
        for (int level = 0; level < run.graph().levels(cycle); ++level) {
            run_level(run, run.graph().level(cycle, level), threads, mode);
        }
    }
}

namespace {

/// Dependences of a graph for OpenMP: for each task an address that represents its result, and the tasks before it.
class Dependences {
public:
    explicit Dependences(const TaskGraph& graph) : results_(static_cast<std::size_t>(graph.size())), before_(results_.size()) {
        for (int task = 0; task < graph.size(); ++task) {
            for (const int after : graph.successors(task)) before_[static_cast<std::size_t>(after)].push_back(task);
        }
    }
    /// Tasks of a cycle; all have finished on return. Called by one thread of a team.
    void run_cycle(const Run& run, int cycle) noexcept {
        [[maybe_unused]] char* const result = results_.data();  // only in a clause, which GNU does not count
        for (const int task : run.graph().topological(cycle)) {
            const std::vector<int>& list = before_[static_cast<std::size_t>(task)];
            const int count = static_cast<int>(list.size());
            const int* const before = list.data();
#pragma omp task shared(run) depend(out : result[task]) depend(iterator(int i = 0 : count), in : result[before[i]])
            run.task(task, omp_get_thread_num());
        }
#pragma omp taskwait
    }

private:
    std::vector<char> results_;             ///< [task] only their addresses matter
    std::vector<std::vector<int>> before_;  ///< [task]
};

}  // namespace

/// The barrier keeps modes and pins until all tasks are done: the team waits for them there and takes part.
void OmpTasks::execute(Run& run, int first) {
    const Processors processors;
    const FloatingMode mode;
    const int threads = team_grant(options().threads);
    Dependences dependences(run.graph());
#pragma omp parallel num_threads(threads)
    {
        const Pin pin(options().pin, processors, omp_get_thread_num());
        const FloatingScope scope(mode);
#pragma omp master
        for (int cycle = first; cycle != Controller::stop; cycle = run.decide(0)) dependences.run_cycle(run, cycle);
#pragma omp barrier
    }
}

}  // namespace cvtflow::bench
