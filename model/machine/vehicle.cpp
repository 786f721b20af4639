#include "model/machine/vehicle.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::model {

namespace {

constexpr double gravity = 9.81;  // [m/s²]

/// Sine and cosine of the road's angle.
struct Slope {
    explicit Slope(double grade) noexcept : cosine(1.0 / std::sqrt(1.0 + grade * grade)), sine(grade * cosine) {}
    double cosine, sine;
};

/// Slope of a table between its points. t [s]
double rate(const TimeTable& table, double t) noexcept {
    const auto after = static_cast<std::size_t>(std::upper_bound(table.time.begin(), table.time.end(), t) - table.time.begin());
    if (after == 0 || after == table.time.size()) return 0.0;
    return (table.value[after] - table.value[after - 1]) / (table.time[after] - table.time[after - 1]);
}

}  // namespace

void load_by(const Vehicle& vehicle, Load& load) {
    const double lever = vehicle.lever();
    load.inertia = vehicle.inertia() * lever * lever;
    load.quadratic = 0.5 * vehicle.air_density * vehicle.drag_area * lever * lever * lever;
    load.torque = vehicle.grade;
    for (double& value : load.torque.value) {
        const Slope road(value);
        value = vehicle.mass * gravity * (vehicle.rolling_resistance * road.cosine + road.sine) * lever;
    }
}

void Trip::follow(const Vehicle& vehicle, const Cycle& cycle) {
    vehicle_ = vehicle;
    cycle_ = cycle;
    sums_.clear();
    if (!vehicle.present() || !cycle.present()) return;
    engine_speed_ = TimeTable(cycle.engine_speed.speed, cycle.engine_speed.value);
    const double spacing = cycle.pedal_time;
    const auto intervals = static_cast<std::size_t>(std::ceil(std::max(0.0, cycle.intervals() - 1e-9)));
    sums_.assign(intervals + 1, {});
    for (std::size_t k = 0; k < intervals; ++k) {
        const TripSums more = integral(static_cast<double>(k) * spacing, static_cast<double>(k + 1) * spacing).power;
        std::transform(more.begin(), more.end(), sums_[k].begin(), sums_[k + 1].begin(), std::plus<>());
    }
}

double Trip::speed(double t) const noexcept { return cycle_.speed.at(cycle_.begin + std::max(t, 0.0)); }

Trip::Demand Trip::demand(double t) const noexcept {
    const double v = speed(t), lever = vehicle_.lever(), efficiency = vehicle_.efficiency;
    const Slope road(vehicle_.grade.at(cycle_.begin + t));
    const double weight = v > 0.0 ? vehicle_.mass * gravity : 0.0;  // a vehicle that stands is held by its brakes
    const double inert = vehicle_.inertia() * rate(cycle_.speed, cycle_.begin + t), climb = weight * road.sine;
    const double rolling = weight * road.cosine * vehicle_.rolling_resistance;
    const double air = 0.5 * vehicle_.air_density * vehicle_.drag_area * v * v, force = inert + climb + rolling + air;
    const double geared = v / lever, driven = std::max(geared, cycle_.idle_speed / cycle_.max_ratio);
    Demand d;
    d.ratio = std::clamp(std::max(engine_speed_.at(v), cycle_.idle_speed) / driven, cycle_.min_ratio, cycle_.max_ratio);
    d.driving = d.ratio * driven;
    const double least = geared < driven ? 0.0 : -cycle_.engine_drag * d.ratio;  // a clutch that slips does not brake
    d.torque = std::max(least, force * lever * (force > 0.0 ? 1.0 / efficiency : efficiency));
    const double behind_clutch = d.torque * geared, at_wheels = behind_clutch * (d.torque > 0.0 ? efficiency : 1.0 / efficiency);
    d.power = {v,
               std::max(0.0, force) * v,
               d.torque * driven,
               inert * v,
               climb * v,
               air * v,
               rolling * v,
               d.torque > least ? 0.0 : at_wheels - force * v,
               d.torque * (driven - geared),
               behind_clutch - at_wheels};
    return d;
}

Trip::Demand Trip::integral(double from, double to) const noexcept {
    constexpr int parts = 20;
    const double length = (to - from) / parts;
    Demand sum;
    for (int k = 0; k < parts; ++k) {
        const Demand d = demand(from + (k + 0.5) * length);
        sum.driving += d.driving * length;
        sum.ratio += d.ratio * length;
        sum.torque += d.torque * length;
        for (std::size_t account = 0; account < d.power.size(); ++account) sum.power[account] += d.power[account] * length;
    }
    return sum;
}

TripSums Trip::sums(double t) const noexcept {
    if (sums_.empty() || t <= 0.0) return {};
    const std::size_t before = std::min(sums_.size() - 1, static_cast<std::size_t>(t / cycle_.pedal_time));
    TripSums sum = integral(static_cast<double>(before) * cycle_.pedal_time, t).power;
    std::transform(sum.begin(), sum.end(), sums_[before].begin(), sum.begin(), std::plus<>());
    return sum;
}

void Trip::command(Parameters& p) const {
    const double end = std::max(0.0, cycle_.speed.time.back() - cycle_.begin), half = 0.5 * cycle_.pedal_time;
    TimeTable driving, ratio, torque;
    for (TimeTable* table : {&driving, &ratio, &torque}) table->time.clear(), table->value.clear();
    for (int k = 0; k < points(); ++k) {
        const double t = std::min(end, k * cycle_.pedal_time), from = std::max(0.0, t - half), length = std::min(end, t + half) - from;
        const Demand mean = length > 0.0 ? integral(from, from + length) : demand(t);
        const double divisor = length > 0.0 ? length : 1.0;
        const std::pair<TimeTable*, double> rows[] = {{&driving, mean.driving}, {&ratio, mean.ratio}, {&torque, mean.torque}};
        for (const auto& [table, sum] : rows) table->time.push_back(t), table->value.push_back(sum / divisor);
    }
    p.start.ratio = ratio.value.front();
    p.drive.speed = std::move(driving);
    p.control.ratio = std::move(ratio);
    p.load.torque = std::move(torque);
}

}  // namespace cvtflow::model
