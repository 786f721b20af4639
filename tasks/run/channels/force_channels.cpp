/// Channels that a record has on demand (record.channels). Their formulas: model/EQUATIONS.md section 9.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "tasks/run/channels/channels.hpp"

namespace cvtflow::tasks {

namespace {

using model::ChainForces;

int of_links(const model::ChainModel& chain) { return chain.layout().links; }
int of_halves(const model::ChainModel& chain) { return 2 * chain.layout().links; }
int of_tips(const model::ChainModel& chain) { return model::tips_per_link * chain.layout().links; }
int of_plates(const model::ChainModel& chain) { return model::plates_per_link(chain) * chain.layout().links; }
int of_a_link(const model::ChainModel& chain) { return model::plates_per_link(chain); }

using Forces = std::vector<double> ChainForces::*;

Channel::Read forces(Forces member) {
    return [member](const Instant& now, double* out) {
        const auto& values = now.observer.forces().chain.*member;
        std::copy(values.begin(), values.end(), out);
    };
}

Channel::Read bearing_force(std::size_t shaft) {
    return [shaft](const Instant& now, double* out) {
        const auto& force = now.observer.forces().bearing[shaft].force;
        std::copy(force.begin(), force.end(), out);
    };
}
Channel::Read bearing_moment(std::size_t shaft) {
    return [shaft](const Instant& now, double* out) {
        const auto& moment = now.observer.forces().bearing[shaft].moment;
        std::copy(moment.begin(), moment.end(), out);
    };
}

void misalignment(const Instant& now, double* out) { *out = now.observer.forces().misalignment; }

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

/// Half the sum of what spreads the two sheaves of a shaft.
[[nodiscard]] double spreading(const Instant& now, std::size_t shaft) {
    const auto& axial = now.observation.axial_force;
    return 0.5 * (axial[2 * shaft + 1] - axial[2 * shaft]);
}

void contact_thrust_ratio(const Instant& now, double* out) {
    const double driven = spreading(now, 1);
    *out = driven != 0.0 ? spreading(now, 0) / driven : undefined;
}

constexpr double largest_safety = 1e3;  ///< without torque it is infinite; records hold numbers

Channel::Read safety_factor(std::size_t shaft) {
    return [shaft](const Instant& now, double* out) {
        const model::TipCoefficients& tip = now.workspace.variator.chain().coefficients().tip;
        const model::Observation& o = now.observation;
        const double torque = std::abs(now.chain_torque(shaft));
        const double bearable = 2.0 * tip.friction.coefficient * o.clamping[shaft] * o.radius[shaft] / tip.cosine;
        *out = bearable < largest_safety * torque ? bearable / torque : largest_safety;
    };
}

/// Of the slower part against the faster one on its pulley, in the flow of power from shaft 1 to shaft 2.
void slip_of_driving(const Instant& now, double* out) {
    const double shaft = now.observation.speed[0];
    *out = shaft != 0.0 ? 1.0 - now.observation.pin_speed[0] / shaft : undefined;
}
void slip_of_driven(const Instant& now, double* out) {
    const double pins = now.observation.pin_speed[1];
    *out = pins != 0.0 ? 1.0 - now.observation.speed[1] / pins : undefined;
}

void total_loss(const Instant& now, double* out) {
    const auto& loss = now.observation.account.loss;
    *out = std::accumulate(loss.begin(), loss.end(), 0.0);
}

void followed_plates(const Instant& now, double* out) {
    const ChainForces& all = now.observer.forces().chain;
    std::copy_n(all.plate_tension.begin() + all.plates_per_link * now.followed_pin, all.plates_per_link, out);
}

/// A pin's halves: the rear one of its own link, the front one of the link before.
Channel::Read followed_halves(Forces member) {
    return [member](const Instant& now, double* out) {
        const auto& all = now.observer.forces().chain.*member;
        const int before = now.workspace.layout().previous(now.followed_pin);
        out[0] = all[static_cast<std::size_t>(2 * now.followed_pin)];
        out[1] = all[static_cast<std::size_t>(2 * before + 1)];
    };
}

using F = ChainForces;
const Channel table_of_forces[] = {
    {.name = "tips/normal_force",
     .unit = "N",
     .description = "normal force of every tip's contact; tip = 4 link + 2 (front half) + (side +z)",
     .axis = "tip",
     .width = of_tips,
     .read = forces(&F::tip_normal),
     .usual = false},
    {.name = "tips/tangential_force",
     .unit = "N",
     .description = "circumferential force of every tip on its sheave, positive as the shaft's rotation is",
     .axis = "tip",
     .width = of_tips,
     .read = forces(&F::tip_tangential),
     .usual = false},
    {.name = "tips/radial_force",
     .unit = "N",
     .description = "radial force of every tip on its sheave, positive outwards",
     .axis = "tip",
     .width = of_tips,
     .read = forces(&F::tip_radial),
     .usual = false},
    {.name = "plates/tension",
     .unit = "N",
     .description = "tension of every plate as it is resolved, damping included; plate = (plates per link) link + number",
     .axis = "plate",
     .width = of_plates,
     .read = forces(&F::plate_tension),
     .needs_pulleys = false,
     .usual = false},
    {.name = "joints/normal_force",
     .unit = "N",
     .description = "force that presses the halves of every pin together; joint of the pin behind the link",
     .axis = "pin",
     .width = of_links,
     .read = forces(&F::joint_normal),
     .needs_pulleys = false,
     .usual = false},
    {.name = "joints/friction_force",
     .unit = "N",
     .description = "friction of the rocker joint along its profile, on the front half of the link before",
     .axis = "pin",
     .width = of_links,
     .read = forces(&F::joint_friction),
     .needs_pulleys = false,
     .usual = false},
    {.name = "joints/axial_friction",
     .unit = "N",
     .description = "friction of the rocker joint along the pin, on the front half of the link before",
     .axis = "pin",
     .width = of_links,
     .read = forces(&F::joint_axial),
     .needs_pulleys = false,
     .usual = false},
    {.name = "halves/bending_moment_travel",
     .unit = "N*m",
     .description = "bending moment in the middle of every half, in the direction of travel; half = 2 link + (front)",
     .axis = "half",
     .width = of_halves,
     .read = forces(&F::bending_travel),
     .needs_pulleys = false,
     .usual = false},
    {.name = "halves/bending_moment_height",
     .unit = "N*m",
     .description = "bending moment in the middle of every half, along its height",
     .axis = "half",
     .width = of_halves,
     .read = forces(&F::bending_height),
     .needs_pulleys = false,
     .usual = false},
    {.name = "halves/axial_force",
     .unit = "N",
     .description = "axial force of every half, tension positive",
     .axis = "half",
     .width = of_halves,
     .read = forces(&F::half_axial),
     .needs_pulleys = false,
     .usual = false},
    {.name = "followed_pin/plate_tension",
     .unit = "N",
     .description = "tension of every plate of the link behind the followed pin, damping included",
     .axis = "plate",
     .width = of_a_link,
     .read = followed_plates,
     .needs_pulleys = false,
     .usual = false},
    {.name = "followed_pin/bending_moment_travel",
     .unit = "N*m",
     .description = "bending moment of the followed pin's rear and front half in the direction of travel",
     .axis = "half",
     .width = Channel::always(2),
     .read = followed_halves(&F::bending_travel),
     .needs_pulleys = false,
     .usual = false},
    {.name = "followed_pin/bending_moment_height",
     .unit = "N*m",
     .description = "bending moment of the followed pin's rear and front half along their height",
     .axis = "half",
     .width = Channel::always(2),
     .read = followed_halves(&F::bending_height),
     .needs_pulleys = false,
     .usual = false},
    {.name = "followed_pin/half_axial_force",
     .unit = "N",
     .description = "axial force of the followed pin's rear and front half, tension positive",
     .axis = "half",
     .width = Channel::always(2),
     .read = followed_halves(&F::half_axial),
     .needs_pulleys = false,
     .usual = false},
    {.name = "shaft_1/bearing_force",
     .unit = "N",
     .description = "force of the driving shaft on its bearings: x, y, axial",
     .axis = "axis",
     .width = Channel::always(3),
     .read = bearing_force(0),
     .usual = false},
    {.name = "shaft_2/bearing_force",
     .unit = "N",
     .description = "force of the driven shaft on its bearings: x, y, axial",
     .axis = "axis",
     .width = Channel::always(3),
     .read = bearing_force(1),
     .usual = false},
    {.name = "shaft_1/bearing_moment",
     .unit = "N*m",
     .description = "tilting moment of the driving shaft on its bearings about x, y",
     .axis = "axis",
     .width = Channel::always(2),
     .read = bearing_moment(0),
     .usual = false},
    {.name = "shaft_2/bearing_moment",
     .unit = "N*m",
     .description = "tilting moment of the driven shaft on its bearings about x, y",
     .axis = "axis",
     .width = Channel::always(2),
     .read = bearing_moment(1),
     .usual = false},
    {.name = "shaft_1/slip",
     .unit = "1",
     .description = "slip on the driving pulley: 1 - pins/shaft, angular speeds",
     .read = slip_of_driving,
     .usual = false,
     .may_be_undefined = true},
    {.name = "shaft_2/slip",
     .unit = "1",
     .description = "slip on the driven pulley: 1 - shaft/pins, angular speeds",
     .read = slip_of_driven,
     .usual = false,
     .may_be_undefined = true},
    {.name = "shaft_1/safety_factor",
     .unit = "1",
     .description = "2 mu S_1 r_1/cos(beta) over the chain's torque on the driving sheaves, at most 1000",
     .read = safety_factor(0),
     .usual = false},
    {.name = "shaft_2/safety_factor",
     .unit = "1",
     .description = "2 mu S_2 r_2/cos(beta) over the chain's torque on the driven sheaves, at most 1000",
     .read = safety_factor(1),
     .usual = false},
    {.name = "contact_thrust_ratio",
     .unit = "1",
     .description = "mean axial force of the tips on the driving sheaves over that on the driven ones",
     .read = contact_thrust_ratio,
     .usual = false,
     .may_be_undefined = true},
    {.name = "misalignment",
     .unit = "m",
     .description = "axial distance of the middles of the two grooves: driving minus driven",
     .read = misalignment,
     .usual = false},
    {.name = "loss/total",
     .unit = "W",
     .description = "total power dissipated",
     .read = total_loss,
     .needs_pulleys = false,
     .usual = false},
};

}  // namespace

std::span<const Channel> force_channels() { return table_of_forces; }

}  // namespace cvtflow::tasks
