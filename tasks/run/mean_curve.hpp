#pragma once
/// Integrals over time of the quantities whose means a summary states, and whether those means still move: a straight line through means
/// of blocks of whole pin periods. Memory does not grow with the run.

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "model/observe/observation.hpp"
#include "tasks/step/control/energy_ledger.hpp"

namespace cvtflow::tasks {

/// Quantities of an instant whose means over time a summary states.
enum class Mean {
    ratio,
    slip,
    friction_slip,
    tight,
    slack,
    limited,  ///< 1 while a controller has reached its authority
    loose,    ///< 1 while the slack strand carries no tension
    beyond,   ///< 1 while clamping is above its limit over the slip speed
    turning,  ///< speed of the shafts without its sign, mean of both [rad/s]
    creep,    ///< power lost by creep [W]
    brought,  ///< power of the shafts that bring any [W]
    speed,    ///< from here on of both shafts
    torque = speed + 2,
    chain_torque = torque + 2,
    clamping = chain_torque + 2,
    radius = clamping + 2,
    axial_force = radius + 2,  ///< of four sheaves
};
inline constexpr std::size_t mean_count = static_cast<std::size_t>(Mean::axial_force) + 4;

/// Integrals since the first sample, and energies. Numbers only.
struct MeanPoint {
    double time = 0.0;                          ///< [s]
    std::array<double, mean_count> integral{};  ///< [unit of the quantity s]
    EnergySums energy;
    model::HydraulicEnergy hydraulics;

    /// Mean of a quantity, or of the k-th of several, since an earlier point.
    [[nodiscard]] double mean_since(const MeanPoint& before, Mean quantity, std::size_t k = 0) const noexcept {
        const std::size_t at = static_cast<std::size_t>(quantity) + k;
        return (integral[at] - before.integral[at]) / (time - before.time);
    }
};

/// By the trapezoidal rule over samples, which may lie at any distance from each other.
class MeanCurve {
public:
    /// Samples per pin period from which means are known to a thousandth, wherever the samples lie (a record may have fewer outputs).
    static constexpr double samples_per_period = 10.0;

    void clear() noexcept;
    /// @param sums of the energies so far   @param pin_period see Workspace [s]
    void add(const model::Observation& now, const EnergySums& sums, double pin_period);
    /// Whether the last sample lies so far back that another one is needed. time [s]
    [[nodiscard]] bool due(double time) const noexcept { return pin_period_ > 0.0 && time - now_.time >= pin_period_ / samples_per_period; }

    [[nodiscard]] bool empty() const noexcept { return points_.empty(); }
    [[nodiscard]] const MeanPoint& first() const noexcept { return points_.front(); }
    [[nodiscard]] const MeanPoint& last() const noexcept { return now_; }
    /// Linear between the points that are kept. time [s], from first() to last()
    [[nodiscard]] MeanPoint at(double time) const noexcept;
    /// A point as long after `from` as makes its means those of the last sample: for spans without length.
    [[nodiscard]] MeanPoint instant(const MeanPoint& from) const noexcept;
    [[nodiscard]] double pin_period() const noexcept { return pin_period_; }  ///< at the last sample [s]

    /// For checkpoints: continues bitwise. load() returns the rest of the memory. @throws std::invalid_argument for a malformed memory
    void save(std::vector<double>& memory) const;
    [[nodiscard]] std::span<const double> load(std::span<const double> memory);  ///< memory [what save() wrote]

private:
    static constexpr std::size_t max_points = 2000;

    std::vector<MeanPoint> points_;               ///< the first sample, and every per_point_-th one
    MeanPoint now_;                               ///< at the last sample
    std::array<double, mean_count> values_{};     ///< of the last sample
    double per_point_ = 1.0, since_point_ = 0.0;  ///< samples [1]
    double pin_period_ = 0.0;                     ///< [s]
};

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
