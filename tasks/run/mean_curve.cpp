#include "tasks/run/mean_curve.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "tasks/step/step_method.hpp"

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
    put(Mean::creep, now.creep_power);
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

}  // namespace cvtflow::tasks
