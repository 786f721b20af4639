#pragma once
/// Another ratio in a state that runs: what changes where a chain of the same length runs on other radii.

#include <optional>

#include "model/machine/belt.hpp"
#include "model/parameters/parameters.hpp"

namespace cvtflow::model {

/// Radii of the chain at a ratio; none if there are none. ratio [1]
[[nodiscard]] std::optional<BeltRadii> chain_radii(const Parameters& parameters, double ratio) noexcept;

/// Moves a state from one ratio to another: places and velocities of the pins, openings of the grooves, the speed of shaft 2.
/// @param state of layout_of(parameters), pin 0 about where the upper strand crosses the middle between the shafts [unknowns]   @param
/// from, to ratios [1]
/// @return whether there are radii for both; else nothing has changed
bool shift_ratio(const Parameters& parameters, double from, double to, double* state) noexcept;

}  // namespace cvtflow::model
