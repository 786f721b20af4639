#include "model/force/shaft_torques.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cvtflow::model {

void ShaftTorques::adopt(const Parameters& p) {
    PulleyCoordinates::adopt(p);
    drive_ = p.drive;
    load_ = p.load;
    held_ = {};
    const std::array<double, 2> added{drive_.inertia, load_.inertia}, corner{drive_.governor_frequency, load_.governor_frequency};
    for (std::size_t shaft = 0; shaft < 2; ++shaft) {
        const double polar = p.pulley.shaft_polar_inertia + 2.0 * p.pulley.sheave_polar_inertia + added[shaft];
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
    const double angle = reference_angle(t, shaft) - block[rotation(shaft)];
    const double speed = reference_speed(t, shaft) - shaft_speed(block, shaft);
    return by.stiffness * angle + by.damping * speed;
}

double ShaftTorques::drive_torque(double t, const double* block) const noexcept {
    if (drive_.mode == DriveMode::torque) return held_.drive_torque ? *held_.drive_torque : drive_.torque.at(std::max(t, 0.0));
    return holding_torque(held_.coupled ? holder_[0] : governor_[0], t, block, 0);
}

double ShaftTorques::resisting_torque(double t, const double* block) const noexcept {
    if (load_.mode != LoadMode::torque && held_.coupled) return -holding_torque(holder_[1], t, block, 1);
    const double turning = shaft_speed(block, 1);
    return (held_.load_torque ? *held_.load_torque : load_.torque.at(std::max(t, 0.0))) + load_.linear * turning +
           load_.quadratic * turning * std::abs(turning);
}

void ShaftTorques::couple(double t, const double* block) noexcept {
    const std::array<double, 2> carried{drive_torque(t, block), -resisting_torque(t, block)};
    held_.coupled = true;
    const std::array<bool, 2> taken_over{drive_.mode == DriveMode::coupling, load_.mode != LoadMode::torque};
    for (int shaft = 0; shaft < 2; ++shaft) {
        const auto k = static_cast<std::size_t>(shaft);
        if (!taken_over[k]) continue;
        const double damped = holder_[k].damping * (reference_speed(t, shaft) - shaft_speed(block, shaft));
        const double angle = block[rotation(shaft)] + (carried[k] - damped) / holder_[k].stiffness;
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
    now.twist = reference_angle(t, shaft) - block[rotation(shaft)];
    now.rate = reference_speed(t, shaft) - shaft_speed(block, shaft);
    now.energy = 0.5 * by.stiffness * now.twist * now.twist;
    now.damping = by.damping;
    return now;
}

}  // namespace cvtflow::model
