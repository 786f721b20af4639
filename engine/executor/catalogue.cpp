#include "engine/executor/catalogue.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "engine/base/spelling.hpp"
#include "engine/executor/further/asio/asio_pool.hpp"
#include "engine/executor/further/std_par/std_par.hpp"
#include "engine/executor/further/taskflow/taskflow_graph.hpp"
#include "engine/executor/openmp/omp_fork.hpp"
#include "engine/executor/openmp/omp_region.hpp"
#include "engine/executor/openmp/omp_tasks.hpp"
#include "engine/executor/reference/barrier.hpp"
#include "engine/executor/reference/serial.hpp"
#include "engine/executor/tbb/flow.hpp"
#include "engine/executor/tbb/flow_messages.hpp"
#include "engine/executor/tbb/flow_per_cycle.hpp"
#include "engine/executor/tbb/tbb_loop.hpp"

namespace cvtflow::engine {

namespace {

using Make = std::unique_ptr<Executor> (*)(const ExecutorOptions& options);

template <class Kind>
std::unique_ptr<Executor> make(const ExecutorOptions& options) {
    return std::make_unique<Kind>(options);
}

/// nullptr for a kind whose source is not compiled.
template <class Kind, bool compiled>
constexpr Make make_if() {
    if constexpr (compiled)
        return make<Kind>;
    else
        return nullptr;
}

#ifdef _OPENMP
constexpr bool has_openmp = true;
#else
constexpr bool has_openmp = false;
#endif
constexpr bool has_std_par = CVTFLOW_HAS_STD_PAR, has_asio = CVTFLOW_HAS_ASIO, has_taskflow = CVTFLOW_HAS_TASKFLOW;

constexpr std::string_view openmp = "OpenMP";
constexpr std::string_view algorithms = "a standard library whose parallel algorithms run on oneTBB";
constexpr std::string_view asio = "Boost.Asio (Debian: libboost-dev)";
constexpr std::string_view taskflow = "Taskflow's headers (-DCVTFLOW_TASKFLOW=PATH)";

constexpr std::array rows{
    ExecutorRow{.name = "serial",
                .description = "one task after the other, on the calling thread",
                .parallel = false,
                .waiting = Waiting::fixed,
                .make = make<Serial>},
    ExecutorRow{.name = "flow",
                .description = "resident workers in a oneTBB flow graph; shares the machine well",
                .parallel = true,
                .waiting = Waiting::own,
                .make = make<Flow>},
    ExecutorRow{.name = "flow_messages",
                .description = "oneTBB flow graph for the whole run, messages from cycle to cycle",
                .parallel = true,
                .waiting = Waiting::fixed,
                .make = make<FlowMessages>},
    ExecutorRow{.name = "flow_per_cycle",
                .description = "oneTBB flow graph, started and waited for in every cycle",
                .parallel = true,
                .waiting = Waiting::fixed,
                .make = make<FlowPerCycle>},
    ExecutorRow{.name = "tbb_loop",
                .description = "oneTBB parallel_for at every level",
                .parallel = true,
                .waiting = Waiting::fixed,
                .make = make<TbbLoop>},
    ExecutorRow{.name = "std_par",
                .description = "std::for_each(std::execution::par) at every level",
                .parallel = true,
                .waiting = Waiting::fixed,
                .needs = algorithms,
                .make = make_if<StdPar, has_std_par>()},
    ExecutorRow{.name = "omp_fork",
                .description = "OpenMP parallel for at every level",
                .parallel = true,
                .waiting = Waiting::environment,
                .needs = openmp,
                .make = make_if<OmpFork, has_openmp>()},
    ExecutorRow{.name = "omp_region",
                .description = "one OpenMP region for the whole run, barriers inside",
                .parallel = true,
                .waiting = Waiting::environment,
                .needs = openmp,
                .make = make_if<OmpRegion, has_openmp>()},
    ExecutorRow{.name = "omp_tasks",
                .description = "OpenMP tasks with depend, created anew in every cycle",
                .parallel = true,
                .waiting = Waiting::environment,
                .needs = openmp,
                .make = make_if<OmpTasks, has_openmp>()},
    ExecutorRow{.name = "asio_pool",
                .description = "Boost.Asio: a pool of threads, tasks posted when they are ready",
                .parallel = true,
                .waiting = Waiting::fixed,
                .needs = asio,
                .make = make_if<AsioPool, has_asio>()},
    ExecutorRow{.name = "taskflow",
                .description = "a Taskflow graph for the whole run, a condition task from cycle to cycle",
                .parallel = true,
                .waiting = Waiting::fixed,
                .needs = taskflow,
                .make = make_if<TaskflowGraph, has_taskflow>()},
    ExecutorRow{.name = "barrier",
                .description = "own threads that meet at a barrier after every level",
                .parallel = true,
                .waiting = Waiting::own,
                .make = make<Barrier>},
};

bool is_present(const ExecutorRow& row) { return row.make != nullptr; }

/// Those that are present first, else in the order above. (Not at compile time: with -fsanitize=undefined g++ 12 does not take the address
/// of a function for a constant.)
struct Catalogue {
    std::array<ExecutorRow, rows.size()> all = rows;
    std::size_t present = static_cast<std::size_t>(std::stable_partition(all.begin(), all.end(), is_present) - all.begin());
};

const Catalogue& catalogue() {
    static const Catalogue sorted;
    return sorted;
}

}  // namespace

std::span<const ExecutorRow> executors() noexcept { return std::span(catalogue().all).first(catalogue().present); }

std::span<const ExecutorRow> absent_executors() noexcept { return std::span(catalogue().all).subspan(catalogue().present); }

const ExecutorRow* find_executor(std::string_view name) noexcept {
    const auto there = executors();
    const auto found = std::find_if(there.begin(), there.end(), [&](const ExecutorRow& row) { return row.name == name; });
    return found == there.end() ? nullptr : &*found;
}

std::string missing_executor(std::string_view name, std::span<const std::string_view> others) {
    for (const ExecutorRow& row : absent_executors()) {
        if (row.name == name) return ": it needs " + std::string(row.needs) + ", which was not found when this program was built";
    }
    std::vector<std::string> names(others.begin(), others.end());
    for (const ExecutorRow& row : executors()) names.emplace_back(row.name);
    return did_you_mean(closest(std::string(name), names));
}

}  // namespace cvtflow::engine
