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

}  // namespace cvtflow::tasks
