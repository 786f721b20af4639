#pragma once
/// The axial force of a pin that enters the driving pulley, by method.

#include <string>
#include <vector>

#include "bench/lab/report/compare_report.hpp"

namespace cvtflow::bench {

/// Time since the start and the force on the sheave at -z, a column for the reference and for each choice that came to the end.
[[nodiscard]] std::string pin_csv(const std::vector<ComparedChoice>& choices, const Trajectory& reference, const CompareSetting& setting);
[[nodiscard]] tools::Plot pin_plot(const std::vector<ComparedChoice>& choices, const Trajectory& reference, const CompareSetting& setting);
/// Distance from the reference.
[[nodiscard]] tools::Plot pin_error_plot(const std::vector<ComparedChoice>& choices, const Trajectory& reference,
                                         const CompareSetting& setting);

}  // namespace cvtflow::bench
