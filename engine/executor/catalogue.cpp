#include "engine/executor/catalogue.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "engine/base/text.hpp"
#include "engine/executor/serial.hpp"

namespace cvtflow::engine {

namespace {

constexpr ExecutorRow serial_row{
    .name = "serial",
    .description = "one task after the other, on the calling thread",
    .parallel = false,
    .waiting = Waiting::fixed,
    .make = [](const ExecutorOptions& options) -> std::unique_ptr<Executor> { return std::make_unique<Serial>(options); }};

/// Rows of executors that are present come first; otherwise rows are in the order in which they were added.
struct Catalogue {
    std::vector<ExecutorRow> all{serial_row};
    std::size_t present = 0;

    Catalogue() { add(threaded_executors()); }
    void add(std::span<const ExecutorRow> further) {
        all.insert(all.end(), further.begin(), further.end());
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

void add_executors(std::span<const ExecutorRow> further) { catalogue().add(further); }

const ExecutorRow* find_executor(std::string_view name) noexcept {
    const auto there = executors();
    const auto found = std::find_if(there.begin(), there.end(), [&](const ExecutorRow& row) { return row.name == name; });
    return found == there.end() ? nullptr : &*found;
}

namespace {

/// The laboratory's executors (bench/executor; a test there compares).
constexpr std::string_view laboratory_names[] = {"omp_region",     "omp_fork", "omp_tasks", "barrier",   "flow_messages",
                                                 "flow_per_cycle", "tbb_loop", "std_par",   "asio_pool", "taskflow"};

}  // namespace

bool executor_of_laboratory(std::string_view name) noexcept {
    return std::find(std::begin(laboratory_names), std::end(laboratory_names), name) != std::end(laboratory_names);
}

std::string missing_executor(std::string_view name, std::span<const std::string_view> others) {
    const bool has_laboratory = find_executor("barrier") != nullptr;
    if (executor_of_laboratory(name) && !has_laboratory) return ": it belongs to the laboratory (cvtflow-lab run)";
    for (const ExecutorRow& row : absent_executors()) {
        if (row.name == name) return ": requires " + std::string(row.needs) + ", which was not found when this program was built";
    }
    std::vector<std::string> names(others.begin(), others.end());
    for (const ExecutorRow& row : executors()) names.emplace_back(row.name);
    return did_you_mean(closest(std::string(name), names));
}

}  // namespace cvtflow::engine
