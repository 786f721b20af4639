#include "tasks/run/mean_curve.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <type_traits>

#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

namespace {

constexpr std::size_t point_numbers = sizeof(MeanPoint) / sizeof(double);
using PointNumbers = std::array<double, point_numbers>;
static_assert(std::is_trivially_copyable_v<MeanPoint> && sizeof(MeanPoint) == sizeof(PointNumbers));

[[nodiscard]] std::array<double, mean_count> values_of(const model::Observation& now, double needed_speed) noexcept {
    std::array<double, mean_count> values{};
    const auto put = [&](Mean quantity, double value, std::size_t k = 0) { values[static_cast<std::size_t>(quantity) + k] = value; };
    put(Mean::slip, now.slip);
    put(Mean::friction_slip, now.friction_slip);
    put(Mean::tight, now.tight);
    put(Mean::slack, now.slack);
    put(Mean::limited, now.control_limited ? 1.0 : 0.0);
    put(Mean::missed, std::clamp(now.control.miss(), -1.0, 1.0));  // a safety factor has no limit where a load passes zero
    put(Mean::loose, std::min(now.tight, now.slack) <= 0.0 ? 1.0 : 0.0);
    put(Mean::beyond, now.limit_use > 1.0 ? 1.0 : 0.0);
    put(Mean::floor, now.at_floor ? 1.0 : 0.0);
    put(Mean::turning, 0.5 * (std::abs(now.speed[0]) + std::abs(now.speed[1])));
    put(Mean::creep, now.creep.power);
    put(Mean::brought, std::max(0.0, now.work[0]) + std::max(0.0, now.work[1]));
    put(Mean::target, now.control.target);
    put(Mean::opening, now.sheave_position[0]);
    if (needed_speed != 0.0) {
        put(Mean::needed, std::abs(needed_speed));
        put(Mean::astray, std::abs(now.speed[1] - needed_speed));
        put(Mean::demanded, std::abs(now.torque[1] * needed_speed));
        put(Mean::short_of, now.torque[1] * (now.speed[1] - needed_speed));
    }
    for (std::size_t k = 0; k < 2; ++k) {
        put(Mean::speed, now.speed[k], k);
        put(Mean::torque, now.torque[k], k);
        put(Mean::chain_torque, now.chain_torque[k], k);
        put(Mean::clamping, now.clamping[k], k);
        put(Mean::radius, now.radius[k], k);
        put(Mean::controlled, now.control.force[k], k);
        put(Mean::controlled_square, now.control.force[k] * now.control.force[k], k);
    }
    for (std::size_t k = 0; k < 4; ++k) put(Mean::axial_force, now.axial_force[k], k);
    return values;
}

/// Linear. time [s]
[[nodiscard]] MeanPoint between(const MeanPoint& before, const MeanPoint& after, double time) noexcept {
    const auto from = std::bit_cast<PointNumbers>(before), to = std::bit_cast<PointNumbers>(after);
    const double share = (time - from[0]) / (to[0] - from[0]);
    PointNumbers numbers{};
    for (std::size_t k = 0; k < point_numbers; ++k) numbers[k] = from[k] + share * (to[k] - from[k]);
    return std::bit_cast<MeanPoint>(numbers);
}

}  // namespace

void MeanCurve::clear() noexcept {
    points_.clear();
    now_ = {};
    values_ = {};
    per_point_ = 1.0;
    since_point_ = pin_period_ = period_here_ = 0.0;
}

void MeanCurve::add(const model::Observation& now, const EnergySums& sums, double pin_period, const EnergyMark& mark, double needed_speed) {
    std::array<double, mean_count> values = values_of(now, needed_speed);
    if (marks_ && period_here_ > 0.0) add_alternation(now, values);
    const MeanPoint before = now_;
    const double half = points_.empty() ? 0.0 : 0.5 * (now.time - now_.time);
    for (std::size_t k = 0; k < mean_count; ++k) now_.integral[k] += half * (values_[k] + values[k]);
    now_.time = now.time;
    now_.energy = sums;
    now_.mark = mark;
    now_.hydraulics = now.hydraulic_energy;
    values_ = values;
    pin_period_ = pin_period;
    marks_ ? keep_periods(before) : keep_sample();
}

