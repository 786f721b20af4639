#include "tasks/run/run_means.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "tasks/step/step_method.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

namespace {

constexpr std::size_t point_numbers = sizeof(MeanPoint) / sizeof(double);
using PointNumbers = std::array<double, point_numbers>;
static_assert(std::is_trivially_copyable_v<MeanPoint> && sizeof(MeanPoint) == sizeof(PointNumbers));

[[nodiscard]] std::array<double, mean_count> values_of(const model::Observation& now) noexcept {
    std::array<double, mean_count> values{};
    const auto put = [&](Mean quantity, double value, std::size_t k = 0) { values[static_cast<std::size_t>(quantity) + k] = value; };
    put(Mean::ratio, now.ratio);
    put(Mean::slip, now.slip);
    put(Mean::friction_slip, now.friction_slip);
    put(Mean::tight, now.tight);
    put(Mean::slack, now.slack);
    put(Mean::limited, now.control_limited ? 1.0 : 0.0);
    put(Mean::loose, now.slack <= 0.0 ? 1.0 : 0.0);
    put(Mean::beyond, now.limit_use > 1.0 ? 1.0 : 0.0);
    put(Mean::turning, 0.5 * (std::abs(now.speed[0]) + std::abs(now.speed[1])));
    put(Mean::creep, now.creep.power);
    put(Mean::brought, std::max(0.0, now.work[0]) + std::max(0.0, now.work[1]));
    for (std::size_t k = 0; k < 2; ++k) {
        put(Mean::speed, now.speed[k], k);
        put(Mean::torque, now.torque[k], k);
        put(Mean::chain_torque, now.chain_torque[k], k);
        put(Mean::clamping, now.clamping[k], k);
        put(Mean::radius, now.radius[k], k);
    }
    for (std::size_t k = 0; k < 4; ++k) put(Mean::axial_force, now.axial_force[k], k);
    return values;
}

}  // namespace

void MeanCurve::clear() noexcept {
    points_.clear();
    now_ = {};
    values_ = {};
    per_point_ = 1.0;
    since_point_ = pin_period_ = 0.0;
}

