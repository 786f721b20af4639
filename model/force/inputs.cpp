/// What the outside does to shafts and sheaves: drive, load, clamping and control. (model/EQUATIONS.md section 8)

#include <algorithm>
#include <cmath>

#include "model/force/pulley.hpp"

namespace cvtflow::model {

double PulleyModel::reference_angle(double t) const noexcept {
    return held_.drive_speed ? held_.angle + *held_.drive_speed * (t - held_.since) : drive_.speed.integral(t);
}

double PulleyModel::reference_speed(double t) const noexcept {
    return held_.drive_speed ? *held_.drive_speed : drive_.speed.at(std::max(t, 0.0));
}

double PulleyModel::drive_torque(double t, const double* block) const noexcept {
    if (drive_.mode == DriveMode::torque) return held_.drive_torque ? *held_.drive_torque : drive_.torque.at(std::max(t, 0.0));
    const double angle = reference_angle(t) - block[rotation(0)];
    const double speed = reference_speed(t) - shaft_speed(block, 0);
    return governor_stiffness_ * angle + governor_damping_ * speed;
}

double PulleyModel::running_radius(const double* block, int shaft) const noexcept {
    return pulley_.arc_position - narrowing_ * movable_side(shaft) * opening(block, shaft);
}

/// What has to press the driven sheaves together, beside the table: no less than carries the load with the wanted safety.
double PulleyModel::driven_clamping(double table, double load, const double* block) const noexcept {
    if (clamping_.safety == 0.0) return table;
    return std::max(table, clamping_.safety * std::abs(load) / (gripping_ * running_radius(block, 1)));
}

void PulleyModel::add_controllers() {
    controllers_ = controllers(control_);
    const bool by_driving = control_.quantity == ControlledQuantity::ratio;
    governing_[0] = {control_.quantity, by_driving ? 0u : 1u, control_.proportional, control_.integral, control_.authority};
    const auto beside = control_.driven == DrivenControl::slip ? ControlledQuantity::slip : ControlledQuantity::safety;
    governing_[1] = {beside, 1, control_.driven_proportional, control_.driven_integral, control_.driven_authority};
}

double PulleyModel::control_error(const Governing& by, double now, double load, double built_up, const double* block) const noexcept {
    if (by.quantity == ControlledQuantity::safety) {  // of the force that carries the wanted multiple of the load: what is lacking
        const double wanted = control_.safety.at(now) * std::abs(load) / (gripping_ * running_radius(block, 1));
        const double larger = std::max(wanted, built_up);
        return larger > 0.0 ? (wanted - built_up) / larger : 0.0;
    }
    const double driving = shaft_speed(block, 0), driven = shaft_speed(block, 1);
    if (by.quantity == ControlledQuantity::ratio)
        return (driving - (held_.ratio ? *held_.ratio : control_.ratio.at(now)) * driven) / reference_speed_;
    const double geared = driving * running_radius(block, 0);
    return geared != 0.0 ? 1.0 - driven * running_radius(block, 1) / geared - control_.slip.at(now) : 0.0;
}

Inputs PulleyModel::inputs(double t, const double* tail) const noexcept {
    const double now = std::max(t, 0.0);
    const double factor = ramp(start_, t);
    const double turning = shaft_speed(tail, 1);
    const double load = (held_.load_torque ? *held_.load_torque : load_.torque.at(now)) + load_.linear * turning +
                        load_.quadratic * turning * std::abs(turning);
    Inputs in;
    in.drive_torque = drive_torque(t, tail);
    in.load_torque = -factor * load;
    std::array<double, 2> clamping{held_.driving ? *held_.driving : clamping_.driving.at(now),
                                   held_.driven ? *held_.driven : clamping_.driven.at(now)};
    clamping[1] = driven_clamping(clamping[1], load, tail);
    for (int k = 0; k < controllers_; ++k) {
        const Governing& by = governing_[static_cast<std::size_t>(k)];
        const auto limited = [&](double force) { return std::clamp(force, -by.authority, by.authority); };
        double& corrected = clamping[by.shaft];
        const double built_up = by.integral * tail[2 * size_ + k];
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

}  // namespace cvtflow::model
