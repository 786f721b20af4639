#pragma once
/// Pictures of a profile.

#include <string>
#include <vector>

#include "bench/study/profile/profile.hpp"
#include "tools/program/plot/plot.hpp"

namespace cvtflow::bench {

/// Time per step of each stage, summed over threads, waiting included, for every recorded schedule (horizontal axis: its number in the
/// tables). One series per stage, named as the graph's tasks.
[[nodiscard]] tools::Plot stages_plot(const std::string& scene, const Profile& profile);
/// Time per step beside busy neighbours, a curve per schedule.
[[nodiscard]] tools::Plot loads_plot(const std::string& scene, const Profile& profile);
/// Speed-ups by the number of threads: three curves, the critical path and measurements. For profiles with a prediction.
[[nodiscard]] tools::Plot curves_plot(const std::string& scene, const Profile& profile);

}  // namespace cvtflow::bench