void MeanCurve::keep_sample() {
    since_point_ += 1.0;
    if (!points_.empty() && since_point_ < per_point_) return;
    if (points_.size() == max_points) {  // every other one remains, the first one included
        for (std::size_t k = 1; 2 * k < points_.size(); ++k) points_[k] = points_[2 * k];
        points_.resize(max_points / 2);
        per_point_ *= 2.0;
    }
    points_.push_back(now_);
    since_point_ = 0.0;
}

void MeanCurve::keep_periods(const MeanPoint& before) {
    if (points_.empty()) points_.push_back(now_);
    if (!(period_here_ > 0.0)) period_here_ = pin_period_;
    while (period_here_ > 0.0 && now_.time >= points_.back().time + period_here_ && points_.size() < max_periods) {
        points_.push_back(between(before, now_, points_.back().time + period_here_));
        period_here_ = pin_period_;
    }
}

/// Adds the tight tension's part at half the pin frequency: periods alternate.
void MeanCurve::add_alternation(const model::Observation& now, std::array<double, mean_count>& values) const noexcept {
    const std::size_t periods = points_.size() - 1;
    if (periods < 2) return;
    const double usual = points_[periods].mean_since(points_[periods - 2], Mean::tight);  // of two: without what alternates
    const double phase = static_cast<double>(periods % 2) + (now.time - points_[periods].time) / period_here_;
    values[static_cast<std::size_t>(Mean::half_cosine)] = (now.tight - usual) * std::cos(std::numbers::pi * phase);
    values[static_cast<std::size_t>(Mean::half_sine)] = (now.tight - usual) * std::sin(std::numbers::pi * phase);
}

MeanPoint MeanCurve::at(double time) const noexcept {
    if (time >= now_.time) return now_;
    const auto after = std::find_if(points_.begin(), points_.end(), [&](const MeanPoint& point) { return point.time >= time; });
    if (after == points_.begin()) return points_.front();
    return between(*(after - 1), after == points_.end() ? now_ : *after, time);
}

MeanPoint MeanCurve::instant(const MeanPoint& from) const noexcept {
    MeanPoint point = from;
    point.time += 1.0;
    for (std::size_t k = 0; k < mean_count; ++k) point.integral[k] += values_[k];
    return point;
}

void MeanCurve::visit(engine::Archive& archive) {
    archive("samples_per_point", per_point_), archive("samples_since_point", since_point_), archive("pin_period", pin_period_);
    archive("period_here", period_here_), archive("values", values_), archive("now", now_), archive("points", points_);
    if (points_.size() > max_periods) archive.refuse("points");
}

