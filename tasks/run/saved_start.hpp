#pragma once
/// What a saved state says of itself beside its numbers.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tasks/scene/scene.hpp"

namespace cvtflow::engine {
struct SavedState;
}

namespace cvtflow::tasks {

/// Attribute with what the energy balance said (EnergyLedger::suspicion): whoever starts from a wrong state gets wrong results.
inline constexpr std::string_view suspicion_attribute = "energy_suspicion";
/// Its value; 0 where there is none.
[[nodiscard]] double suspicion_of(const engine::SavedState& saved);

/// The state that a scene names (state_file). @throws engine::RecordError that begins with the place where it is named
[[nodiscard]] std::shared_ptr<const engine::SavedState> saved_start(const Scene& scene);

/// What differs between a scene's machine and the one that a state was settled with, one line each.
[[nodiscard]] std::vector<std::string> start_differences(const engine::SavedState& saved, const Scene& scene);

}  // namespace cvtflow::tasks
