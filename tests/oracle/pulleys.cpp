/// Shafts, sheaves and inputs, guides of the strands, cylinders, valves and pump (EQUATIONS.md, section 8).

#include "tests/oracle/system.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cvtflow::oracle {

using model::PulleyDetail;

namespace {

constexpr Real side_sign(int side) { return side == 0 ? -1.0L : 1.0L; }
/// Movable: sheaves 1+ and 2-.
constexpr bool is_movable(int shaft, int side) { return (shaft == 0) == (side == 1); }

/// Two bodies' values of one deflection u = sheave - shaft + further, its rate, and the force it gives.
struct Support {
    const System& system;
    Totals& totals;

    /// k u + c u' with c from the damping ratio and the effective mass; books energy and loss.
    [[nodiscard]] Real force(Real u, Real rate, Real stiffness, Real mass) const {
        const Real c = damping_of(system.parameters.pulley.damping_ratio, stiffness, mass);
        totals.energies.supports += 0.5L * stiffness * u * u;
        totals.loss(model::Loss::supports) += c * rate * rate;
        return stiffness * u + c * rate;
    }
};

void add_bearings(const System& system, int shaft, Totals& totals) {
    const auto& p = system.parameters.pulley;
    const Support support{system, totals};
    const Body& body = system.body[shaft];
    BodyForce& force = totals.body[shaft];
    force.force.x -= support.force(body.u.x, body.u_rate.x, p.bearing_radial, p.shaft_mass);
    force.force.y -= support.force(body.u.y, body.u_rate.y, p.bearing_radial, p.shaft_mass);
    force.force.z -= support.force(body.w, body.w_rate, p.bearing_axial, p.shaft_mass);
    force.moment.x -= support.force(body.tau.x, body.tau_rate.x, p.bearing_tilt, p.shaft_tilt_inertia);
    force.moment.y -= support.force(body.tau.y, body.tau_rate.y, p.bearing_tilt, p.shaft_tilt_inertia);
}

void add_attachment(const System& system, int shaft, int side, Totals& totals) {
    const auto& p = system.parameters.pulley;
    const Support support{system, totals};
    const int number = model::sheave_body(shaft, side);
    const Body& sheave = system.body[number];
    const Body& hub = system.body[shaft];
    BodyForce& on_sheave = totals.body[number];
    BodyForce& on_hub = totals.body[shaft];
    const Real z = side_sign(side) * system.parameters.half.length / 2.0L;

    const Real fx = support.force(sheave.u.x - hub.u.x - hub.tau.y * z, sheave.u_rate.x - hub.u_rate.x - hub.tau_rate.y * z,
                                  p.attachment_radial, p.sheave_mass);
    on_sheave.force.x -= fx;
    on_hub.force.x += fx;
    on_hub.moment.y += fx * z;
    const Real fy = support.force(sheave.u.y - hub.u.y + hub.tau.x * z, sheave.u_rate.y - hub.u_rate.y + hub.tau_rate.x * z,
                                  p.attachment_radial, p.sheave_mass);
    on_sheave.force.y -= fy;
    on_hub.force.y += fy;
    on_hub.moment.x -= fy * z;
    if (!is_movable(shaft, side)) {
        const Real fz = support.force(sheave.w - hub.w, sheave.w_rate - hub.w_rate, p.attachment_axial, p.sheave_mass);
        on_sheave.force.z -= fz;
        on_hub.force.z += fz;
    }
    const auto& imperfection = system.parameters.imperfection;
    const bool named = static_cast<int>(imperfection.sheave) == 2 * shaft + side;
    const Real tilt = named ? Real{p.attachment_tilt} * imperfection.attachment : Real{p.attachment_tilt};
    const Vec3 moment{support.force(sheave.tau.x - hub.tau.x, sheave.tau_rate.x - hub.tau_rate.x, tilt, p.sheave_tilt_inertia),
                      support.force(sheave.tau.y - hub.tau.y, sheave.tau_rate.y - hub.tau_rate.y, tilt, p.sheave_tilt_inertia),
                      support.force(sheave.phi - hub.phi, sheave.phi_rate - hub.phi_rate, p.attachment_torsion, p.sheave_polar_inertia)};
    on_sheave.moment += -moment;
    on_hub.moment += moment;
}

/// Polar inertia of a body; those of shafts include the machine behind them [kg·m²].
Real polar_inertia(const model::Parameters& p, int body) {
    if (body == 0) return Real{p.pulley.shaft_polar_inertia} + p.drive.inertia;
    if (body == 1) return Real{p.pulley.shaft_polar_inertia} + p.load.inertia;
    return p.pulley.sheave_polar_inertia;
}

/// ε = (φ_1' - i_ref φ_2')/ω_n.
Real ratio_error(const System& system) {
    const auto& p = system.parameters;
    const Real target = p.control.ratio.at(std::max(system.t, 0.0));
    const Real reference = p.drive.mode == model::DriveMode::speed ? p.drive.speed.largest_magnitude() : p.control.reference_speed;
    return (system.body[0].phi_rate - target * system.body[1].phi_rate) / reference;
}

/// Running radius by the position of the movable sheave: flanks straight, sheaves stiff.
Real radius_by_position(const System& system, int shaft) {
    const auto& p = system.parameters;
    const int side = shaft == 0 ? 1 : 0;
    const Real opening = side_sign(side) * (system.body[model::sheave_body(shaft, side)].w - system.body[shaft].w);
    return p.pulley.arc_position - opening / (2.0L * std::tan(Real{p.tip.angle}));
}

/// λ - λ_ref, λ = 1 - ω_2 r_2/(ω_1 r_1).
Real slip_error(const System& system) {
    const Real driving = system.body[0].phi_rate * radius_by_position(system, 0);
    if (driving == 0.0L) return 0.0L;
    const Real driven = system.body[1].phi_rate * radius_by_position(system, 1);
    return 1.0L - driven / driving - system.parameters.control.slip.at(std::max(system.t, 0.0));
}

/// Torque of a torsional spring and damper to an end that turns at the speed of a table [N·m]. @param from angle of that end at t = 0 [rad]
Real spring_torque(const System& system, int shaft, const model::TimeTable& speed, Real from, Real stiffness, Real damping) {
    const Body& body = system.body[shaft];
    const Real ahead = from + Real{speed.integral(system.t)} - body.phi;
    return stiffness * ahead + damping * (Real{speed.at(std::max(system.t, 0.0))} - body.phi_rate);
}

/// Spring and damper of a governor: critically damped with the inertia of the whole shaft [N·m/rad, N·m·s/rad].
std::array<Real, 2> governor(const System& system, int shaft, Real frequency) {
    const Real inertia = polar_inertia(system.parameters, shaft) + 2.0L * system.parameters.pulley.sheave_polar_inertia;
    const Real omega = 2.0L * std::numbers::pi_v<Real> * frequency;
    return {inertia * omega * omega, 2.0L * inertia * omega};
}

/// Stiffness and damping that hold shaft 2 once couplings have taken over.
std::array<Real, 2> load_holder(const System& system) {
    const auto& load = system.parameters.load;
    if (load.mode == model::LoadMode::coupling) return {load.coupling.stiffness, load.coupling.damping};
    return governor(system, 1, load.governor_frequency);
}

/// Torque against the travel of shaft 2, before the ramp [N·m].
Real load_of(const System& system) {
    const auto& load = system.parameters.load;
    if (system.far != nullptr && load.mode != model::LoadMode::torque) {
        const auto [stiffness, damping] = load_holder(system);
        return -spring_torque(system, 1, load.speed, system.far->angle[1], stiffness, damping);
    }
    const Real speed = system.body[1].phi_rate;
    return load.torque.at(std::max(system.t, 0.0)) + load.linear * speed + load.quadratic * speed * std::abs(speed);
}

/// S_1 or S_2 before control and ramp [N].
Real given_force(const System& system, int shaft) {
    const auto& p = system.parameters;
    const double from = std::max(system.t, 0.0);
    const bool by_pressure = p.hydraulics.mode == model::HydraulicMode::pressure;
    const model::Cylinder& cylinder = shaft == 0 ? p.hydraulics.driving : p.hydraulics.driven;
    const Real pressed = cylinder.area * Real{cylinder.pressure.at(from)} + force_without_pressure(system, shaft);
    if (shaft == 0) return by_pressure ? pressed : Real{p.clamping.driving.at(from)};
    const Real carried = 2.0L * p.tip.friction.coefficient * radius_by_position(system, 1) / std::cos(Real{p.tip.angle});
    return std::max(by_pressure ? pressed : Real{p.clamping.driven.at(from)}, p.clamping.safety * std::abs(load_of(system)) / carried);
}

/// A controller: its input and its request, by its integral.
struct Controller {
    enum class Holds { ratio, slip, safety };
    const System& system;
    int number;