void MeanCurve::add(const model::Observation& now, const EnergySums& sums, double pin_period) {
    const std::array<double, mean_count> values = values_of(now);
    const double half = points_.empty() ? 0.0 : 0.5 * (now.time - now_.time);
    for (std::size_t k = 0; k < mean_count; ++k) now_.integral[k] += half * (values_[k] + values[k]);
    now_.time = now.time;
    now_.energy = sums;
    now_.hydraulics = now.hydraulic_energy;
    values_ = values;
    pin_period_ = pin_period;
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

MeanPoint MeanCurve::at(double time) const noexcept {
    if (time >= now_.time) return now_;
    const auto after = std::find_if(points_.begin(), points_.end(), [&](const MeanPoint& point) { return point.time >= time; });
    if (after == points_.begin()) return points_.front();
    const MeanPoint& before = *(after - 1);
    const auto from = std::bit_cast<PointNumbers>(before), to = std::bit_cast<PointNumbers>(after == points_.end() ? now_ : *after);
    const double share = (time - from[0]) / (to[0] - from[0]);
    PointNumbers between{};
    for (std::size_t k = 0; k < point_numbers; ++k) between[k] = from[k] + share * (to[k] - from[k]);
    return std::bit_cast<MeanPoint>(between);
}

MeanPoint MeanCurve::instant(const MeanPoint& from) const noexcept {
    MeanPoint point = from;
    point.time += 1.0;
    for (std::size_t k = 0; k < mean_count; ++k) point.integral[k] += values_[k];
    return point;
}

void MeanCurve::save(std::vector<double>& memory) const {
    memory.insert(memory.end(), {static_cast<double>(points_.size()), per_point_, since_point_, pin_period_});
    memory.insert(memory.end(), values_.begin(), values_.end());
    const std::size_t begin = memory.size();
    memory.resize(begin + (points_.size() + 1) * point_numbers);
    std::memcpy(memory.data() + begin, &now_, sizeof(MeanPoint));
    if (!points_.empty()) std::memcpy(memory.data() + begin + point_numbers, points_.data(), points_.size() * sizeof(MeanPoint));
}

std::span<const double> MeanCurve::load(std::span<const double> memory) {
    const auto points = static_cast<std::size_t>(pop_integer(memory, 0, static_cast<int>(max_points)));
    const auto own = pop_front(memory, 3);
    per_point_ = own[0];
    since_point_ = own[1];
    pin_period_ = own[2];
    const auto values = pop_front(memory, mean_count);
    std::copy(values.begin(), values.end(), values_.begin());
    std::memcpy(static_cast<void*>(&now_), pop_front(memory, point_numbers).data(), sizeof(MeanPoint));
    points_.resize(points);
    if (points > 0)
        std::memcpy(static_cast<void*>(points_.data()), pop_front(memory, points * point_numbers).data(), points * sizeof(MeanPoint));
    return memory;
}

namespace {

constexpr std::size_t max_blocks = 8, min_blocks = 4;
/// Quantiles of Student's distribution, two-sided 95 %, by number n of blocks: n - 2 degrees of freedom.
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

/// Scale of a quantity, from its mean over the window and that of the tight strand.
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

namespace {

constexpr double gross_slip = 0.03;  ///< creep of a holding chain stays below a hundredth, a sliding one is beyond
constexpr double often = 0.05;       ///< share of time
constexpr double moves = 0.01;       ///< a mean, from begin to end of the window: it is no result to 1 %
constexpr double drifts_ratio = 0.01, drifts_slip = 0.2, min_slip = 5e-4;
constexpr double standing_speed = 0.1;   ///< of shafts, 5 mm/s at the chain: of the order of the speeds at which tips creep [rad/s]
constexpr double resolved_share = 0.05;  ///< of the losses, that the balance may leave whatever they are
constexpr double min_load = 0.01;        ///< taken by shafts, of the input
constexpr double takes_energy = 0.02;    ///< of the input; 7e-4 over 11 pin periods of the settled baseline

constexpr NoteKind kinds[] = {
    {"gross_slip", "mean slip of the last fifth above 3 %"},
    {"control_limit", "a controller was at the limit of its authority in more than 5 % of the last fifth"},
    {"slack_strand", "the slack strand carried no tension in more than 5 % of the last fifth"},
    {"clamping_limit", "a clamping force was above wear.clamping_limit at the slip speed at some time"},
    {"efficiency", "efficiency of the whole run, or of its last fifth, outside 0 … 1"},
    {"unsteady",
     "the state changes: ratio of the first and the last fifth differ by more than 1 %, slip by more than a fifth of it; a line through "
     "means of pin periods changes by more than 1 % in ratio, thrust ratio, tensions, slip or losses; the stored energy changes by more "
     "than 2 % of the input; or it was seen for less than a pin period"},
    {"standstill", "the shafts turn by less than 0.1 rad/s: slip is noise"},
    {"no_load", "drive and load transfer less power than the machine loses: slip and efficiency are those of idling"},
    {"unresolved", "losses below the resolution of the energy balance: it would not show an error of 5 % in them"},
};

/// Absolute tolerance of a balance [J]; 0 if there are too few samples to judge it.
[[nodiscard]] double unresolved(EnergyBalance balance) noexcept {
    constexpr double min_samples = 10.0;
    balance.loss = 0.0;
    return balance.samples < min_samples ? 0.0 : balance.honest();
}

/// Energy from the inputs [J].
[[nodiscard]] double input(const EnergySums& before, const EnergySums& after) noexcept {
    double in = 0.0;
    for (std::size_t k = 0; k < after.work.size(); ++k) in += std::max(0.0, after.work[k] - before.work[k]);
    return in;
}

/// Change of the stored energy, by works and losses [J].
[[nodiscard]] double change_of_energy(const EnergySums& before, const EnergySums& after) noexcept {
    double change = before.lost() - after.lost();
    for (std::size_t k = 0; k < after.work.size(); ++k) change += after.work[k] - before.work[k];
    return change;
}

/// By the mean powers of the hydraulics, which change little within a pin period.
[[nodiscard]] double efficiency_with_pump(const SpanMeans& means, const EnergySums& before, const EnergySums& after) noexcept {
    if (means.hydraulics.pump == 0.0) return means.efficiency;
    const double lasted = after.time - before.time;
    return after.efficiency_since(before, means.hydraulics.pump * lasted, means.hydraulics.lost() * lasted);
}

/// Means of one number each, with their places.
constexpr std::pair<Mean, double SpanMeans::*> scalar_means[] = {
    {Mean::ratio, &SpanMeans::ratio}, {Mean::slip, &SpanMeans::slip},     {Mean::friction_slip, &SpanMeans::friction_slip},
    {Mean::tight, &SpanMeans::tight}, {Mean::slack, &SpanMeans::slack},   {Mean::limited, &SpanMeans::limited},
    {Mean::loose, &SpanMeans::loose}, {Mean::beyond, &SpanMeans::beyond}, {Mean::turning, &SpanMeans::turning}};

void fill_means(const MeanPoint& before, const MeanPoint& after, SpanMeans& means) {
    const auto mean = [&](Mean quantity) { return after.mean_since(before, quantity); };
    const auto each = [&](Mean quantity, auto& values) {
        for (std::size_t k = 0; k < values.size(); ++k) values[k] = after.mean_since(before, quantity, k);
    };
    for (const auto& [quantity, member] : scalar_means) means.*member = mean(quantity);
    means.loss_slip = mean(Mean::brought) > 0.0 ? mean(Mean::creep) / mean(Mean::brought) : 0.0;
    each(Mean::speed, means.speed);
    each(Mean::torque, means.torque);
    each(Mean::chain_torque, means.chain_torque);
    each(Mean::clamping, means.clamping);
    each(Mean::radius, means.radius);
    each(Mean::axial_force, means.axial_force);
}

void fill_energies(const MeanPoint& before, const MeanPoint& after, SpanMeans& means) {
    const EnergySums &from = before.energy, &to = after.energy;
    const double lasted = after.time - before.time, lost = to.lost() - from.lost(), in = input(from, to);
    const auto taken_out = [&](model::Work by) {  // by a shaft, not by a cylinder
        return std::max(0.0, from.work[static_cast<std::size_t>(by)] - to.work[static_cast<std::size_t>(by)]);
    };
    const double taken = taken_out(model::Work::drive) + taken_out(model::Work::load), change = change_of_energy(from, to);
    means.no_load = in > 0.0 && taken < min_load * in;
    means.efficiency = means.no_load ? std::numeric_limits<double>::quiet_NaN() : to.efficiency_since(from);
    means.hydraulics = model::mean_powers(before.hydraulics, after.hydraulics, lasted);
    means.with_pump = means.no_load ? means.efficiency : efficiency_with_pump(means, from, to);
    means.carried = lost > 0.0 ? taken / lost : 0.0;
    means.stored = in > 0.0 ? change / in : 0.0;
    if (!(lasted > 0.0)) return;
    means.input = in / lasted;
    means.lost = lost / lasted;
    means.taken = (in - lost - change) / lasted;
}

}  // namespace

std::span<const NoteKind> note_kinds() noexcept { return kinds; }

SpanMeans RunMeans::span(double from, double to) const {
    SpanMeans means;
    if (curve_.empty()) return means;
    const double first = curve_.first().time, lasted = curve_.last().time - first, period = curve_.pin_period();
    means.begin = first + from * lasted;
    means.end = to == 1.0 ? curve_.last().time : first + to * lasted;
    means.periods = period > 0.0 ? std::floor((means.end - means.begin) / period) : 0.0;
    if (means.periods == 0.0 && period > 0.0 && means.end - first >= period) means.periods = 1.0;  // a fifth shorter than a period
    if (means.periods > 0.0) means.begin = std::max(first, means.end - means.periods * period);
    const MeanPoint before = curve_.at(means.begin), after = curve_.at(means.end);
    fill_means(before, lasted > 0.0 ? after : curve_.instant(before), means);
    fill_energies(before, after, means);
    return means;
}

MeanTrend RunMeans::trend() const { return curve_.empty() ? MeanTrend{} : largest_trend(curve_, curve_.first().time, curve_.last().time); }

RunMeans::Change RunMeans::change() const {
    const SpanMeans whole = all(), first = first_fifth(), last = last_fifth();
    const bool ratio_drifts = std::abs(last.ratio - first.ratio) > drifts_ratio * std::abs(whole.ratio);
    const bool slip_drifts = std::abs(last.slip - first.slip) > drifts_slip * std::abs(whole.slip) + min_slip;
    if (ratio_drifts || slip_drifts) return Change::drift;
    if (trend().least() > moves) return Change::trend;
    if (curve_.pin_period() > 0.0 && whole.periods < 1.0) return Change::brief;
    return std::abs(whole.stored) > takes_energy ? Change::energy : Change::none;
}

std::string RunMeans::text_of(Change change) const {
    const SpanMeans whole = all(), first = first_fifth(), last = last_fifth();
    const auto percent = [](double share) { return fmt::format("{:.3g} %", 100.0 * share); };
    switch (change) {
        case Change::drift:
            return fmt::format("means are over a changing state: ratio {:.5g} … {:.5g}, slip {} … {}", first.ratio, last.ratio,
                               percent(first.slip), percent(last.slip));
        case Change::trend: {
            const MeanTrend moving = trend();
            return fmt::format("means are over a changing state: change of {} from begin to end {} ± {}", moving.quantity,
                               percent(moving.change), percent(moving.uncertainty));
        }
        case Change::brief:
            return fmt::format("means are over less than the {:.3g} ms in which a pin takes the place of the next one",
                               1e3 * curve_.pin_period());
        case Change::energy:
            return fmt::format("means are over a changing state: the stored energy has {} {} of the input",
                               whole.stored > 0.0 ? "taken" : "given", percent(std::abs(whole.stored)));
        case Change::none: break;
    }
    return {};
}

std::array<bool, 9> RunMeans::odd(const EnergyBalance& balance) const {
    if (curve_.empty()) return {};
    const SpanMeans whole = all(), last = last_fifth();
    const auto impossible = [](double efficiency) { return efficiency < 0.0 || efficiency > 1.0; };  // not a number: none
    const bool stands = whole.turning < standing_speed;
    return {std::abs(last.slip) > gross_slip && !stands,
            last.limited > often,
            last.loose > often,
            whole.beyond > 0.0,
            !whole.no_load && (impossible(whole.efficiency) || impossible(last.efficiency)),
            change() != Change::none && !stands,
            stands,
            (whole.no_load || (std::isfinite(whole.efficiency) && whole.carried < 1.0)) && !stands,
            unresolved(balance) > resolved_share * balance.loss};
}

std::vector<Note> RunMeans::notes(const EnergyBalance& balance, bool pulleys) const {
    std::array<bool, 9> found = odd(balance);
    if (!pulleys) std::fill(found.begin(), found.end() - 1, false);
    const SpanMeans whole = all(), last = last_fifth();
    const auto percent = [](double share) { return fmt::format("{:.3g} %", 100.0 * share); };
    const std::string texts[] = {
        fmt::format("the chain slips by {}", percent(last.slip)),
        fmt::format("control is at the limit of its authority ({} of the last fifth)", percent(last.limited)),
        fmt::format("the slack strand carries no tension ({} of the last fifth)", percent(last.loose)),
        fmt::format("clamping exceeds wear.clamping_limit at its slip speed in {} of the time", percent(whole.beyond)),
        fmt::format("an efficiency of {} ({} in the last fifth) is none: what moves has taken or given energy", percent(whole.efficiency),
                    percent(last.efficiency)),
        text_of(change()),
        "the machine is at rest: slip is noise",
        fmt::format("no load: drive and load transfer {} of the losses{}", percent(whole.carried),
                    whole.no_load ? ": there is no efficiency, and slip is that of idling" : ": slip and efficiency are those of idling"),
        fmt::format("losses below the resolution of the energy balance: it would not show an error of {:.2g} J of {:.2g} J",
                    unresolved(balance), balance.loss),
    };
    std::vector<Note> notes;
    for (std::size_t k = 0; k < found.size(); ++k) {
        if (found[k]) notes.push_back({kinds[k].name, texts[k]});
    }
    return notes;
}

void RunMeans::name_notes(const EnergyBalance& balance, std::string& names) const {
    const std::array<bool, 9> found = odd(balance);
    names.clear();
    for (std::size_t k = 0; k < found.size(); ++k) {
        if (found[k]) names.append(names.empty() ? "" : " ").append(kinds[k].name);
    }
}

void RunWatch::add(const model::Observation& now, const Workspace& workspace) {
    if (!begun_) begin_ = now.time;
    begun_ = true;
    end_ = now.time;
    pin_period_ = workspace.pin_period();
    means_.add(now, workspace.energy.sums(now.time), pin_period_);
}

WatchResult RunWatch::result(const EnergyLedger& ledger, double before) const {
    const EnergyBalance balance = ledger.balance();  // ends with the last sample, which lies elsewhere with other steps
    return {balance.relative(), std::max(before, ledger.balance_error_ratio()), ledger.sums(end_).lost(), pin_period_, end_ - begin_,
            means_.all()};
}

}  // namespace cvtflow::tasks