namespace {

constexpr std::size_t max_blocks = 8, min_blocks = 4;
/// Quantiles of Student's distribution, two-sided 95 %, by degrees of freedom.
constexpr double quantile[max_blocks - 2] = {0, 12.71, 4.30, 3.18, 2.78, 2.57};
constexpr double sag_counts = 1.5;            ///< weight of the bend of a trend in its error: a swing that turns has no trend
constexpr double noticed_alternation = 5e-4;  ///< smallest noticed alternation over the tension; other machines stay below 3e-4
constexpr double noticed_swing = 1e-3;        ///< smallest noticed swing over the tight tension
constexpr double growth_of_swing = 1.05;      ///< growth from one half of the window to the other that is noticed
constexpr double min_revolutions = 2.0;  ///< shortest run under control, which swings within 90 to 250 pin periods; of a held sheave: one
constexpr double unseen_share = 0.5;     ///< error by what changes too slowly to show in half of a run that just passed, over the tolerance
constexpr double rail_scatter = 0.25;    ///< relative scatter of the loss by guides, 95 %, in a mean over rail_time
constexpr double rail_time = 0.1;        ///< correlation time of impacts, longer than a short run shows [s]
constexpr double often_limited = 0.05;   ///< share of time at its limit above which a control holds nothing
constexpr double moved_share = 0.8;      ///< of the tolerance: losses of the cylinders under control above which no sheave is held
constexpr double longest_held_period = 1.1e-3;  ///< with slower pins these losses grow up to eleven times after 24 periods [s]
constexpr double most_slip = 0.1;           ///< slip above which load or clamping decide alone; a chain that holds creeps by a hundredth
constexpr double growth_of_sliding = 1.1;   ///< growth from one half of the window to the other; an imposed slip does not grow
constexpr double min_noted_slip = 3e-3;     ///< smallest slip to which errors are relative in notes: steps are exact to 3e-5 of a speed
constexpr double share_of_ratio = 0.1;      ///< tolerance of the ratio over that of other means, which follow a ratio that moves
constexpr double share_at_end = 0.2;        ///< the same where a run reaches its limit of time: scatter of a control that has settled
constexpr double min_share_of_tight = 0.1;  ///< smallest slack tension over the tight one to which errors are relative

struct Block {
    double mean[8];  ///< means of `quantities`
};
constexpr std::string_view quantities[] = {"ratio", "thrust ratio",     "tight tension", "slack tension",
                                           "slip",  "slip by friction", "losses",        "efficiency"};
constexpr std::size_t slip = 4, friction_slip = 5, losses = 6, efficiency = 7;

[[nodiscard]] Block block_of(const MeanPoint& begin, const MeanPoint& end) noexcept {
    const auto mean = [&](Mean quantity, std::size_t k = 0) { return end.mean_since(begin, quantity, k); };
    const double driven = mean(Mean::clamping, 1);
    return {{end.ratio_since(begin), driven != 0.0 ? mean(Mean::clamping) / driven : 0.0, mean(Mean::tight), mean(Mean::slack),
             mean(Mean::slip), mean(Mean::friction_slip), (end.energy.lost() - begin.energy.lost()) / (end.time - begin.time),
             end.energy.since(begin.energy).efficiency()}};
}

}  // namespace

double min_swing(const MeanCurve& curve, double from, double to) noexcept {
    constexpr double max_parts = 4.0, min_periods = 2.0, max_periods = 64.0;
    const double period = curve.pin_period(), available = period > 0.0 ? std::floor((to - from) / period * (1.0 + 1e-9)) : 0.0;
    const double parts = std::min(max_parts, std::floor(available / min_periods));
    if (parts < 1.0) return 0.0;
    const double length = std::min(std::floor(available / parts), max_periods) * period;
    std::array<double, 2> smallest{};
    MeanPoint end = curve.at(to);
    for (double part = 1.0; part <= parts; part += 1.0) {
        const MeanPoint begin = curve.at(to - part * length);
        for (std::size_t shaft = 0; shaft < smallest.size(); ++shaft) {
            const double mean = end.mean_since(begin, Mean::controlled, shaft);
            const double square = end.mean_since(begin, Mean::controlled_square, shaft);
            const double swing = mean > 0.0 ? std::sqrt(std::max(0.0, square / (mean * mean) - 1.0)) : 0.0;
            smallest[shaft] = part == 1.0 ? swing : std::min(smallest[shaft], swing);
        }
        end = begin;
    }
    return std::max(smallest[0], smallest[1]);
}

MeanError error_of_mean(std::span<const double> values) noexcept {
    const double n = static_cast<double>(values.size()), middle = 0.5 * (n - 1.0), square = (n * n - 1.0) / 12.0;
    double mean = 0.0, slope = 0.0, bend = 0.0, slopes = 0.0, bends = 0.0, scatter = 0.0;
    for (const double value : values) mean += value / n;
    const auto place = [&](std::size_t k) { return static_cast<double>(k) - middle; };
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double x = place(k), curved = x * x - square;
        slope += x * values[k];
        slopes += x * x;
        bend += curved * values[k];
        bends += curved * curved;
    }
    slope /= slopes;
    bend /= bends;
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double x = place(k), rest = values[k] - mean - slope * x - bend * (x * x - square);
        scatter += rest * rest;
    }
    const double change = n * slope, sag = n * n / 6.0 * bend;  // of the trend over all; of its parabola, at the ends
    return {mean, std::hypot(change, sag_counts * sag), quantile[values.size() - 3] * std::sqrt(scatter / (n - 3.0) / n), change};
}