    [[nodiscard]] bool second() const { return number == 1; }
    [[nodiscard]] const model::Control& of() const { return system.parameters.control; }
    [[nodiscard]] Holds holds() const {
        if (second()) return of().driven == model::DrivenControl::slip ? Holds::slip : Holds::safety;
        if (of().quantity == model::ControlledQuantity::ratio) return Holds::ratio;
        return of().quantity == model::ControlledQuantity::slip ? Holds::slip : Holds::safety;
    }
    [[nodiscard]] int shaft() const { return holds() == Holds::ratio ? 0 : 1; }
    [[nodiscard]] Real authority() const { return second() ? of().driven_authority : of().authority; }
    [[nodiscard]] Real integral_part() const { return (second() ? of().driven_integral : of().integral) * system.control_integral[number]; }
    /// Difference between the force that carries the required multiple of the load and S_2, over the larger of both.
    [[nodiscard]] Real safety_error() const {
        const auto& p = system.parameters;
        const Real carried_per_force = 2.0L * p.tip.friction.coefficient * radius_by_position(system, 1) / std::cos(Real{p.tip.angle});
        const Real required = of().safety.at(std::max(system.t, 0.0)) * std::abs(load_of(system)) / carried_per_force;
        const Real stands = std::max(0.0L, given_force(system, 1) + std::clamp(integral_part(), -authority(), authority()));
        if (required == 0.0L && stands == 0.0L) return 0.0L;
        return required > stands ? 1.0L - stands / required : required / stands - 1.0L;
    }
    [[nodiscard]] Real error() const {
        if (holds() == Holds::ratio) return ratio_error(system);
        return holds() == Holds::slip ? slip_error(system) : safety_error();
    }
    [[nodiscard]] Real required() const { return (second() ? of().driven_proportional : of().proportional) * error() + integral_part(); }
    /// The integral stops while the controller asks for more than it may have.
    [[nodiscard]] Real rate() const { return std::abs(required()) > authority() && required() * error() > 0.0L ? 0.0L : error(); }
};

/// S_1 and S_2, before hydraulics [N].
Real requested_force(const System& system, int shaft) {
    Real force = given_force(system, shaft);
    for (int number = 0; number < system.controllers(); ++number) {
        const Controller controller{system, number};
        if (controller.shaft() == shaft)
            force = std::max(0.0L, force + std::clamp(controller.required(), -controller.authority(), controller.authority()));
    }
    return Real{model::ramp(system.parameters.start, system.t)} * force;
}

void add_clamping(const System& system, int shaft, Real clamping, Totals& totals) {
    const int side = shaft == 0 ? 1 : 0;
    const Real s = side_sign(side);
    const int number = model::sheave_body(shaft, side);
    const Real rate = system.body[number].w_rate - system.body[shaft].w_rate;
    const Real damping = system.parameters.pulley.cylinder_damping;
    const Real on_sheave = -s * clamping - damping * rate;
    totals.body[number].force.z += on_sheave;
    totals.body[shaft].force.z -= on_sheave;
    totals.work(model::Work::clamping) += -s * clamping * rate;
    totals.loss(model::Loss::cylinder) += damping * rate * rate;
}

Real drive_torque(const System& system) {
    const auto& p = system.parameters;
    const double from = std::max(system.t, 0.0);
    if (p.drive.mode == model::DriveMode::torque) return p.drive.torque.at(from);
    if (system.far != nullptr && p.drive.mode == model::DriveMode::coupling)
        return spring_torque(system, 0, p.drive.speed, system.far->angle[0], p.drive.coupling.stiffness, p.drive.coupling.damping);
    const auto [stiffness, damping] = governor(system, 0, p.drive.governor_frequency);
    return spring_torque(system, 0, p.drive.speed, 0.0L, stiffness, damping);
}

}  // namespace

