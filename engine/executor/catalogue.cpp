#include "engine/executor/catalogue.hpp"

#include <algorithm>
#include <array>

#include "engine/executor/openmp/omp_fork.hpp"
#include "engine/executor/openmp/omp_region.hpp"
#include "engine/executor/reference/barrier.hpp"
#include "engine/executor/reference/serial.hpp"
#include "engine/executor/tbb/flow.hpp"
#include "engine/executor/tbb/flow_messages.hpp"
#include "engine/executor/tbb/flow_per_cycle.hpp"
#include "engine/executor/tbb/tbb_loop.hpp"

namespace cvtflow::engine {

namespace {

template <class Kind>
std::unique_ptr<Executor> make(const ExecutorOptions& options) {
    return std::make_unique<Kind>(options);
}

constexpr std::array all{
    ExecutorRow{"serial", "one task after the other, on the calling thread", false, make<Serial>},
    ExecutorRow{"flow", "resident workers in a oneTBB flow graph; shares the machine well", true, make<Flow>},
    ExecutorRow{"flow_messages", "oneTBB flow graph for the whole run, messages from cycle to cycle", true, make<FlowMessages>},
    ExecutorRow{"flow_per_cycle", "oneTBB flow graph, started and waited for in every cycle", true, make<FlowPerCycle>},
    ExecutorRow{"tbb_loop", "oneTBB parallel_for at every level", true, make<TbbLoop>},
#ifdef _OPENMP
    ExecutorRow{"omp_fork", "OpenMP parallel for at every level", true, make<OmpFork>},
    ExecutorRow{"omp_region", "one OpenMP region for the whole run, barriers inside", true, make<OmpRegion>},
#endif
    ExecutorRow{"barrier", "own threads that meet at a barrier after every level", true, make<Barrier>},
};

}  // namespace

std::span<const ExecutorRow> executors() noexcept { return all; }

const ExecutorRow* find_executor(std::string_view name) noexcept {
    const auto found = std::find_if(all.begin(), all.end(), [&](const ExecutorRow& row) { return row.name == name; });
    return found == all.end() ? nullptr : &*found;
}

}  // namespace cvtflow::engine
