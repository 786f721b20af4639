#pragma once
/// Integrals of a run over time, of which means come, and what the means of equal times show: errors, whether they are steady.

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <vector>

#include "model/observe/observation.hpp"
#include "tasks/step/control/energy_ledger.hpp"

namespace cvtflow::tasks {

/// Deviation from its target beyond which a ratio is noted whose sheave is held [1].
inline constexpr double misses_held = 0.003;

/// Quantities of an instant whose means over time a summary states.
enum class Mean {
    slip,
    friction_slip,
    tight,
    slack,
    limited,  ///< 1 while a controller has reached its authority
    missed,   ///< deviation of the first controller's quantity over its target; more than all of it counts as all of it
    loose,    ///< 1 while a strand carries no tension
    beyond,   ///< 1 while clamping is above its limit over the slip speed
    floor,    ///< 1 while the table of shaft 2, and not clamping.safety, decides its clamping force
    turning,  ///< speed of the shafts without its sign, mean of both [rad/s]
    creep,    ///< power lost by creep [W]
    brought,  ///< power of the shafts that bring any [W]
    target,   ///< target of the first controller
    opening,  ///< w of the driving sheave [m]
    needed,   ///< speed of shaft 2 that a cycle needs, and the distance of the speed from it [rad/s]
    astray,
    demanded,  ///< power that a cycle needs of shaft 2, without its sign, and what is missing to it [W]
    short_of,
    speed,  ///< first of two shafts, as up to `controlled_square`
    torque = speed + 2,
    chain_torque = torque + 2,
    clamping = chain_torque + 2,
    radius = clamping + 2,
    axial_force = radius + 2,             ///< first of four sheaves
    controlled = axial_force + 4,         ///< clamping force that a controller makes; 0 without [N]
    controlled_square = controlled + 2,   ///< [N²]
    half_cosine = controlled_square + 2,  ///< tight tension less that of two pin periods before, times cosine and
    half_sine = half_cosine + 1,          ///< sine of half the pin frequency; 0 where periods are not marked [N]
};
inline constexpr std::size_t mean_count = static_cast<std::size_t>(Mean::half_sine) + 1;

/// Integrals since the first sample, and energies. Numbers only.
struct MeanPoint {
    double time = 0.0;                          ///< [s]
    std::array<double, mean_count> integral{};  ///< [unit of the quantity s]
    EnergySums energy;
    EnergyMark mark;
    model::HydraulicEnergy hydraulics;

    /// Mean of a quantity, or of the k-th of several, since an earlier point.
    [[nodiscard]] double mean_since(const MeanPoint& before, Mean quantity, std::size_t k = 0) const noexcept {
        const std::size_t at = static_cast<std::size_t>(quantity) + k;
        return (integral[at] - before.integral[at]) / (time - before.time);
    }
    /// Speed ratio since an earlier point: how far shaft 1 has turned over how far shaft 2 has, so that a shaft that is at rest for a while
    /// does not decide. NaN or infinite only where shaft 2 has not turned at all.
    [[nodiscard]] double ratio_since(const MeanPoint& before) const noexcept {
        return mean_since(before, Mean::speed, 0) / mean_since(before, Mean::speed, 1);
    }
};

/// Condition for steady means: all their errors are below a tolerance. Without tolerance there is no condition. Beside it what notes on
/// means take from the scene.
struct SteadyRule {
    double tolerance = 0.0;    ///< relative to each mean; of the efficiency to the losses' share, at least a fiftieth [1]
    double limit = 0.0;        ///< pin periods after which a run ends that is not steady [1]
    double pins = 0.0;         ///< pin periods of a revolution [1]
    double repeats = 1.0;      ///< pin periods after which the machine repeats itself: all of a revolution where it is imperfect [1]
    bool holds_ratio = false;  ///< ratio control: the ratio is steady at its target, to a tenth of the tolerance
    double controlled = 0.0;   ///< pin periods of ratio control before the sheave is held (control.when_steady); 0: none [1]
    double grip = 0.0;         ///< largest tension difference of an arc over its clamping force [1]
    double inertia = 0.0;      ///< inertia of shaft 2, which a load torque brakes; 0: how slowly slip settles is not known [kg·m²]
    double brief = 0.0;        ///< pin periods after which means count where the sheave is held from the start on; 0: it is not [1]
    double cylinder = 0.0;     ///< power that the cylinders' dampers take under control, before the sheave is held [W]
    bool changes = false;      ///< inputs change over time: no means are steady
    bool pressures = false;    ///< pressures are given, and no clamping forces