FarEnds far_ends(const model::Parameters& parameters, std::span<const double> state, std::span<const model::Phase> phases) {
    const std::vector<Real> exact(state.begin(), state.end());
    const System system = unpack(parameters, 0.0, exact, phases);
    const auto ahead = [&](int shaft, Real torque, const model::TimeTable& speed, Real stiffness, Real damping) {
        const Body& body = system.body[shaft];
        return body.phi + (torque - damping * (Real{speed.at(0.0)} - body.phi_rate)) / stiffness;
    };
    const auto [stiffness, damping] = load_holder(system);
    const auto& drive = parameters.drive;
    return {{ahead(0, drive_torque(system), drive.speed, drive.coupling.stiffness, drive.coupling.damping),
             ahead(1, -load_of(system), parameters.load.speed, stiffness, damping)}};
}

void add_supports(const System& system, Totals& totals) {
    if (system.parameters.detail.pulleys != PulleyDetail::elastic) return;
    for (const int shaft : {0, 1}) {
        add_bearings(system, shaft, totals);
        for (const int side : {0, 1}) add_attachment(system, shaft, side, totals);
    }
}

void add_gyroscopic(const System& system, Totals& totals) {
    if (system.parameters.detail.pulleys != PulleyDetail::elastic) return;
    for (int b = 0; b < bodies; ++b) {
        const Body& body = system.body[b];
        const Real spin = polar_inertia(system.parameters, b) * body.phi_rate;
        totals.body[b].moment.x -= spin * body.tau_rate.y;
        totals.body[b].moment.y += spin * body.tau_rate.x;
    }
}

