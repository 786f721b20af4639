#include "engine/executor/catalogue.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "engine/base/spelling.hpp"
#include "engine/executor/openmp/omp_region.hpp"
#include "engine/executor/reference/barrier.hpp"
#include "engine/executor/reference/serial.hpp"
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

/// Those that are present first, else in the order in which they came.
struct Catalogue {
    std::vector<ExecutorRow> all{rows.begin(), rows.end()};
    std::size_t present = 0;

    Catalogue() { sort(); }
    void sort() {
        const auto is_present = [](const ExecutorRow& row) { return row.make != nullptr; };
        present = static_cast<std::size_t>(std::stable_partition(all.begin(), all.end(), is_present) - all.begin());
    }
};

Catalogue& catalogue() {
    static Catalogue sorted;
    return sorted;
}

}  // namespace

std::span<const ExecutorRow> executors() noexcept { return std::span(catalogue().all).first(catalogue().present); }

std::span<const ExecutorRow> absent_executors() noexcept { return std::span(catalogue().all).subspan(catalogue().present); }

void add_executors(std::span<const ExecutorRow> further) {
    catalogue().all.insert(catalogue().all.end(), further.begin(), further.end());
    catalogue().sort();
}

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
