#pragma once
/// Lines and points above a map of a sweep: the torque limit of the machine, and the cases that were verified.

#include <cstddef>
#include <vector>

#include "tools/program/plot/plot.hpp"
#include "tools/program/view/sweep_view.hpp"

namespace cvtflow::tools {

/// Series above a map, in units of display. "torque limit": where one axis is load.torque, the load of safety factor 1 over the other
/// axis, by the scenes of the cases; absent where it is outside of their loads, where it depends on more than the other axis, and where the
/// clamping force or the load follows from the run. "verified": cases that also ran at reference quality.
/// @param sweep cases that ended well   @param x, y columns of numbers
[[nodiscard]] std::vector<Series> map_marks(const SweepView& sweep, std::size_t x, std::size_t y);

}  // namespace cvtflow::tools