std::string_view MeanErrors::name(std::size_t quantity) noexcept { return quantities[quantity]; }

double MeanErrors::scale(std::size_t quantity, double small_slip) const noexcept {
    const double mean = std::abs(error[quantity].mean);
    switch (quantity) {
        case 3: return std::max(mean, min_share_of_tight * std::abs(error[2].mean));
        case 4: return std::max({mean, small_slip, min_plain_slip});
        case 5: return std::max(mean, small_slip);
        case efficiency: return std::max(share_of_efficiency, 1.0 - error[quantity].mean);
        default: return mean;
    }
}

void MeanErrors::judge(double tolerance, double of_ratio, double small_slip, std::size_t judged) noexcept {
    share = moved = 0.0;
    for (std::size_t quantity = 0; quantity < count; ++quantity) {
        if (quantity >= losses && quantity != judged) continue;
        const double most = tolerance * (quantity == 0 ? of_ratio : 1.0) * scale(quantity, small_slip), over = error[quantity].sum() / most,
                     by = error[quantity].certain() / most;
        if (over > share) share = over, worst = quantity;
        if (by > moved) moved = by, moving = quantity;
    }
}

namespace {

/// Amplitude of the tight tension at half the pin frequency between two points that lie an even number of periods apart [N].
[[nodiscard]] double alternation(const MeanPoint& begin, const MeanPoint& end) noexcept {
    return 2.0 * std::hypot(end.mean_since(begin, Mean::half_cosine), end.mean_since(begin, Mean::half_sine));
}

/// Root mean square of what means of pin periods differ by from the ones before, over the root of two: a swing that is no trend. The
/// passing of the pins is not in it. points [periods + 1]
[[nodiscard]] double swing(std::span<const MeanPoint> points, Mean quantity) noexcept {
    double squares = 0.0;
    for (std::size_t k = 2; k < points.size(); ++k) {
        const double change = points[k].mean_since(points[k - 1], quantity) - points[k - 1].mean_since(points[k - 2], quantity);
        squares += 0.5 * change * change;
    }
    return std::sqrt(squares / static_cast<double>(points.size() - 2));
}

/// Slip settles as shaft 2 loses speed until the chain carries the load: tau = J omega / (dT/ds). Towards the torque that the grip of an
/// arc allows, slip grows without bound: (dT/ds) s/T, the share of that torque that is left, vanishes, and small changes of what the chain
/// carries become large ones of slip.
void judge_slip(const MeanPoint& begin, const MeanPoint& end, const SteadyRule& rule, SteadyMeans& means) noexcept {
    constexpr double least_left = 0.01, unseen_load = 0.2;  // unseen change of what the chain carries, over the tolerance
    const double torque = std::abs(end.mean_since(begin, Mean::torque, 1)), speed = std::abs(end.mean_since(begin, Mean::speed, 1));
    const double clamping = std::min(end.mean_since(begin, Mean::clamping, 0), end.mean_since(begin, Mean::clamping, 1));
    const double allowed = rule.grip * clamping * end.mean_since(begin, Mean::radius, 1);
    if (!(rule.inertia * torque > 0.0 && allowed > 0.0)) return;
    const double left = std::max(least_left, 1.0 - torque / allowed), slipping = std::abs(means.error[friction_slip].mean);
    const double settling = rule.inertia * speed * slipping / (torque * left);
    means.to_come = std::max(1.0, settling / (end.time - begin.time));  // a decay is off in the mean by that times its change
    means.unseen_slip = unseen_load * rule.tolerance * (1.0 - left) / left;
}

/// Adds what does not show of a slip near its limit. @param held  the sheave is, so that the ratio follows
void add_unseen_slip(SteadyMeans& means, bool held) noexcept {
    const double of_power = means.unseen_slip * std::abs(means.error[friction_slip].mean);
    const double power = means.error[losses].mean / std::max(1e-9, 1.0 - means.error[efficiency].mean);
    const auto add = [&](std::size_t quantity, double unseen) {
        means.error[quantity].drift = std::hypot(means.error[quantity].drift, unseen);
    };
    for (const std::size_t quantity : {slip, friction_slip}) add(quantity, means.unseen_slip * std::abs(means.error[quantity].mean));
    if (held) add(0, of_power * std::abs(means.error[0].mean));
    if (!std::isfinite(power)) return;
    add(losses, of_power * std::abs(power));
    add(efficiency, of_power);
}

void fill_errors(std::span<const Block> blocks, MeanErrors& errors) noexcept {
    errors.batches = blocks.size();
    for (std::size_t quantity = 0; quantity < MeanErrors::count; ++quantity) {
        std::array<double, max_blocks> values{};
        for (std::size_t k = 0; k < blocks.size(); ++k) values[k] = blocks[k].mean[quantity];
        errors.error[quantity] = error_of_mean({values.data(), blocks.size()});
    }
}

/// Mean power of a kind of loss [W].
[[nodiscard]] double loss_rate(const MeanPoint& begin, const MeanPoint& end, model::Loss of) noexcept {
    const auto kind = static_cast<std::size_t>(of);
    return (end.energy.loss[kind] - begin.energy.loss[kind]) / (end.time - begin.time);
}

/// Adds an error of the losses [W] to theirs and to the efficiency's. @param part  of both errors
void add_of_losses(double error, double MeanError::*part, MeanErrors& errors) noexcept {
    MeanError &losses_of = errors.error[losses], &efficiency_of = errors.error[efficiency];
    losses_of.*part = std::hypot(losses_of.*part, error);
    if (losses_of.mean > 0.0) efficiency_of.*part = std::hypot(efficiency_of.*part, error * (1.0 - efficiency_of.mean) / losses_of.mean);
}

/// Adds how irregular the rails of guides are to the errors of losses and efficiency.
void add_rails(const MeanPoint& begin, const MeanPoint& end, MeanErrors& errors) noexcept {
    const double scatter = std::min(1.0, rail_scatter * std::sqrt(rail_time / (end.time - begin.time)));
    add_of_losses(loss_rate(begin, end, model::Loss::guide) * scatter, &MeanError::noise, errors);
}

/// Whether tensions swing more and more. points: of the window [periods + 1]
void judge_swing(std::span<const MeanPoint> points, SteadyMeans& means) noexcept {
    const std::size_t last = points.size() - 1, quarter = last / 4 * 2;  // even numbers of periods
    const double tight = means.error[2].mean;
    if (!(tight > 0.0)) return;
    const double before = alternation(points[last - 2 * quarter], points[last - quarter]);
    const double after = alternation(points[last - quarter], points[last]);
    means.alternation = after / tight;
    means.grows = means.alternation > noticed_alternation && after > before;
    for (const Mean quantity : {Mean::tight, Mean::slack}) {
        const double earlier = swing(points.first(last / 2 + 1), quantity), later = swing(points.last(last / 2 + 1), quantity);
        means.swing = std::max(means.swing, later / tight);
        means.grows = means.grows || (later > noticed_swing * tight && later > growth_of_swing * earlier);
    }
}

}  // namespace

