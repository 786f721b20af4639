#include "tasks/checkpoint/integration_state.hpp"

#include <span>

#include "engine/base/hash.hpp"

namespace cvtflow::tasks {

std::uint64_t IntegrationState::hash() const noexcept {
    engine::Hash hash;
    hash.add(static_cast<std::uint64_t>(started)).add(static_cast<std::uint64_t>(settling));
    const double reals[] = {time, begin, output_interval, step, next_step, settling_suspicion, settling_residual};
    hash.add(std::span<const double>(reals));
    for (const long count : {grid_number, grid_steps, outputs, counters.steps, counters.evaluations, counters.detected, counters.truncated, counters.suppressed, counters.rejected}) {
        hash.add(static_cast<std::uint64_t>(count));
    }
    hash.add(std::span<const double>(state)).add(std::span<const double>(changed)).add(std::span<const double>(method));
    hash.add(std::span<const double>(energy)).add(std::span<const double>(step_choice));
    hash.add(std::span<const std::uint8_t>(reinterpret_cast<const std::uint8_t*>(phases.data()), phases.size()));
    for (const model::TipIndicator& tip : before) {
        const double pair[] = {tip.depth, tip.slip};
        hash.add(std::span<const double>(pair));
    }
    return hash.value();
}

}  // namespace cvtflow::tasks
