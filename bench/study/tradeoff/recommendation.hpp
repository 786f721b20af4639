#pragma once
/// Which of the choices on the front of error and time is recommended for an accuracy.

#include <cstddef>
#include <optional>
#include <vector>

#include "tasks/tuning/tuner.hpp"

namespace cvtflow::bench {

/// Index of the fastest point whose error is at most `error` / safety; empty if there is none.
[[nodiscard]] std::optional<std::size_t> recommended(const std::vector<tasks::TradeoffPoint>& points, double error, double safety);

/// An error measured on one scene is trusted on another within this factor.
inline constexpr double tradeoff_safety = 3.0;

}  // namespace cvtflow::bench
