#pragma once
/// A comparison of methods for people, programs and eyes.

#include <string>

#include "tasks/study/comparison.hpp"
#include "tools/program/plot/plot.hpp"

namespace cvtflow::tools {

/// A row per candidate: step, evaluations, time, speed-ups against the first, errors.
[[nodiscard]] std::string comparison_table(const tasks::Comparison& comparison, const tasks::ComparisonOptions& options);
[[nodiscard]] std::string comparison_csv(const tasks::Comparison& comparison, const tasks::ComparisonOptions& options);
[[nodiscard]] std::string comparison_json(const std::string& scene, const tasks::Comparison& comparison,
                                          const tasks::ComparisonOptions& options);
/// Axial force of the pin on the sheave at -z over time, of the reference and all candidates that came to the end.
[[nodiscard]] Plot pin_plot(const std::string& scene, const tasks::Comparison& comparison);
/// Axial force of the pin less that of the reference.
[[nodiscard]] Plot pin_error_plot(const std::string& scene, const tasks::Comparison& comparison);
/// The numbers of pin_plot(): time, reference, a column per candidate [s, N].
[[nodiscard]] std::string pin_csv(const tasks::Comparison& comparison);

}  // namespace cvtflow::tools
