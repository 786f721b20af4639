#pragma once
/// A settled state brought over to another level of detail.

#include "engine/record/run/state_file.hpp"
#include "model/parameters/parameters.hpp"

namespace cvtflow::tasks {

/// Coordinates that both have are copied, new ones begin at zero: Legendre coordinates of higher order, elastic displacements of sheaves.
/// Rigid pulleys take angles from the shafts and the movable sheaves' positions against their shafts, and give them back. Phases stay.
/// A rigid pin is put in the middle between its two halves, and its halves where they roll on each other. Control and ledger are left out:
/// they begin at zero.
[[nodiscard]] engine::SavedState convert_state(const engine::SavedState& saved, const model::Parameters& from, const model::Parameters& to);

/// Turns a shaft with its sheaves, which are the same all round: a governor counts angles from t = 0. shaft 0 or 1, angle [rad]
void turn_shaft(engine::SavedState& state, const model::Parameters& parameters, int shaft, double angle);

}  // namespace cvtflow::tasks