    [[nodiscard]] bool holds_sheave() const noexcept { return controlled > 0.0 || brief > 0.0; }
};

/// Integrals by the trapezoidal rule over samples, which may lie at any distance from each other.
class MeanCurve {
public:
    /// Samples per pin period from which means are known to a thousandth, wherever the samples lie (a record may have fewer outputs).
    static constexpr double samples_per_period = 10.0;

    void clear() noexcept;
    /// Keeps the ends of all pin periods from the next sample on, in place of samples.
    void mark_periods() noexcept { marks_ = true; }
    /// @param sums of the energies so far   @param pin_period see Workspace [s]   @param mark of the energies' ledger
    /// @param needed_speed of shaft 2, by a cycle; 0: none [rad/s]
    void add(const model::Observation& now, const EnergySums& sums, double pin_period, const EnergyMark& mark = {},
             double needed_speed = 0.0);
    /// Whether the last sample lies so far back that another one is needed. time [s]
    [[nodiscard]] bool due(double time, double per_period = samples_per_period) const noexcept {
        return pin_period_ > 0.0 && time - now_.time >= pin_period_ / per_period;
    }

    [[nodiscard]] bool empty() const noexcept { return points_.empty(); }
    [[nodiscard]] const MeanPoint& first() const noexcept { return points_.front(); }
    /// Points that are kept; with mark_periods() the begin of the first pin period and ends of all.
    [[nodiscard]] std::span<const MeanPoint> points() const noexcept { return points_; }
    [[nodiscard]] const MeanPoint& last() const noexcept { return now_; }
    /// Linear between the points that are kept. time [s], from first() to last()
    [[nodiscard]] MeanPoint at(double time) const noexcept;
    /// A point as long after `from` as makes its means those of the last sample: for spans without length.
    [[nodiscard]] MeanPoint instant(const MeanPoint& from) const noexcept;
    [[nodiscard]] double pin_period() const noexcept { return pin_period_; }  ///< period at the last sample [s]

    /// All that a checkpoint has to keep.
    void visit(engine::Archive& archive);

private:
    static constexpr std::size_t max_points = 2000, max_periods = 100'000;

    void keep_sample();
    void keep_periods(const MeanPoint& before);  ///< before: at the sample before the last one
    void add_alternation(const model::Observation& now, std::array<double, mean_count>& values) const noexcept;

    std::vector<MeanPoint> points_;               ///< the first sample, and every per_point_-th one
    MeanPoint now_;                               ///< point of the last sample
    std::array<double, mean_count> values_{};     ///< quantities at the last sample
    double per_point_ = 1.0, since_point_ = 0.0;  ///< samples [1]
    double pin_period_ = 0.0;                     ///< [s]
    double period_here_ = 0.0;                    ///< length of the pin period that is marked next [s]
    bool marks_ = false;
};

/// Swing of a clamping force that a controller makes: standard deviation over mean, within each of up to four parts of the time, the least
/// of them, so that a single change is none. The larger one of both shafts; 0: without control, or in less than two pin periods [1].
/// @param from, to of `curve`: of these the end, at most 64 pin periods for each part [s]
[[nodiscard]] double min_swing(const MeanCurve& curve, double from, double to) noexcept;

/// Error of the mean of a series. [unit of the series]
struct MeanError {
    double mean = 0.0;
    double drift = 0.0;   ///< change of the trend over all, and half as much again as the bend of the trend
    double noise = 0.0;   ///< 95 %, of the scatter about that trend
    double change = 0.0;  ///< rise of the straight line from begin to end

