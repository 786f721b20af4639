#include "bench/executor/openmp/omp_tasks.hpp"

#include <omp.h>

#include <vector>

#include "bench/executor/further_executors.hpp"
#include "engine/thread/floating_mode.hpp"
#include "engine/thread/pinning.hpp"

namespace cvtflow::bench {

using namespace engine;

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
