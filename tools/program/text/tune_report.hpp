#pragma once
/// Results of a Tuner as text, CSV, JSON and picture.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tasks/tuning/tuner.hpp"

namespace cvtflow::tools {

/// Table of the tried choices, those left out, and the chosen one.
[[nodiscard]] std::string tune_text(const tasks::TuneResult& result);
[[nodiscard]] std::string tune_csv(const tasks::TuneResult& result);
[[nodiscard]] nlohmann::ordered_json tune_json(const tasks::TuneResult& result, const std::vector<tasks::UnseenPoint>& unseen);
/// Cost against error as SVG. @param json tune_json()   @param mark that the file carries; empty: none   @throws as drawn()
[[nodiscard]] std::string tune_picture(const nlohmann::ordered_json& json, const std::string& mark);
/// Errors at points that tuning did not use.
[[nodiscard]] std::string unseen_text(const tasks::TuneResult& result, const std::vector<tasks::UnseenPoint>& unseen);

}  // namespace cvtflow::tools
