#include "bench/executor/further_executors.hpp"

#include <algorithm>
#include <array>
#include <memory>

#include "bench/executor/compared_executors.hpp"
#include "engine/executor/catalogue.hpp"
#include "engine/thread/worker_threads.hpp"

#if CVTFLOW_HAS_ASIO
#include <boost/version.hpp>
#endif
#if CVTFLOW_HAS_TASKFLOW
#include <taskflow/taskflow.hpp>
#endif

namespace cvtflow::bench {

namespace {

using engine::ExecutorRow, engine::Waiting;

using Make = std::unique_ptr<engine::Executor> (*)(const engine::ExecutorOptions& options);

template <class Kind>
std::unique_ptr<engine::Executor> make(const engine::ExecutorOptions& options) {
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
constexpr std::string_view taskflow = "Taskflow's headers (-DCVTFLOW_PEERS=FOLDER)";

constexpr std::array rows{
    ExecutorRow{.name = "omp_region",
                .description = "one OpenMP region for the whole run, barriers inside",
                .parallel = true,
                .waiting = Waiting::environment,
                .needs = openmp,
                .make = make_if<OmpRegion, has_openmp>()},
    ExecutorRow{.name = "barrier",
                .description = "own threads that meet at a barrier after every level",
                .parallel = true,
                .waiting = Waiting::own,
                .make = make<Barrier>},
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
};

[[maybe_unused]] std::string version_text(int major, int minor, int patch) {
    return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

}  // namespace

void add_further_executors() {
    static const bool once = (engine::add_executors(rows), true);
    static_cast<void>(once);
}

std::string openmp_version() {
#ifdef _OPENMP
    return std::to_string(_OPENMP);
#else
    return "none";
#endif
}

std::string asio_version() {
#if CVTFLOW_HAS_ASIO
    return version_text(BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000, BOOST_VERSION % 100);
#else
    return "none";
#endif
}

std::string taskflow_version() {
#if CVTFLOW_HAS_TASKFLOW
    return version_text(TF_MAJOR_VERSION, TF_MINOR_VERSION, TF_PATCH_VERSION);
#else
    return "none";
#endif
}

int team_grant(int threads) noexcept {
    thread_local int known = 1;
    if (threads > known) known += engine::startable_threads(threads - known);
    const int granted = std::min(threads, known);
    if (granted < threads) engine::note_shortage(threads, granted);
    return granted;
}

std::string runtime_versions() {
    std::string text = "oneTBB " + engine::tbb_version();
    if (openmp_version() != "none") text += "; OpenMP " + openmp_version();
    if (asio_version() != "none") text += "; Boost " + asio_version();
    if (taskflow_version() != "none") text += "; Taskflow " + taskflow_version();
    return text;
}

}  // namespace cvtflow::bench
