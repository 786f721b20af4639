/// Cylinders, valves and pump (EQUATIONS.md, section 8, hydraulics).

#include "tests/oracle/system.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cvtflow::oracle {

namespace {

constexpr Real toward_chain(int shaft) { return shaft == 0 ? -1.0L : 1.0L; }

const model::Cylinder& cylinder_of(const System& system, int shaft) {
    return shaft == 0 ? system.parameters.hydraulics.driving : system.parameters.hydraulics.driven;
}

/// ∫ ρ ω² (r² - r_0²)/2 dA over a ring from its inner to its outer radius [N].
Real rotating_oil(const System& system, int shaft, Real area) {
    const auto& h = system.parameters.hydraulics;
    const Real omega = system.body[shaft].phi_rate, inner = cylinder_of(system, shaft).inner, pi = std::numbers::pi_v<Real>;
    const Real outer = std::sqrt(inner * inner + area / pi);
    const auto primitive = [&](Real r) { return r * r * r * r / 4.0L - Real{h.feed_radius} * h.feed_radius * r * r / 2.0L; };
    return h.oil_density * omega * omega * pi * (primitive(outer) - primitive(inner));
}

Real velocity(const System& system, int shaft) {
    const int number = model::sheave_body(shaft, shaft == 0 ? 1 : 0);
    return toward_chain(shaft) * (system.body[number].w_rate - system.body[shaft].w_rate);
}

struct Valve {
    Real area, set, pressure, from_pump, to_tank, from_tank;  ///< [m²], [Pa], [Pa], flows ≥ 0 [m³/s]
};

Valve valve_of(const System& system, int shaft) {
    const auto& h = system.parameters.hydraulics;
    const Real area = cylinder_of(system, shaft).area, per_travel = area * h.oil_modulus / h.oil_volume;
    const Real pressure = per_travel * (system.oil[2 + shaft] - travel(system, shaft)), set = per_travel * system.oil[shaft];
    const Real drop = set - pressure;
    return {area,
            set,
            pressure,
            h.valve_conductance * std::max(drop, 0.0L),
            h.valve_conductance * std::max(-drop, 0.0L),
            h.valve_conductance * std::max(-pressure, 0.0L)};
}

/// Line pressure, after the valves' flows have been reduced to what the pump delivers [Pa]. delivered [m³/s]
Real line_pressure(const System& system, Real delivered, Valve (&valves)[2]) {
    const auto& h = system.parameters.hydraulics;
    const Real taken = valves[0].from_pump + valves[1].from_pump;
    if (taken <= delivered) {
        const Real held = std::max(std::max(valves[0].set, valves[1].set) + h.line_margin, Real{h.line_minimum});
        return std::min(held, Real{h.relief_pressure});
    }
    Real line = 0.0L;
    for (Valve& valve : valves) {
        valve.from_pump *= delivered / taken;
        line = std::max(line, valve.pressure + valve.from_pump / h.valve_conductance);
    }
    return line;
}

}  // namespace

Real travel(const System& system, int shaft) {
    const int number = model::sheave_body(shaft, shaft == 0 ? 1 : 0);
    return toward_chain(shaft) * (system.body[number].w - system.body[shaft].w);
}

Real force_without_pressure(const System& system, int shaft) {
    const model::Cylinder& of = cylinder_of(system, shaft);
    const Real spring = std::max(0.0L, of.spring - of.spring_rate * travel(system, shaft));
    return spring + rotating_oil(system, shaft, of.area) - rotating_oil(system, shaft, of.compensation);
}

std::array<Real, 2> hydraulic_forces(const System& system, const std::array<Real, 2>& requested, Totals& totals) {
    const auto& h = system.parameters.hydraulics;
    const Real turns = h.pump_ratio * std::abs(system.body[0].phi_rate) + h.pump_speed.at(std::max(system.t, 0.0));
    const Real displaced = h.pump_displacement * turns / (2.0L * std::numbers::pi_v<Real>), delivered = h.pump_volumetric * displaced;
    Valve valves[2] = {valve_of(system, 0), valve_of(system, 1)};
    const Real taken = valves[0].from_pump + valves[1].from_pump, line = line_pressure(system, delivered, valves);
    std::array<Real, 2> forces;
    Real* rates = totals.control_rate + system.controllers();
    rates[4] = line * displaced / h.pump_mechanical;
    rates[5] = line * std::max(0.0L, delivered - taken);
    for (const int shaft : {0, 1}) {
        const Valve& v = valves[shaft];
        const Real others = force_without_pressure(system, shaft), per_travel = v.area * h.oil_modulus / h.oil_volume;
        const Real target = std::clamp((requested[shaft] - others) / v.area, 0.0L, Real{h.relief_pressure});
        rates[shaft] = std::clamp((target - v.set) / h.valve_lag, -Real{h.valve_rate}, Real{h.valve_rate}) / per_travel;
        const Real leaked = h.leakage * std::max(v.pressure, 0.0L);
        rates[2 + shaft] = (v.from_pump - v.to_tank + v.from_tank - leaked) / v.area;
        rates[6] += v.from_pump * (line - v.pressure) + v.to_tank * v.pressure - v.from_tank * v.pressure;
        rates[7] += leaked * v.pressure;
        rates[8] += v.area * v.pressure * velocity(system, shaft);
        forces[shaft] = std::max(0.0L, v.area * v.pressure + others);
    }
    return forces;
}

}  // namespace cvtflow::oracle
