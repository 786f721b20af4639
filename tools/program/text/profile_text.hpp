#pragma once
/// A profile for people: tables and bars.

#include <string>

#include "tasks/study/profile/profile.hpp"

namespace cvtflow::tools {

/// Step and evaluation times, speed-ups, synchronisation: a row per schedule.
[[nodiscard]] std::string timing_text(const tasks::Profile& profile);
/// Medians beside busy neighbours and factors against serial under the same load; empty if there were none.
[[nodiscard]] std::string neighbours_text(const tasks::Profile& profile);
/// A bar per thread and schedule, divided by stages.
[[nodiscard]] std::string stages_text(const tasks::Profile& profile);
/// Where sequential time goes: the serial staged run by stage, or the fused one if that was not measured.
[[nodiscard]] std::string serial_text(const tasks::Profile& profile);
/// What the calibrations got of the processors, beside what a prediction needs; empty if there was none.
[[nodiscard]] std::string crowding_text(const tasks::Profile& profile);
/// Costs, three curves and the critical path beside what was measured; why there are none on a crowded machine.
[[nodiscard]] std::string model_text(const tasks::Profile& profile);

/// Predicted speed-up of every schedule beside the measured one.
[[nodiscard]] std::string predictions_text(const tasks::Profile& profile);

/// "CCCCHHHH..": shares of a thread's time as letters, largest remainders filled up to exactly `width`.
[[nodiscard]] std::string stage_bar(const tasks::ThreadTimes& times, const std::vector<tasks::StageRow>& rows, int width);

}  // namespace cvtflow::tools
