#include "model/force/hydraulics.hpp"

#include <algorithm>
#include <numbers>

namespace cvtflow::model {

namespace {

/// Force over ω² of oil that turns with a ring-shaped piston, at zero pressure on the feed radius: ∫ ρ (r² - r_0²)/2 dA [N·s²].
[[nodiscard]] double rotating_oil(double density, double area, double inner, double feed) noexcept {
    return 0.5 * density * area * (inner * inner + area / (2.0 * std::numbers::pi) - feed * feed);
}

[[nodiscard]] std::size_t place_of(HydraulicUnknown unknown) noexcept { return static_cast<std::size_t>(unknown); }

}  // namespace

HydraulicEnergy mean_powers(const HydraulicEnergy& from, const HydraulicEnergy& to, double time) noexcept {
    HydraulicEnergy powers;
    if (!(time > 0.0)) return powers;
    using E = HydraulicEnergy;
    for (double E::*kind : {&E::pump, &E::mechanical, &E::volumetric, &E::relief, &E::valves, &E::leakage, &E::sheaves, &E::stored})
        powers.*kind = (to.*kind - from.*kind) / time;
    return powers;
}

void HydraulicModel::adopt(const Hydraulics& hydraulics) {
    data_ = hydraulics;
    capacity_ = data_.oil_volume / data_.oil_modulus;
    per_radian_ = data_.pump_displacement / (2.0 * std::numbers::pi);
    for (int shaft = 0; shaft < 2; ++shaft) {
        const Cylinder& of = cylinder(shaft);
        rotating_[static_cast<std::size_t>(shaft)] = rotating_oil(data_.oil_density, of.area, of.inner, data_.feed_radius) -
                                                     rotating_oil(data_.oil_density, of.compensation, of.inner, data_.feed_radius);
    }
}

double HydraulicModel::other_force(int shaft, const CylinderMotion& motion) const noexcept {
    const Cylinder& of = cylinder(shaft);
    const double spring = std::max(0.0, of.spring - of.spring_rate * motion.position);
    return rotating_[static_cast<std::size_t>(shaft)] * motion.turning * motion.turning + spring;
}

double HydraulicModel::target(int shaft, const CylinderMotion& motion, double force) const noexcept {
    return std::clamp((force - other_force(shaft, motion)) / area(shaft), 0.0, data_.relief_pressure);
}

HydraulicInstant HydraulicModel::instant(const double* unknowns, const std::array<CylinderMotion, 2>& motion,
                                         const std::array<double, 2>& requested, double pump_speed) const noexcept {
    HydraulicInstant now;
    now.pump_speed = pump_speed;
    for (int shaft = 0; shaft < 2; ++shaft) {
        const auto k = static_cast<std::size_t>(shaft);
        now.target[k] = target(shaft, motion[k], requested[k]);
        now.set[k] = stiffness(shaft) * unknowns[place_of(HydraulicUnknown::set_1) + k];
        now.pressure[k] = stiffness(shaft) * (unknowns[place_of(HydraulicUnknown::oil_1) + k] - motion[k].position);
        now.flow[k] = data_.valve_conductance * (now.set[k] - now.pressure[k]);
        now.force[k] = std::max(0.0, area(shaft) * now.pressure[k] + other_force(shaft, motion[k]));
        now.sheaves += area(shaft) * now.pressure[k] * motion[k].speed;
        const double above = std::max(0.0, now.pressure[k]);
        now.leakage += data_.leakage * above * above;
    }
    share_flow(now);
    return now;
}

/// Flow that the valves take from the pump. A pump with less flow fills both cylinders in proportion, at the pressure that this takes.
void HydraulicModel::share_flow(HydraulicInstant& now) const noexcept {
    const double displaced = per_radian_ * now.pump_speed;
    now.pump_flow = data_.pump_volumetric * displaced;
    const double taken = std::max(0.0, now.flow[0]) + std::max(0.0, now.flow[1]);
    const bool enough = taken <= now.pump_flow;
    const double share = enough ? 1.0 : now.pump_flow / taken;
    now.spill = enough ? now.pump_flow - taken : 0.0;
    double needed = 0.0;
    for (std::size_t k = 0; k < 2; ++k) {
        if (now.flow[k] > 0.0) now.flow[k] *= share;
        needed = std::max(needed, now.pressure[k] + std::max(0.0, now.flow[k]) / data_.valve_conductance);
    }
    const double held = std::max(std::max(now.set[0], now.set[1]) + data_.line_margin, data_.line_minimum);
    now.line = enough ? std::min(held, data_.relief_pressure) : needed;
    now.pump_torque = per_radian_ * now.line / data_.pump_mechanical;
    now.pump = now.pump_torque * now.pump_speed;
    now.mechanical = (1.0 - data_.pump_mechanical) * now.pump;
    now.volumetric = (1.0 - data_.pump_volumetric) * displaced * now.line;
    now.relief = now.spill * now.line;
    for (std::size_t k = 0; k < 2; ++k) {
        now.valves += now.flow[k] > 0.0 ? now.flow[k] * (now.line - now.pressure[k]) : -now.flow[k] * now.pressure[k];
        const double sucked = data_.valve_conductance * std::max(0.0, -now.pressure[k]);  // from the tank
        now.valves -= sucked * now.pressure[k];
        now.flow[k] += sucked;
    }
}

void HydraulicModel::rates(const HydraulicInstant& now, double* rates) const noexcept {
    for (int shaft = 0; shaft < 2; ++shaft) {
        const auto k = static_cast<std::size_t>(shaft);
        const double set = std::clamp((now.target[k] - now.set[k]) / data_.valve_lag, -data_.valve_rate, data_.valve_rate);
        rates[place_of(HydraulicUnknown::set_1) + k] = set / stiffness(shaft);
        rates[place_of(HydraulicUnknown::oil_1) + k] = (now.flow[k] - data_.leakage * std::max(0.0, now.pressure[k])) / area(shaft);
    }
    rates[place_of(HydraulicUnknown::pump)] = now.pump;
    rates[place_of(HydraulicUnknown::relief)] = now.relief;
    rates[place_of(HydraulicUnknown::valves)] = now.valves;
    rates[place_of(HydraulicUnknown::leakage)] = now.leakage;
    rates[place_of(HydraulicUnknown::sheaves)] = now.sheaves;
}

void HydraulicModel::fill(const std::array<CylinderMotion, 2>& motion, const std::array<double, 2>& force,
                          double* unknowns) const noexcept {
    std::fill_n(unknowns, hydraulic_unknowns, 0.0);
    const double droop = 1.0 + data_.leakage / data_.valve_conductance;  // a valve at rest feeds the leakage
    for (int shaft = 0; shaft < 2; ++shaft) {
        const auto k = static_cast<std::size_t>(shaft);
        const double pressure = target(shaft, motion[k], force[k]);
        unknowns[place_of(HydraulicUnknown::set_1) + k] = std::min(droop * pressure, data_.relief_pressure) / stiffness(shaft);
        unknowns[place_of(HydraulicUnknown::oil_1) + k] = motion[k].position + pressure / stiffness(shaft);
    }
}

HydraulicEnergy HydraulicModel::energy(const double* unknowns, const std::array<CylinderMotion, 2>& motion) const noexcept {
    HydraulicEnergy sums;
    sums.pump = unknowns[place_of(HydraulicUnknown::pump)];
    const double hydraulic = data_.pump_mechanical * sums.pump;
    sums.mechanical = sums.pump - hydraulic;
    sums.volumetric = (1.0 - data_.pump_volumetric) * hydraulic;
    sums.relief = unknowns[place_of(HydraulicUnknown::relief)];
    sums.valves = unknowns[place_of(HydraulicUnknown::valves)];
    sums.leakage = unknowns[place_of(HydraulicUnknown::leakage)];
    sums.sheaves = unknowns[place_of(HydraulicUnknown::sheaves)];
    for (int shaft = 0; shaft < 2; ++shaft) {
        const auto k = static_cast<std::size_t>(shaft);
        const double pressure = stiffness(shaft) * (unknowns[place_of(HydraulicUnknown::oil_1) + k] - motion[k].position);
        sums.stored += 0.5 * capacity_ * pressure * pressure;
    }
    return sums;
}

}  // namespace cvtflow::model