/// Seals, bearings and oil against the travel of a shaft [N·m].
Real drag_torque(const System& system, int shaft, const std::array<Real, 2>& clamping) {
    const auto& p = system.parameters;
    Real pull = 0.0L;  // of both strands, by the tension that each pulley holds
    for (const int pulley : {0, 1}) {
        const Real larger = radius_by_position(system, pulley) - radius_by_position(system, 1 - pulley);
        const Real wrap = std::numbers::pi_v<Real> + 2.0L * std::asin(larger / p.pulley.centre_distance);
        const Real tension = 2.0L * clamping[pulley] * std::tan(Real{p.tip.angle}) / wrap;
        pull += 0.5L * (2.0L * tension * std::sin(wrap / 2.0L));
    }
    const model::ShaftDrag& of = shaft == 0 ? p.drag.driving : p.drag.driven;
    const Real dry = of.seals + p.drag.bearing_friction * pull * p.drag.bearing_diameter / 2.0L;
    const Real speed = system.body[shaft].phi_rate;
    const Real resisting = std::clamp(speed, -1.0L, 1.0L) * dry + of.viscous * speed + of.churning * speed * std::abs(speed);
    return Real{model::ramp(p.start, system.t)} * resisting;
}

void add_inputs(const System& system, Totals& totals) {
    std::array<Real, 2> clamping{requested_force(system, 0), requested_force(system, 1)};
    if (system.layout.hydraulic() && system.far != nullptr) clamping = hydraulic_forces(system, clamping, totals);
    for (const int shaft : {0, 1}) add_clamping(system, shaft, clamping[shaft], totals);
    const Real torque = drive_torque(system) - drag_torque(system, 0, clamping);
    totals.body[0].moment.z += torque;
    totals.work(model::Work::drive) += torque * system.body[0].phi_rate;
    const Real load = Real{model::ramp(system.parameters.start, system.t)} * load_of(system) + drag_torque(system, 1, clamping);
    totals.body[1].moment.z -= load;
    totals.work(model::Work::load) -= load * system.body[1].phi_rate;
    for (int number = 0; number < system.controllers(); ++number) totals.control_rate[number] = Controller{system, number}.rate();
}

