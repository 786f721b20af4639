#include "bench/executor/openmp/omp_fork.hpp"

#include <omp.h>

#include <memory>
#include <vector>

#include "bench/executor/further_executors.hpp"
#include "engine/thread/floating_mode.hpp"
#include "engine/thread/pinning.hpp"

namespace cvtflow::bench {

using namespace engine;

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

}  // namespace cvtflow::bench
