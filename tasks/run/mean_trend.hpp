#pragma once
/// Whether means over a window of time still move: a straight line through means of blocks of whole pin periods.

#include <string_view>

#include "tasks/run/mean_curve.hpp"

namespace cvtflow::tasks {

/// A quantity that moves. Shares of its mean.
struct MeanTrend {
    std::string_view quantity;
    double change = 0.0;       ///< of the line from the begin to the end of the window [1]
    double uncertainty = 0.0;  ///< of that, 95 % [1]

    /// What it has changed by at least [1].
    [[nodiscard]] double least() const noexcept;
};

/// The one that has changed most of ratio, thrust ratio, tensions, slips and losses; none: fewer than four pin periods.
/// @param from, to of `curve` [s]
[[nodiscard]] MeanTrend largest_trend(const MeanCurve& curve, double from, double to) noexcept;

}  // namespace cvtflow::tasks
