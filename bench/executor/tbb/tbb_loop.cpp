#include "bench/executor/tbb/tbb_loop.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>

#include "bench/executor/tbb/pinned_section.hpp"

namespace cvtflow::bench {

using namespace engine;

namespace {

void run_level(const Run& run, std::span<const int> tasks, oneapi::tbb::task_group_context& context) {
    if (tasks.size() == 1) {
        run.tasks(tasks, slot());
        return;
    }
    oneapi::tbb::parallel_for(
        std::size_t{0}, tasks.size(), [&](std::size_t i) noexcept { run.task(tasks[i], slot()); }, oneapi::tbb::static_partitioner(),
        context);
}

}  // namespace

void TbbLoop::execute(Run& run, int first) {
    PinnedSection section(options());
    section.execute([&](oneapi::tbb::task_group_context& context) {
        for (int cycle = first; cycle != Controller::stop; cycle = run.decide(0)) {
            for (int level = 0; level < run.graph().levels(cycle); ++level) run_level(run, run.graph().level(cycle, level), context);
        }
    });
}

}  // namespace cvtflow::bench
