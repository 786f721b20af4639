#pragma once
/// Which choices are worth their time: no other is both faster and more exact.

#include <optional>
#include <string>
#include <vector>

namespace cvtflow::tasks {

struct TradeoffPoint {
    std::string choice;    ///< METHOD@STEP
    double error = 0.0;    ///< relative; infinite if the run was lost
    double seconds = 0.0;  ///< wall time per simulated second [1]
};

/// For each point whether it is on the front: no other has a smaller error at no more time, or less time at no larger an error.
[[nodiscard]] std::vector<bool> pareto_front(const std::vector<TradeoffPoint>& points);

/// Index of the fastest point whose error is at most `error` / safety; empty if there is none.
[[nodiscard]] std::optional<std::size_t> recommended(const std::vector<TradeoffPoint>& points, double error, double safety);

/// An error measured on one scene is trusted on another within this factor.
inline constexpr double tradeoff_safety = 3.0;

}  // namespace cvtflow::tasks
