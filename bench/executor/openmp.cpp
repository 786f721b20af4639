/// The executors on OpenMP. Its threads belong to the runtime, which keeps them from run to run. With OMP_WAIT_POLICY=active they wait for
/// the next run on their processors, without end, and other work in between has to share these processors, unless release_threads() ends
/// them. GNU's waits pause for milliseconds: when the system puts two threads on one processor a barrier takes 8 ms (measured), unless
/// OMP_WAIT_POLICY=passive is set.

#include <algorithm>
#include <memory>
#include <vector>

#include "bench/executor/compared_executors.hpp"
#include "bench/executor/further_executors.hpp"
#include "engine/thread/floating_mode.hpp"
#include "engine/thread/pinning.hpp"
#include "engine/thread/worker_threads.hpp"

#ifdef _OPENMP
#include <dlfcn.h>
#include <omp.h>
#endif

namespace cvtflow::bench {

using namespace engine;

int team_grant(int threads) noexcept {
    thread_local int known = 1;
    if (threads > known) known += startable_threads(threads - known);
    const int granted = std::min(threads, known);
    if (granted < threads) note_shortage(threads, granted);
    return granted;
}

#ifdef _OPENMP
namespace {

void release_threads() noexcept { omp_pause_resource_all(omp_pause_hard); }

/// Called by the whole team; all tasks have finished on return. Shares are those of schedule(static), without the loop construct,
/// in which LLVM's runtime allocates memory.
void run_level(const Run& run, std::span<const int> tasks, int thread, int team) noexcept {
    run.tasks(share(tasks, thread, team), thread);
#pragma omp barrier
}

/// Levels end at OpenMP's barriers; the calling thread meets the controller between two of them. `cycle` is written by the first
/// thread between the last level's barrier and the one that follows the decision; the others read it after that.
void run_region(Run& run, const ExecutorOptions& options, int first) {
    const Processors processors;
    const FloatingMode mode;
    const int threads = team_grant(options.threads);
    int cycle = first;
#pragma omp parallel num_threads(threads)
    {
        const int thread = omp_get_thread_num(), team = omp_get_num_threads();
        const Pin pin(options.pin, processors, thread);
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

/// The form that is published for this model: one `parallel for` with static schedule per level. LLVM's runtime allocates memory in every
/// loop, GNU's does not.
void run_forks(Run& run, const ExecutorOptions& options, int first) {
    const int threads = team_grant(options.threads);
    const TeamPins pins(options.pin, threads);
    const FloatingMode mode;
    for (int cycle = first; cycle != Controller::stop; cycle = run.decide(0)) {
        for (int level = 0; level < run.graph().levels(cycle); ++level) {
            run_level(run, run.graph().level(cycle, level), threads, mode);
        }
    }
}

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

/// OpenMP's tasks with `depend`: its runtime derives from addresses the dependences that the graph already has, and allocates memory for
/// every task of every cycle. The master creates the tasks of a cycle, takes part in them, and asks the controller when all have finished.
/// The barrier keeps modes and pins until all tasks are done: the team waits for them there and takes part.
void run_tasks(Run& run, const ExecutorOptions& options, int first) {
    const Processors processors;
    const FloatingMode mode;
    const int threads = team_grant(options.threads);
    Dependences dependences(run.graph());
#pragma omp parallel num_threads(threads)
    {
        const Pin pin(options.pin, processors, omp_get_thread_num());
        const FloatingScope scope(mode);
#pragma omp master
        for (int cycle = first; cycle != Controller::stop; cycle = run.decide(0)) dependences.run_cycle(run, cycle);
#pragma omp barrier
    }
}

constexpr Way omp_region{"omp_region", run_region, release_threads}, omp_fork{"omp_fork", run_forks, release_threads},
    omp_tasks{"omp_tasks", run_tasks, release_threads};

constexpr auto make_region = make<omp_region>, make_fork = make<omp_fork>, make_tasks = make<omp_tasks>;

}  // namespace

std::string openmp_version() {
    Dl_info library{};
    const void* entry = dlsym(RTLD_DEFAULT, "GOMP_parallel");  // of the library that regions enter: LLVM's has it, too
    const std::string file = entry != nullptr && dladdr(entry, &library) != 0 ? library.dli_fname : "an unknown library";
    return std::to_string(_OPENMP) + " of " + file.substr(file.rfind('/') + 1);
}
#else
constexpr std::nullptr_t make_region = nullptr, make_fork = nullptr, make_tasks = nullptr;

std::string openmp_version() { return "none"; }
#endif

Runtime openmp_runtime() {
    const auto row = [](std::string_view name, std::string_view description, auto make_it) {
        return ExecutorRow{name, description, true, Waiting::environment, "OpenMP", make_it};
    };
    return {openmp_version() == "none" ? "" : "OpenMP " + openmp_version(),
            {row("omp_region", "one OpenMP region for the whole run, barriers inside", make_region),
             row("omp_fork", "OpenMP parallel for at every level", make_fork),
             row("omp_tasks", "OpenMP tasks with depend, created anew in every cycle", make_tasks)}};
}

}  // namespace cvtflow::bench
