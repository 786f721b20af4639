
#include "model/force/pulley_inputs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <tuple>
#include <utility>

#include "model/basis/portable_math.hpp"

namespace cvtflow::model {
namespace {

constexpr double full_drag_speed = 1.0;  ///< below, dry drag is proportional to the speed [rad/s]
constexpr double following_time = 0.01;  ///< time constant of a controller's integral that follows a held sheave's force [s]

/// S_1 of a sheave that is held [N]. block [unknowns of the pulleys]
double holding_force(const HeldSheave& held, double t, const PulleyCoordinates& at, const double* block) noexcept {
    constexpr double stiffness = 1e9, damping = 3e4, leading_time = 5e-3;  // [N/m, N*s/m, s]
    const double led = held.offset * std::max(0.0, 1.0 - (t - held.since) / leading_time);
    const double moved = at.opening(block, 0) - held.opening - led, speed = at.opening(block + at.size(), 0);
    return std::max(0.0, held.force + stiffness * moved + damping * speed);
}

/// Whether shaft 2 has a clamping force, or a pressure, without clamping.safety. now ≥ 0 [s]
bool has_floor(const Clamping& clamping, const Hydraulics& hydraulics, const HeldInputs& held, double now) noexcept {
    if (hydraulics.mode == HydraulicMode::pressure) return held.values.at(Input::pressure_driven, hydraulics.driven.pressure, now) > 0.0;
    return held.values.at(Input::clamping_driven, clamping.driven, now) > 0.0;
}

}  // namespace

double scaling_speed(const Parameters& p) noexcept {
    return p.drive.mode != DriveMode::torque ? p.drive.speed.largest_magnitude() : p.control.reference_speed;
}

double grip(const Tip& tip) noexcept { return 2.0 * tip.largest_friction() / portable_cos(tip.angle); }

double shaft_inertia(const Pulley& pulley, double added) noexcept {
    return pulley.shaft_polar_inertia + 2.0 * pulley.sheave_polar_inertia + added;
}

double carrying_clamping(double safety, double load, double lever) noexcept { return safety * std::abs(load) / lever; }

double driven_clamping(const Clamping& clamping, double table, double load, double lever) noexcept {
    return clamping.safety == 0.0 ? table : std::max(table, carrying_clamping(clamping.safety, load, lever));
}

void PulleyInputs::adopt(const Parameters& p) {
    torques_.adopt(p);
    clamping_ = p.clamping;
    control_ = p.control;
    hydraulics_.adopt(p.hydraulics);
    start_ = p.start;
    grip_ = grip(p.tip);
    reference_speed_ = scaling_speed(p);
    drag_ = p.drag;
    centre_distance_ = p.pulley.centre_distance;
    wedge_ = 2.0 * portable_sin(p.tip.angle) / portable_cos(p.tip.angle);
    controllers_ = controllers(control_);
    const bool by_driving = control_.quantity == ControlledQuantity::ratio;
    governing_[0] = {control_.quantity, by_driving ? 0u : 1u, control_.proportional, control_.integral, control_.authority};
    const auto beside = control_.driven == DrivenControl::slip ? ControlledQuantity::slip : ControlledQuantity::safety;
    governing_[1] = {beside, 1, control_.driven_proportional, control_.driven_integral, control_.driven_authority};
}

double PulleyInputs::control_error(const Governing& by, double now, double load, double built_up, const double* block) const noexcept {
    const PulleyCoordinates& at = coordinates();
    if (by.quantity == ControlledQuantity::safety) {  // what is missing to the force that carries the target multiple of the load
        const double required = carrying_clamping(control_.safety.at(now), load, driven_lever(block));
        const double larger = std::max(required, built_up);
        return larger > 0.0 ? (required - built_up) / larger : 0.0;
    }
    const double driving = at.shaft_speed(block, 0), driven = at.shaft_speed(block, 1);
    if (by.quantity == ControlledQuantity::ratio) {
        const double faster = (driving - torques_.held().values.at(Input::ratio, control_.ratio, now) * driven) / reference_speed_;
        return driving < 0.0 ? -faster : faster;
    }
    return driving * at.running_radius(block, 0) != 0.0 ? position_slip(block) - control_.slip.at(now) : 0.0;
}

double PulleyInputs::position_slip(const double* block) const noexcept {
    const PulleyCoordinates& at = coordinates();
    const double geared = at.shaft_speed(block, 0) * at.running_radius(block, 0);
    return geared != 0.0 ? 1.0 - at.shaft_speed(block, 1) * at.running_radius(block, 1) / geared : 0.0;
}

ControlInstant PulleyInputs::controlled(double t, const double* tail, const Inputs& now) const noexcept {
    if (controllers_ == 0) return {};
    const double when = std::max(t, 0.0);
    ControlInstant of;
    for (const Governing& by : std::span(governing_).first(static_cast<std::size_t>(controllers_)))
        of.force[by.shaft] = now.clamping[by.shaft];
    switch (governing_[0].quantity) {
        case ControlledQuantity::ratio:
            of.target = torques_.held().values.at(Input::ratio, control_.ratio, when);
            of.value = coordinates().shaft_speed(tail, 0) / coordinates().shaft_speed(tail, 1);
            break;
        case ControlledQuantity::slip: std::tie(of.target, of.value) = std::pair(control_.slip.at(when), position_slip(tail)); break;
        case ControlledQuantity::safety:
            of.target = control_.safety.at(when);
            of.value = driven_lever(tail) * now.clamping[1] / std::abs(now.load_torque);
    }
    return of;
}

CylinderMotion PulleyInputs::cylinder_motion(const double* block, int shaft) const noexcept {
    const PulleyCoordinates& at = coordinates();
    const double side = -movable_side(shaft);
    return {side * at.opening(block, shaft), side * at.opening(block + at.size(), shaft), at.shaft_speed(block, shaft)};
}

std::array<double, 2> PulleyInputs::given_clamping(double now, const double* tail) const noexcept {
    const InputValues& held = torques_.held().values;
    if (hydraulics_.data().mode != HydraulicMode::pressure)
        return {held.at(Input::clamping_driving, clamping_.driving, now), held.at(Input::clamping_driven, clamping_.driven, now)};
    const Hydraulics& of = hydraulics_.data();
    const std::array<double, 2> pressure{held.at(Input::pressure_driving, of.driving.pressure, now),
                                         held.at(Input::pressure_driven, of.driven.pressure, now)};
    std::array<double, 2> force{};
    for (int shaft = 0; shaft < 2; ++shaft) {
        const auto k = static_cast<std::size_t>(shaft);
        force[k] = hydraulics_.area(shaft) * pressure[k] + hydraulics_.other_force(shaft, cylinder_motion(tail, shaft));
    }
    return force;
}

Inputs PulleyInputs::at(double t, const double* tail) const noexcept {
    Inputs in = requested(t, tail);
    if (hydraulics_act()) {
        const HydraulicInstant now = hydraulics_of(t, tail, in);
        in.clamping = now.force;
        hydraulics_.rates(now, in.control_rate.data() + controllers_);
    }
    if (drag_.present()) in.drag = drag(ramp(start_, t), in.clamping, tail);
    return in;
}

/// The wedge of the flanks holds the tension F = 2 S tan β/α along a wrap α (beyond what centrifugal force takes), and both strands pull
/// with 2 F sin(α/2): equally on both shafts, so the mean of what both forces say is the pull.
double PulleyInputs::strand_pull(const std::array<double, 2>& clamping, const double* block) const noexcept {
    const double rise =
        std::clamp((coordinates().running_radius(block, 0) - coordinates().running_radius(block, 1)) / centre_distance_, -1.0, 1.0);
    const double lean = 2.0 * portable_asin(rise);
    const double by_wrap = clamping[0] / (std::numbers::pi + lean) + clamping[1] / (std::numbers::pi - lean);
    return wedge_ * std::sqrt(1.0 - rise * rise) * by_wrap;
}

std::array<double, 2> PulleyInputs::drag(double factor, const std::array<double, 2>& clamping, const double* block) const noexcept {
    const double lever = 0.5 * drag_.bearing_friction * drag_.bearing_diameter;
    const double loaded = lever > 0.0 ? lever * strand_pull(clamping, block) : 0.0;
    std::array<double, 2> torque{};
    for (int shaft = 0; shaft < 2; ++shaft) {
        const ShaftDrag& of = shaft == 0 ? drag_.driving : drag_.driven;
        const double turning = coordinates().shaft_speed(block, shaft);
        const double dry = (of.seals + loaded) * std::clamp(turning / full_drag_speed, -1.0, 1.0);
        torque[static_cast<std::size_t>(shaft)] = factor * (dry + (of.viscous + of.churning * std::abs(turning)) * turning);
    }
    return torque;
}

HydraulicInstant PulleyInputs::hydraulics_of(double t, const double* tail, const Inputs& requested) const noexcept {
    const Hydraulics& of = hydraulics_.data();
    const double pump = of.pump_ratio * std::abs(coordinates().shaft_speed(tail, 0)) + of.pump_speed.at(std::max(t, 0.0));
    return hydraulics_.instant(oil(tail), {cylinder_motion(tail, 0), cylinder_motion(tail, 1)}, requested.clamping, pump);
}

HydraulicInstant PulleyInputs::hydraulics(double t, const double* tail) const noexcept {
    return hydraulics_act() ? hydraulics_of(t, tail, requested(t, tail)) : HydraulicInstant{};
}

HydraulicEnergy PulleyInputs::hydraulic_energy(const double* tail) const noexcept {
    if (!hydraulics_act()) return {};
    return hydraulics_.energy(oil(tail), {cylinder_motion(tail, 0), cylinder_motion(tail, 1)});
}

void PulleyInputs::fill_cylinders(double t, double* tail) const noexcept {
    if (!hydraulics_.present() || coordinates().size() == 0) return;
    const Inputs now = requested(t, tail);
    hydraulics_.fill({cylinder_motion(tail, 0), cylinder_motion(tail, 1)}, now.clamping, tail + 2 * coordinates().size() + controllers_);
}

Inputs PulleyInputs::requested(double t, const double* tail) const noexcept {
    const double now = std::max(t, 0.0);
    const double factor = ramp(start_, t);
    const double load = torques_.resisting_torque(t, tail);
    Inputs in;
    in.drive_torque = torques_.drive_torque(t, tail);
    in.load_torque = -factor * load;
    std::array<double, 2> clamping = given_clamping(now, tail);
    const double table = std::exchange(clamping[1], driven_clamping(clamping_, clamping[1], load, driven_lever(tail)));
    in.at_floor = clamping_.safety > 0.0 && clamping[1] == table && has_floor(clamping_, hydraulics_.data(), torques_.held(), now);
    for (int k = 0; k < controllers_; ++k) {
        const Governing& by = governing_[static_cast<std::size_t>(k)];
        if (const auto& held = torques_.held().sheave; held && by.quantity == ControlledQuantity::ratio) {
            const double found = holding_force(*held, t, coordinates(), tail) - clamping[0];
            if (by.integral > 0.0) in.control_rate[0] = (found / by.integral - tail[2 * coordinates().size()]) / following_time;
            clamping[0] += found;
            continue;
        }
        const auto limited = [&](double force) { return std::clamp(force, -by.authority, by.authority); };
        double& corrected = clamping[by.shaft];
        const double built_up = by.integral * tail[2 * coordinates().size() + k];
        const double error = control_error(by, now, load, std::max(0.0, corrected + limited(built_up)), tail);
        const double correction = by.proportional * error + built_up;
        const bool at_limit = std::abs(correction) > by.authority;
        in.control_limited = in.control_limited || at_limit;
        in.control_rate[static_cast<std::size_t>(k)] = at_limit && correction * error > 0.0 ? 0.0 : error;  // no winding up
        corrected = std::max(0.0, corrected + limited(correction));
    }
    in.clamping = {factor * clamping[0], factor * clamping[1]};
    return in;
}

void ShaftTorques::adopt(const Parameters& p) {
    coordinates_.adopt(p);
    drive_ = p.drive;
    load_ = p.load;
    held_ = {};
    const std::array<double, 2> added{drive_.inertia, load_.inertia}, corner{drive_.governor_frequency, load_.governor_frequency};
    for (std::size_t shaft = 0; shaft < 2; ++shaft) {
        const double polar = shaft_inertia(p.pulley, added[shaft]);
        const double frequency = 2.0 * std::numbers::pi * corner[shaft];
        governor_[shaft] = {polar * frequency * frequency, 2.0 * polar * frequency};
    }
    const auto as_spring = [](const Coupling& coupling) { return Spring{coupling.stiffness, coupling.damping}; };
    holder_[0] = drive_.mode == DriveMode::coupling ? as_spring(drive_.coupling) : governor_[0];
    holder_[1] = load_.mode == LoadMode::coupling ? as_spring(load_.coupling) : governor_[1];
}

double ShaftTorques::reference_angle(double t, int shaft) const noexcept {
    const ReferenceAngle& from = held_.reference[static_cast<std::size_t>(shaft)];
    if (const auto& held = held_speed(shaft)) return from.angle + *held * (t - from.since);
    const TimeTable& speed = speed_table(shaft);
    return from.angle + (speed.integral(t) - (from.since == 0.0 ? 0.0 : speed.integral(from.since)));
}

double ShaftTorques::reference_speed(double t, int shaft) const noexcept {
    const auto& held = held_speed(shaft);
    return held ? *held : speed_table(shaft).at(std::max(t, 0.0));
}

double ShaftTorques::holding_torque(const Spring& by, double t, const double* block, int shaft) const noexcept {
    const double angle = reference_angle(t, shaft) - block[coordinates_.rotation(shaft)];
    const double speed = reference_speed(t, shaft) - coordinates_.shaft_speed(block, shaft);
    return by.stiffness * angle + by.damping * speed;
}

double ShaftTorques::drive_torque(double t, const double* block) const noexcept {
    if (drive_.mode == DriveMode::torque) return held_.values.at(Input::drive_torque, drive_.torque, std::max(t, 0.0));
    return holding_torque(held_.coupled ? holder_[0] : governor_[0], t, block, 0);
}

double ShaftTorques::resisting_torque(double t, const double* block) const noexcept {
    if (load_.mode != LoadMode::torque && held_.coupled) return -holding_torque(holder_[1], t, block, 1);
    const double turning = coordinates_.shaft_speed(block, 1);
    return held_.values.at(Input::load_torque, load_.torque, std::max(t, 0.0)) + load_.linear * turning +
           load_.quadratic * turning * std::abs(turning);
}

void ShaftTorques::couple(double t, const double* block) noexcept {
    const std::array<double, 2> carried{drive_torque(t, block), -resisting_torque(t, block)};
    held_.coupled = true;
    const std::array<bool, 2> taken_over{drive_.mode == DriveMode::coupling, load_.mode != LoadMode::torque};
    for (int shaft = 0; shaft < 2; ++shaft) {
        const auto k = static_cast<std::size_t>(shaft);
        if (!taken_over[k]) continue;
        const double damped = holder_[k].damping * (reference_speed(t, shaft) - coordinates_.shaft_speed(block, shaft));
        const double angle = block[coordinates_.rotation(shaft)] + (carried[k] - damped) / holder_[k].stiffness;
        held_.reference[k] = {t, angle, angle};
    }
}

bool ShaftTorques::coupled(int shaft) const noexcept {
    return held_.coupled && (shaft == 0 ? drive_.mode == DriveMode::coupling : load_.mode == LoadMode::coupling);
}

CouplingState ShaftTorques::coupling(double t, const double* block, int shaft) const noexcept {
    if (!coupled(shaft)) return {};
    const Spring& by = holder_[static_cast<std::size_t>(shaft)];
    CouplingState now;
    now.twist = reference_angle(t, shaft) - block[coordinates_.rotation(shaft)];
    now.rate = reference_speed(t, shaft) - coordinates_.shaft_speed(block, shaft);
    now.energy = 0.5 * by.stiffness * now.twist * now.twist;
    now.damping = by.damping;
    return now;
}

void PulleyCoordinates::adopt(const Parameters& p) noexcept {
    size_ = layout_of(p).pulley_size;
    arc_position_ = p.pulley.arc_position;
    narrowing_ = 0.5 * portable_cos(p.tip.angle) / portable_sin(p.tip.angle);
}

}  // namespace cvtflow::model
