#include <array>
#include <memory>

#include "engine/executor/catalogue.hpp"
#include "engine/executor/tbb/flow.hpp"

namespace cvtflow::engine {

std::span<const ExecutorRow> threaded_executors() noexcept {
    static constexpr std::array rows{
        ExecutorRow{.name = "flow",
                    .description = "resident workers in a oneTBB flow graph; shares the machine well",
                    .parallel = true,
                    .waiting = Waiting::own,
                    .make = [](const ExecutorOptions& options) -> std::unique_ptr<Executor> { return std::make_unique<Flow>(options); }},
    };
    return rows;
}

}  // namespace cvtflow::engine