MeanErrors mean_errors(const MeanCurve& curve) noexcept {
    MeanErrors errors;
    if (curve.empty()) return errors;
    const double period = curve.pin_period(), end = curve.last().time, span = end - curve.first().time;
    const double all = period > 0.0 ? std::floor(span / period * (1.0 + 1e-9)) : 0.0;
    if (all < static_cast<double>(min_blocks)) return errors;
    double count = 0.0, length = 0.0;
    for (std::size_t n = max_blocks; n >= min_blocks; --n) {  // those that leave out least
        const double number = static_cast<double>(n), each = std::floor(all / number);
        if (number * each > count * length) count = number, length = each;
    }
    std::array<Block, max_blocks> blocks{};
    const MeanPoint first = curve.at(end - count * length * period);
    MeanPoint begin = first;
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
        const MeanPoint next = curve.at(end - (count - 1.0 - static_cast<double>(k)) * length * period);
        blocks[k] = block_of(begin, next);
        begin = next;
    }
    fill_errors({blocks.data(), static_cast<std::size_t>(count)}, errors);
    add_rails(first, begin, errors);
    return errors;
}

MeanErrors noted_errors(MeanErrors errors, double tolerance, bool held) noexcept {
    errors.judge(tolerance, held ? 1.0 : share_of_ratio, min_noted_slip, losses);
    return errors;
}

