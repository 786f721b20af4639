/// Shafts, sheaves and inputs (EQUATIONS.md, section 8).

#include "tests/oracle/system.hpp"

#include <algorithm>
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

/// A controller: what it sees and what it asks for, from its own integral.
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

}  // namespace cvtflow::oracle
