#pragma once
/// Pictures of sweeps.

#include <string>

#include "tools/program/plot/plot.hpp"
#include "tools/program/view/sweep_view.hpp"

namespace cvtflow::tools {

/// y over x; a curve for each combination of the other axes. Cases that did not end well are left out and counted.
/// @throws UsageError for columns that are not there or hold no numbers
[[nodiscard]] Plot sweep_curves(const SweepView& sweep, const std::string& x, const std::string& y);

/// `colour` over x and y: with contours where the cases form a grid, as coloured points where they do not.
/// @throws UsageError as above, and where several cases fall on one point, with the axes in which they differ
[[nodiscard]] Plot sweep_map(const SweepView& sweep, const std::string& x, const std::string& y, const std::string& colour);

}  // namespace cvtflow::tools
