#pragma once
/// Results of a Tuner as text, CSV, JSON and picture.

#include <string>
#include <vector>

#include "tasks/tuning/tuner.hpp"

namespace cvtflow::tools {

/// The choice, measured at a point that tuning did not use.
struct UnseenPoint {
    std::string name;
    std::vector<double> errors;  ///< error of every output; empty: no reference
    std::string remark;          ///< reason for a missing reference, or a fault of the run; may be empty
};

/// Table of the tried choices, those left out, and the chosen one.
[[nodiscard]] std::string tune_text(const tasks::TuneResult& result);
[[nodiscard]] std::string tune_csv(const tasks::TuneResult& result);
[[nodiscard]] std::string tune_json(const tasks::TuneResult& result, const std::vector<UnseenPoint>& unseen);
/// Cost against error as SVG, with the target.
[[nodiscard]] std::string tune_picture(const tasks::TuneResult& result);
/// Errors at points that tuning did not use.
[[nodiscard]] std::string unseen_text(const tasks::TuneResult& result, const std::vector<UnseenPoint>& unseen);

}  // namespace cvtflow::tools