void judge_control(const MeanCurve& curve, SteadyRule& rule) noexcept {
    const auto last = static_cast<std::size_t>(rule.controlled);
    const MeanPoint &begin = curve.points()[last / 2], &end = curve.points()[last];
    const double lost = (end.energy.lost() - begin.energy.lost()) / (end.time - begin.time);
    rule.cylinder = loss_rate(begin, end, model::Loss::cylinder);
    const bool moves = rule.cylinder > moved_share * rule.tolerance * lost || curve.pin_period() > longest_held_period;
    if (rule.tolerance > 0.0 && moves) rule.controlled = 0.0;
}

SteadyMeans steady_means(const MeanCurve& curve, const SteadyRule& rule) noexcept {
    const std::span<const MeanPoint> points = curve.points();
    const auto first = static_cast<std::size_t>(rule.controlled), unit = static_cast<std::size_t>(rule.repeats);
    const std::size_t periods = points.size() <= first ? 0 : points.size() - 1 - first;
    SteadyMeans means;
    const std::size_t batches = std::min(max_blocks, periods / 2 / unit);
    if (batches < min_blocks || static_cast<double>(periods) < (rule.brief > 0.0 ? rule.brief : rule.pins)) return means;
    means.early = !rule.holds_sheave() && static_cast<double>(periods) < std::min(min_revolutions * rule.pins, rule.limit);
    means.batch = periods / 2 / batches / unit * unit;
    means.begin = first + periods - batches * means.batch;
    std::array<Block, max_blocks> blocks{};
    for (std::size_t k = 0; k < batches; ++k)
        blocks[k] = block_of(points[means.begin + k * means.batch], points[means.begin + (k + 1) * means.batch]);
    fill_errors({blocks.data(), batches}, means);
    const MeanPoint &begin = points[means.begin], &end = points.back();
    add_rails(begin, end, means);
    judge_slip(begin, end, rule, means);
    for (const std::size_t quantity : {slip, friction_slip, losses, efficiency}) means.error[quantity].drift *= means.to_come;
    const bool held = rule.holds_ratio && end.mean_since(begin, Mean::limited) <= often_limited;
    means.off_target = held ? std::abs(end.mean_since(begin, Mean::missed)) : 0.0;
    const double cylinder = rule.holds_sheave() ? std::max(0.0, rule.cylinder - loss_rate(begin, end, model::Loss::cylinder)) : 0.0;
    means.astray = rule.brief > 0.0 && means.off_target > misses_held;
    means.unseen = unseen_share * rule.tolerance;
    means.unseen_ratio = means.unseen * (held ? share_of_ratio : 1.0);
    for (std::size_t quantity = 0; quantity < SteadyMeans::count; ++quantity) {  // what is held decides the others
        MeanError& error = means.error[quantity];
        error.drift = std::hypot(error.drift, (quantity == 0 ? means.unseen_ratio : means.unseen) * means.scale(quantity, min_steady_slip));
        error.drift += means.off_target * std::abs(quantity == efficiency ? 1.0 - error.mean : error.mean);
    }
    const double of_ratio = static_cast<double>(periods) < rule.limit ? share_of_ratio : share_at_end;
    means.judge(rule.tolerance, held && !rule.holds_sheave() ? of_ratio : 1.0, min_steady_slip, efficiency);
    add_unseen_slip(means, rule.holds_sheave());
    add_of_losses(cylinder, &MeanError::drift, means);
    judge_swing(points.subspan(means.begin), means);
    const MeanPoint& middle = points[means.begin + batches / 2 * means.batch];
    const double earlier = std::abs(middle.mean_since(begin, Mean::friction_slip));
    const double later = std::abs(end.mean_since(middle, Mean::friction_slip));
    if (rule.tolerance > 0.0 && later > most_slip && later > growth_of_sliding * earlier) means.sliding = later;
    return means;
}

}  // namespace cvtflow::tasks
