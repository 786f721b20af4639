#pragma once
/// Local errors as text, CSV, JSON and pictures.

#include <string>
#include <vector>

#include "bench/study/stability/frozen_step.hpp"
#include "tools/program/plot/plot.hpp"

namespace cvtflow::bench {

/// One method under one friction law.
struct ErrorCurve {
    std::string method;
    std::string friction;            ///< "piecewise" or "smoothed"
    std::vector<LocalError> errors;  ///< by descending step; NaN: a transition ended the step
};

/// A row per step, errors of the four parts with their slopes.
[[nodiscard]] std::string error_table(const std::vector<LocalError>& errors);
/// A row per method and step.
[[nodiscard]] std::string error_csv(const std::vector<ErrorCurve>& curves);
/// Everything, with provenance; null: a transition ended the step.
[[nodiscard]] std::string error_json(const std::vector<ErrorCurve>& curves, const std::string& scene);
/// One part of all methods under one friction law, against the step, both logarithmic. @param name of the part, as in the title
[[nodiscard]] tools::Plot error_plot(const std::vector<ErrorCurve>& curves, const std::string& friction, double LocalError::*part,
                                     const std::string& name, const std::string& scene);

}  // namespace cvtflow::bench
