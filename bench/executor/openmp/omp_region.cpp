#include "bench/executor/openmp/omp_region.hpp"

#include <omp.h>

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

}  // namespace cvtflow::bench
