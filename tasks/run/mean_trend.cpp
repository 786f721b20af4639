#include "tasks/run/mean_trend.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::tasks {

namespace {

constexpr std::size_t max_blocks = 8, min_blocks = 4;
/// Of Student's distribution, two-sided 95 %, for two blocks less than there are.
constexpr double student[max_blocks + 1] = {0, 0, 0, 0, 4.30, 3.18, 2.78, 2.57, 2.45};
constexpr double min_trend_slip = 5e-4;     ///< slips below are compared with this [1]
constexpr double min_share_of_tight = 0.1;  ///< likewise a slack strand, with a share of the tight one

struct Block {
    double mean[7];  ///< of the quantities below
};
constexpr std::string_view quantities[] = {"ratio", "thrust ratio", "tight tension", "slack tension", "slip", "slip by friction", "losses"};

[[nodiscard]] Block block_of(const MeanPoint& begin, const MeanPoint& end) noexcept {
    const auto mean = [&](Mean quantity, std::size_t k = 0) { return end.mean_since(begin, quantity, k); };
    const double driven = mean(Mean::clamping, 1);
    return {{mean(Mean::ratio), driven != 0.0 ? mean(Mean::clamping) / driven : 0.0, mean(Mean::tight), mean(Mean::slack), mean(Mean::slip),
             mean(Mean::friction_slip), (end.energy.lost() - begin.energy.lost()) / (end.time - begin.time)}};
}

/// What a quantity is compared with, by its mean over the window and that of the tight strand.
[[nodiscard]] double scale_of(std::size_t quantity, double mean, double tight) noexcept {
    if (quantity == 3) return std::max(std::abs(mean), min_share_of_tight * std::abs(tight));
    return quantity == 4 || quantity == 5 ? std::max(std::abs(mean), min_trend_slip) : std::abs(mean);
}

/// Least squares. blocks [count]; window: length in blocks [1]
[[nodiscard]] MeanTrend trend_of(const Block* blocks, std::size_t count, double window, std::size_t quantity) noexcept {
    const double n = static_cast<double>(count), middle = 0.5 * (n - 1.0);
    double mean = 0.0, tight = 0.0, slope = 0.0, spread = 0.0, scatter = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
        mean += blocks[k].mean[quantity] / n;
        tight += blocks[k].mean[2] / n;
    }
    for (std::size_t k = 0; k < count; ++k) {
        const double x = static_cast<double>(k) - middle;
        slope += x * (blocks[k].mean[quantity] - mean);
        spread += x * x;
    }
    slope /= spread;
    for (std::size_t k = 0; k < count; ++k) {
        const double rest = blocks[k].mean[quantity] - mean - slope * (static_cast<double>(k) - middle);
        scatter += rest * rest;
    }
    const double scale = scale_of(quantity, mean, tight), error = student[count] * std::sqrt(scatter / (n - 2.0) / spread);
    if (!(scale > 0.0)) return {quantities[quantity]};
    return {quantities[quantity], window * slope / scale, window * error / scale};
}

}  // namespace

double MeanTrend::least() const noexcept { return std::max(0.0, std::abs(change) - uncertainty); }

MeanTrend largest_trend(const MeanCurve& curve, double from, double to) noexcept {
    const double period = curve.pin_period(), periods = period > 0.0 ? std::floor((to - from) / period * (1.0 + 1e-9)) : 0.0;
    if (periods < static_cast<double>(min_blocks)) return {};
    const auto count = static_cast<std::size_t>(std::min(periods, static_cast<double>(max_blocks)));
    const double length = std::floor(periods / static_cast<double>(count)) * period;
    Block blocks[max_blocks];
    MeanPoint begin = curve.at(to - static_cast<double>(count) * length);
    for (std::size_t k = 0; k < count; ++k) {
        const MeanPoint end = curve.at(to - static_cast<double>(count - 1 - k) * length);
        blocks[k] = block_of(begin, end);
        begin = end;
    }
    MeanTrend largest;
    for (std::size_t quantity = 0; quantity < std::size(quantities); ++quantity) {
        const MeanTrend trend = trend_of(blocks, count, (to - from) / length, quantity);
        if (trend.least() > largest.least()) largest = trend;
    }
    return largest;
}

}  // namespace cvtflow::tasks
