#pragma once
/// A profile as text, tables and bars, and as pictures.

#include <string>
#include <vector>

#include "bench/lab/plot/plot.hpp"
#include "bench/study/profile/profile.hpp"

namespace cvtflow::bench {

/// Step and evaluation times, speed-ups, synchronisation: a row per schedule.
[[nodiscard]] std::string timing_text(const Profile& profile);
/// Gains over serial's turns, near and far rounds apart, and those of independent runs; nothing without threads.
[[nodiscard]] std::string gains_text(const Profile& profile);
/// Medians beside busy neighbours and factors against serial under the same load; empty if there were none.
[[nodiscard]] std::string neighbours_text(const Profile& profile);
/// A bar per thread and schedule, divided by stages.
[[nodiscard]] std::string stages_text(const Profile& profile);
/// Sequential time by stage: of the serial staged run, or of the fused one if that was not measured.
[[nodiscard]] std::string serial_text(const Profile& profile);
/// Processors that the calibrations obtained; empty without calibration.
[[nodiscard]] std::string crowding_text(const Profile& profile);

/// "CCCCHHHH..": shares of a thread's time as letters, largest remainders filled up to exactly `width`.
[[nodiscard]] std::string stage_bar(const ThreadTimes& times, const std::vector<StageRow>& rows, int width);

/// Time per step of each stage, summed over threads, waiting included, for every recorded schedule (horizontal axis: its number in the
/// tables). One series per stage, named as the graph's tasks.
[[nodiscard]] tools::Plot stages_plot(const std::string& scene, const Profile& profile);
/// Time per step beside busy neighbours, a curve per schedule.
[[nodiscard]] tools::Plot loads_plot(const std::string& scene, const Profile& profile);

}  // namespace cvtflow::bench
