#include "engine/executor/threaded_executors.hpp"

#include <array>

#include "engine/executor/openmp/omp_region.hpp"
#include "engine/executor/reference/barrier.hpp"
#include "engine/executor/tbb/flow.hpp"

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

constexpr std::string_view openmp = "OpenMP";

constexpr std::array rows{
    ExecutorRow{.name = "flow",
                .description = "resident workers in a oneTBB flow graph; shares the machine well",
                .parallel = true,
                .waiting = Waiting::own,
                .make = make<Flow>},
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
};

}  // namespace

std::span<const ExecutorRow> threaded_executors() noexcept { return rows; }

}  // namespace cvtflow::engine
