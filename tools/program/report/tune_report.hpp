#pragma once
/// What a Tuner found, for people, programs and eyes.

#include <string>
#include <vector>

#include "tasks/tuning/tuner.hpp"

namespace cvtflow::tools {

/// A choice at a point that nobody had tried.
struct UnseenPoint {
    std::string name;
    std::vector<double> errors;  ///< of every output [1]; empty: there was no reference
    std::string remark;          ///< why not, or what is wrong with the run; may be empty
};

/// The table of what was tried, what was left out, and the choice.
[[nodiscard]] std::string tune_text(const tasks::TuneResult& result);
[[nodiscard]] std::string tune_csv(const tasks::TuneResult& result);
[[nodiscard]] std::string tune_json(const tasks::TuneResult& result, const std::vector<UnseenPoint>& unseen);
/// Cost against error as SVG, with the target.
[[nodiscard]] std::string tune_picture(const tasks::TuneResult& result);
/// Errors at points that nobody had tried.
[[nodiscard]] std::string unseen_text(const tasks::TuneResult& result, const std::vector<UnseenPoint>& unseen);

}  // namespace cvtflow::tools
