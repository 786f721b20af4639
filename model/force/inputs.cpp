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

double PulleyModel::control_error(double now, const double* block) const noexcept {
    const double driving = shaft_speed(block, 0), driven = shaft_speed(block, 1);
    if (control_.quantity == ControlledQuantity::ratio)
        return (driving - (held_.ratio ? *held_.ratio : control_.ratio.at(now)) * driven) / reference_speed_;
    const double geared = driving * running_radius(block, 0);
    return geared != 0.0 ? 1.0 - driven * running_radius(block, 1) / geared - control_.slip.at(now) : 0.0;
}

Inputs PulleyModel::inputs(double t, const double* block, double control) const noexcept {
    const double now = std::max(t, 0.0);
    const double factor = ramp(start_, t);
    const double turning = shaft_speed(block, 1);
    const double load = (held_.load_torque ? *held_.load_torque : load_.torque.at(now)) + load_.linear * turning +
                        load_.quadratic * turning * std::abs(turning);
    Inputs in;
    in.drive_torque = drive_torque(t, block);
    in.load_torque = -factor * load;
    std::array<double, 2> clamping{held_.driving ? *held_.driving : clamping_.driving.at(now),
                                   held_.driven ? *held_.driven : clamping_.driven.at(now)};
    clamping[1] = driven_clamping(clamping[1], load, block);
    if (control_.enabled) {
        const double error = control_error(now, block);
        const double correction = control_.proportional * error + control_.integral * control;
        in.control_limited = std::abs(correction) > control_.authority;
        const bool winds_up = in.control_limited && correction * error > 0.0;
        in.control_rate = winds_up ? 0.0 : error;
        double& corrected = clamping[control_.quantity == ControlledQuantity::ratio ? 0 : 1];
        corrected = std::max(0.0, corrected + std::clamp(correction, -control_.authority, control_.authority));
    }
    in.clamping = {factor * clamping[0], factor * clamping[1]};
    return in;
}

}  // namespace cvtflow::model
