#include "bench/executor/compared_executors.hpp"

#include <oneapi/tbb/task_group.h>

#include <algorithm>
#include <execution>

#include "bench/executor/tbb/pinned_section.hpp"

namespace cvtflow::bench {

using namespace engine;

namespace {

void run_level_by_algorithm(const Run& run, std::span<const int> tasks) {
    if (tasks.size() == 1) {
        run.tasks(tasks, slot());
        return;
    }
    std::for_each(std::execution::par, tasks.begin(), tasks.end(), [&](int task) noexcept { run.task(task, slot()); });
}

}  // namespace

/// The algorithm's context is bound to that of the task around it: here the section's, else the host's, which may be cancelled.
void StdPar::execute(Run& run, int first) {
    PinnedSection section(options());
    section.execute([&](oneapi::tbb::task_group_context& context) {
        oneapi::tbb::task_group(context).run_and_wait([&]() noexcept {
            for (int cycle = first; cycle != Controller::stop; cycle = run.decide(slot())) {
                for (int level = 0; level < run.graph().levels(cycle); ++level)
                    run_level_by_algorithm(run, run.graph().level(cycle, level));
            }
        });
    });
}

}  // namespace cvtflow::bench
