#include "tasks/step/integration_state.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "engine/base/hash.hpp"

namespace cvtflow::tasks {

const char* IntegrationState::unsound() const noexcept {
    constexpr long most = 1L << 53;  // up to here a double counts
    for (const long count : {grid_number, grid_steps, outputs, counters.steps, counters.evaluations, counters.detected, counters.truncated,
                             counters.suppressed, counters.rejected}) {
        if (count < 0 || count > most) return "it holds a count that is none";
    }
    if (std::any_of(phases.begin(), phases.end(), [](model::Phase phase) { return phase > model::Phase::slip; }))
        return "it holds a phase that is none";
    if (!std::isfinite(time)) return "its time is none";
    if (!started) return nullptr;
    const auto is_length = [](double value) { return std::isfinite(value) && value > 0.0; };
    if (!std::isfinite(begin) || !is_length(output_interval) || !(std::isfinite(step) && step >= 0.0) || grid_steps == 0 ||
        !(std::isfinite(next_step) && next_step >= 0.0))
        return "its steps or outputs have no length";
    if (!(static_cast<double>(outputs + 2) * std::max({1.0, static_cast<double>(grid_steps), step > 0.0 ? output_interval / step : 1.0}) <=
          static_cast<double>(most)))
        return "its steps cannot be counted";
    if (std::abs(time - begin - static_cast<double>(outputs) * output_interval) > 2.0 * output_interval + 1e-6 * std::abs(time))
        return "its outputs are not at its time";
    return nullptr;
}

std::uint64_t IntegrationState::hash() const noexcept {
    engine::Hash hash;
    hash.add(static_cast<std::uint64_t>(started)).add(static_cast<std::uint64_t>(settling));
    const double reals[] = {time, begin, output_interval, step, next_step, settling_suspicion, settling_residual};
    hash.add(std::span<const double>(reals));
    for (const long count : {grid_number, grid_steps, outputs, counters.steps, counters.evaluations, counters.detected, counters.truncated,
                             counters.suppressed, counters.rejected}) {
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
