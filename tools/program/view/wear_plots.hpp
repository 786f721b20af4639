#pragma once
/// Pictures of wear: what the loads of tips in a record have done to the sheaves' radii and to the tips.

#include <vector>

#include "tools/program/plot/plot.hpp"
#include "tools/program/view/recorded_run.hpp"

namespace cvtflow::tools {

/// Whether the record contains what wear_plots takes.
[[nodiscard]] bool has_wear(const RecordedRun& run);

/// Over the radius of each sheave: friction energy, largest pressure times sliding speed, Archard's depth; over the tips: Archard's depth.
/// Sums over the record's rows by the trapezoidal rule.
/// @throws UsageError if the record lacks channels of the group wear, or a scene that this program can read
[[nodiscard]] std::vector<Plot> wear_plots(const RecordedRun& run);

}  // namespace cvtflow::tools