namespace {

/// Both rails of one strand.
struct Guide {
    Vec2 from, along, outward;  ///< beside where the strand leaves the driving pulley; unit vectors
    Real length;                ///< [m]
};

/// Guides of the belt that is as long as the chain. The outward normal of the lower strand is (cos γ, -sin γ) with a cos γ = r_1 - r_2.
std::array<Guide, 2> guides_of(const model::Parameters& p) {
    const Real distance = p.pulley.centre_distance, ratio = p.start.ratio, turn = 2.0L * std::numbers::pi_v<Real>;
    const auto angle = [&](Real radius) { return std::acos((1.0L - ratio) * radius / distance); };
    const auto length = [&](Real radius) {
        const Real wrap = 2.0L * angle(radius);
        return 2.0L * distance * std::sin(angle(radius)) + wrap * ratio * radius + (turn - wrap) * radius;
    };
    Real low = 0.0L, high = distance / (1.0L + ratio), chain = 0.0L;
    for (int link = 0; link < p.chain.pins; ++link) chain += p.chain.pitch[static_cast<std::size_t>(link) % p.chain.pitch.size()];
    for (int halving = 0; halving < 200; ++halving) {
        const Real middle = (low + high) / 2.0L;
        (length(middle) < chain ? low : high) = middle;
    }
    const Vec2 outward{std::cos(angle(low)), -std::sin(angle(low))}, along = left_of(outward), from = (low + p.guide.offset) * outward;
    const auto mirrored = [](Vec2 v) { return Vec2{v.x, -v.y}; };
    const Real strand = distance * std::sin(angle(low));
    return {Guide{from, along, outward, strand}, {mirrored(from), mirrored(along), mirrored(outward), strand}};
}

/// Force on a part of a pin at one guide; books energy and loss.
Vec2 guide_force(const model::Guide& p, const Guide& guide, Real part, Vec2 at, Vec2 rate, Totals& totals) {
    const Real s = dot(at + -guide.from, guide.along) / guide.length, u = dot(at + -guide.from, guide.outward);
    const Real rail = Real{p.end} - p.begin, ramp = rail / 5.0L;
    if (s < p.begin || s > p.end || std::abs(u) < p.clearance) return {};
    const bool entering = s - p.begin < p.end - s;
    const Real z = std::min(1.0L, (entering ? s - p.begin : p.end - s) / ramp);
    const Real slope = (entering ? 1.0L : -1.0L) * (z < 1.0L ? 6.0L * (z - z * z) : 0.0L) / (ramp * guide.length);
    const Real k = part * p.stiffness, w = 3.0L * z * z - 2.0L * z * z * z;
    const Vec2 pressing = u > 0.0L ? guide.outward : -guide.outward;
    const Real depth = std::abs(u) - p.clearance, approach = dot(rate, pressing);
    const Real normal = k * w * depth * std::max(0.0L, 1.0L + p.damping * approach);
    const Real speed = dot(rate, guide.along), friction = p.friction * normal * std::clamp(speed, -1.0L, 1.0L);
    totals.energies.supports += k * w * depth * depth / 2.0L;
    totals.loss(model::Loss::guide) += friction * speed + (normal - k * w * depth) * approach;
    return -normal * pressing + (-friction - k * slope * depth * depth / 2.0L) * guide.along;
}

}  // namespace

void add_guides(const System& system, Totals& totals) {
    const model::Guide& p = system.parameters.guide;
    if (!p.present()) return;
    const std::array<Guide, 2> guides = guides_of(system.parameters);
    const auto force = [&](Real part, Vec2 at, Vec2 rate) { return guide_force(p, guides[at.y > 0.0L ? 1 : 0], part, at, rate, totals); };
    for (std::size_t i = 0; i < system.links.size(); ++i) {
        for (const model::End end : {model::End::rear, model::End::front}) {
            const Half& half = system.links[i].half(end);
            totals.link[i].half(end).shape[0] += force(0.5L, half.shape[0], half.shape_rate[0]);
        }
    }
    for (std::size_t i = 0; i < system.pins.size(); ++i)
        totals.pin[i].middle += force(1.0L, system.pins[i].middle, system.pins[i].middle_rate);
}

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

/// Line pressure, after the valves' flows have been reduced to the delivery of the pump [Pa]. delivered [m³/s]
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
