#pragma once
/// A profile for eyes.

#include <string>
#include <vector>

#include "bench/study/profile/profile.hpp"
#include "tools/program/plot/plot.hpp"

namespace cvtflow::bench {

/// Where the time goes: for every recorded schedule (across, by its number in the tables) the time of each stage per step, of all threads
/// together, waiting included; a series per stage, named as the tasks of the graphs name them.
[[nodiscard]] tools::Plot stages_plot(const std::string& scene, const Profile& profile);
/// Time per step beside busy neighbours, a curve per schedule.
[[nodiscard]] tools::Plot loads_plot(const std::string& scene, const Profile& profile);
/// Speed-ups by the number of threads: three curves, the critical path and what was measured. For profiles that predict.
[[nodiscard]] tools::Plot curves_plot(const std::string& scene, const Profile& profile);

}  // namespace cvtflow::bench
