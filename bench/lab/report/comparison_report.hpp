#pragma once
/// Results of a comparison of methods as text, CSV, JSON and picture.

#include <string>

#include "bench/study/comparison.hpp"
#include "tools/program/plot/plot.hpp"

namespace cvtflow::bench {

/// A row per candidate: step, evaluations, time, speed-ups against the first, errors.
[[nodiscard]] std::string comparison_table(const Comparison& comparison, const ComparisonOptions& options);
[[nodiscard]] std::string comparison_csv(const Comparison& comparison, const ComparisonOptions& options);
[[nodiscard]] std::string comparison_json(const std::string& scene, const Comparison& comparison, const ComparisonOptions& options);
/// Axial force of the pin on the sheave at -z over time, of the reference and all candidates that came to the end.
[[nodiscard]] tools::Plot pin_plot(const std::string& scene, const Comparison& comparison);
/// Axial force of the pin less that of the reference.
[[nodiscard]] tools::Plot pin_error_plot(const std::string& scene, const Comparison& comparison);
/// The numbers of pin_plot(): time, reference, a column per candidate [s, N].
[[nodiscard]] std::string pin_csv(const Comparison& comparison);

}  // namespace cvtflow::bench