    [[nodiscard]] double sum() const noexcept { return std::hypot(drift, noise); }
    /// Change that scatter cannot have made: that of a line through many means is uncertain by the root of twelve times their mean's noise.
    [[nodiscard]] double certain() const noexcept { return std::max(0.0, std::abs(change) - std::sqrt(12.0) * noise); }
};
/// @param values four to eight means of equal times that follow each other
[[nodiscard]] MeanError error_of_mean(std::span<const double> values) noexcept;

/// Errors of an efficiency are relative to the losses' share of the input, at least to this [1].
inline constexpr double share_of_efficiency = 0.02;

/// Smallest slip by friction, and smallest slip by plain speeds, to which errors of steady means are relative [1].
inline constexpr double min_steady_slip = 5e-4, min_plain_slip = 2e-3;

/// Errors of the means of a span of time, by equal batches of whole pin periods.
struct MeanErrors {
    static constexpr std::size_t count = 8;
    /// "ratio", "thrust ratio", "tight tension", …, "efficiency".
    [[nodiscard]] static std::string_view name(std::size_t quantity) noexcept;

    std::size_t batches = 0;               ///< 0: too short
    double share = 0.0;                    ///< largest error over what is allowed for it; 0: not known [1]
    std::size_t worst = 0;                 ///< the quantity that has it
    double moved = 0.0;                    ///< largest change that is certain, likewise over what is allowed [1]
    std::size_t moving = 0;                ///< the quantity that has changed so
    std::array<MeanError, count> error{};  ///< not a number: there is no such mean

    /// Size to which errors of a mean are relative; slips by friction below `small_slip`, plain slips also below min_plain_slip, and slack
    /// strands below a tenth of the tight one count as these.
    [[nodiscard]] double scale(std::size_t quantity, double small_slip) const noexcept;
    /// Finds the largest error and change over what a tolerance allows: of each scale(), of the ratio a share of that.
    /// @param judged the quantity by which losses are judged
    void judge(double tolerance, double of_ratio, double small_slip, std::size_t judged) noexcept;
};

/// Errors of the means over the time that is seen; fewer than four pin periods: none.
[[nodiscard]] MeanErrors mean_errors(const MeanCurve& curve) noexcept;
/// Judges errors as notes do: the ratio to a tenth of the tolerance, slips below 0.3 % to that share of 0.3 %, as far as a step resolves
/// them. @param held  the sheave is: a ratio that stays where it is off its target is none of this
[[nodiscard]] MeanErrors noted_errors(MeanErrors errors, double tolerance, bool held) noexcept;

/// Means of the last half of a run, in equal batches of whole pin periods, and their errors.
struct SteadyMeans : MeanErrors {
    std::size_t begin = 0, batch = 0;  ///< index of the curve's first point, periods per batch
    double unseen = 0.0;               ///< error that no mean shows, since it changes too slowly, relative [1]
    double unseen_ratio = 0.0;         ///< the same of the ratio
    double unseen_slip = 0.0;          ///< the same of slip near what the clamping forces carry, beside `unseen`; no reason to run longer
    double to_come = 1.0;              ///< share of the trend's change that slip lacks in the mean, where it is more than all [1]
    double off_target = 0.0;           ///< deviation of a ratio that is held; while it is large, the ratio still moves [1]
    double alternation = 0.0;          ///< amplitude of the tight tension at half the pin frequency over its mean [1]
    double swing = 0.0;                ///< root mean square of the tensions' differences from period to period, over the tight one [1]
    bool early = false;                ///< less than two revolutions of a controller: its swings may not show yet
    bool grows = false;                ///< alternation or swing is noticeable and grows: later means differ
    bool astray = false;               ///< a sheave that is held from the start on is not where its ratio is
    double sliding = 0.0;              ///< slip by friction of a chain that slides, and ever faster; else 0 [1]

    [[nodiscard]] bool steady() const noexcept { return batches > 0 && share > 0.0 && share <= 1.0 && !grows && !early; }
};
/// Judges the second half of rule.controlled periods, which have to be over: sets rule.cylinder, and rule.controlled to zero where control
/// moves the sheave too much to be replaced by one that is held, or may do so later.
void judge_control(const MeanCurve& curve, SteadyRule& rule) noexcept;

/// @param curve one that marks periods
[[nodiscard]] SteadyMeans steady_means(const MeanCurve& curve, const SteadyRule& rule) noexcept;

}  // namespace cvtflow::tasks
