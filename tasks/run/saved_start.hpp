#pragma once
/// States that runs begin with, and whether they fit.

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/parameters/chain_layout.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

/// Attribute of records with the step in use at their end [s]; "step" of a record is run.step, 0: automatic.
inline constexpr std::string_view step_taken_attribute = "step_taken";
/// Head of a state of a scene.
[[nodiscard]] engine::StateHead head_of(const Scene& scene, std::string method);

/// The state that a scene names (state_file). @throws engine::RecordError that begins with the place where it is named
[[nodiscard]] std::shared_ptr<const engine::SavedState> saved_start(const Scene& scene);

/// Elastic energy that a state has in a scene's machine against that in the machine it was settled with: differences by kind, added up,
/// over the latter. 0 where the state does not contain its scene, or other unknowns than the scene's.
[[nodiscard]] double start_misfit(const engine::SavedState& saved, const Scene& scene);
/// Misfit above which a state is of another machine: a run from it begins with a shock, and 20 ms later its slip is still wrong.
inline constexpr double start_misfit_tolerance = 0.01;
/// "the state does not fit this machine: its elastic energy differs by 12 %"
[[nodiscard]] std::string unfit_text(double misfit);
/// The same, or that the state has other unknowns. @param saved  does not fit the scene
[[nodiscard]] std::string unfit_text(const engine::SavedState& saved, const Scene& scene);
/// Coordinates that a state was settled with; nothing if the state does not contain its scene. @param scene  that names the state
[[nodiscard]] std::optional<model::ChainLayout> settled_layout(const engine::SavedState& saved, const Scene& scene);
/// Whether a state has a scene's coordinates: number of pins and level of detail agree. Control and ledger need not.
/// @param settled  settled_layout() of the state
[[nodiscard]] bool has_coordinates(const engine::SavedState& saved, const std::optional<model::ChainLayout>& settled, const Scene& scene);
[[nodiscard]] bool start_fits(const engine::SavedState& saved, const Scene& scene);
/// Hash of everything that a run depends on which begins with the state.
[[nodiscard]] std::uint64_t content_hash(const engine::SavedState& saved) noexcept;
/// @param unfit  unfit_text() of the state that the scene names
/// @throws SimulationError if the scene has no time to settle instead
void require_time_to_settle(const Scene& scene, const std::string& unfit);
/// The state that a scene names, if it names one that fits; else nullptr: the scene begins with a geometric start.
/// @throws as saved_start
[[nodiscard]] std::shared_ptr<const engine::SavedState> fitting_start(const Scene& scene);

/// Differences between a scene's machine and the one that a state was settled with, one line each.
[[nodiscard]] std::vector<std::string> start_differences(const engine::SavedState& saved, const Scene& scene);

}  // namespace cvtflow::tasks
