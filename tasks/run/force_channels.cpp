/// Channels that a record has on demand (record.channels). Their formulas: model/EQUATIONS.md section 9.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tasks/run/channels.hpp"

namespace cvtflow::tasks {

namespace {

using model::ChainForces;

int a_number(const model::ChainModel&) { return 1; }
int of_links(const model::ChainModel& chain) { return chain.layout().links; }
int of_halves(const model::ChainModel& chain) { return 2 * chain.layout().links; }
int of_tips(const model::ChainModel& chain) { return model::tips_per_link * chain.layout().links; }
int of_plates(const model::ChainModel& chain) { return model::plates_per_link(chain) * chain.layout().links; }
int of_a_link(const model::ChainModel& chain) { return model::plates_per_link(chain); }
template <int N>
int numbers(const model::ChainModel&) {
    return N;
}

template <auto Member>
void forces(const Instant& now, double* out) {
    const auto& values = now.observer.forces().chain.*Member;
    std::copy(values.begin(), values.end(), out);
}

template <std::size_t Shaft>
void bearing_force(const Instant& now, double* out) {
    const auto& force = now.observer.forces().bearing[Shaft].force;
    std::copy(force.begin(), force.end(), out);
}
template <std::size_t Shaft>
void bearing_moment(const Instant& now, double* out) {
    const auto& moment = now.observer.forces().bearing[Shaft].moment;
    std::copy(moment.begin(), moment.end(), out);
}

void misalignment(const Instant& now, double* out) { *out = now.observer.forces().misalignment; }

/// Half the sum of what spreads the two sheaves of a shaft.
[[nodiscard]] double spreading(const Instant& now, std::size_t shaft) {
    const auto& axial = now.observation.axial_force;
    return 0.5 * (axial[2 * shaft + 1] - axial[2 * shaft]);
}

void contact_thrust_ratio(const Instant& now, double* out) {
    const double driven = spreading(now, 1);
    *out = driven != 0.0 ? spreading(now, 0) / driven : 0.0;
}

constexpr double largest_safety = 1e3;  ///< without torque it is infinite; records hold numbers

template <std::size_t Shaft>
void safety_factor(const Instant& now, double* out) {
    const model::TipCoefficients& tip = now.workspace.variator.chain().coefficients().tip;
    const double mean = now.workspace.energy.chain_torque()[Shaft];
    const double torque = std::abs(std::isfinite(mean) ? mean : now.observation.chain_torque[Shaft]);
    const double bearable = 2.0 * tip.friction.coefficient * now.observation.clamping[Shaft] * now.observation.radius[Shaft] / tip.cosine;
    *out = bearable < largest_safety * torque ? bearable / torque : largest_safety;
}

/// Of the slower part against the faster one on its pulley, in the flow of power from shaft 1 to shaft 2.
void slip_of_driving(const Instant& now, double* out) {
    const double shaft = now.observation.speed[0];
    *out = shaft != 0.0 ? 1.0 - now.observation.pin_speed[0] / shaft : 0.0;
}
void slip_of_driven(const Instant& now, double* out) {
    const double pins = now.observation.pin_speed[1];
    *out = pins != 0.0 ? 1.0 - now.observation.speed[1] / pins : 0.0;
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
template <auto Member>
void followed_halves(const Instant& now, double* out) {
    const auto& all = now.observer.forces().chain.*Member;
    const int before = now.workspace.layout().previous(now.followed_pin);
    out[0] = all[static_cast<std::size_t>(2 * now.followed_pin)];
    out[1] = all[static_cast<std::size_t>(2 * before + 1)];
}

using F = ChainForces;
constexpr Channel table_of_forces[] = {
    {"tips/normal_force", "N", "normal force of every tip's contact; tip = 4 link + 2 (front half) + (side +z)", "tip", of_tips,
     forces<&F::tip_normal>, true, false},
    {"tips/tangential_force", "N", "circumferential force of every tip on its sheave, positive as the shaft's rotation is", "tip", of_tips,
     forces<&F::tip_tangential>, true, false},
    {"tips/radial_force", "N", "radial force of every tip on its sheave, positive outwards", "tip", of_tips, forces<&F::tip_radial>, true,
     false},
    {"plates/tension", "N", "tension of every plate as it is resolved, damping included; plate = (plates per link) link + number", "plate",
     of_plates, forces<&F::plate_tension>, false, false},
    {"joints/normal_force", "N", "force that presses the halves of every pin together; joint of the pin behind the link", "pin", of_links,
     forces<&F::joint_normal>, false, false},
    {"joints/friction_force", "N", "friction of the rocker joint along its profile, on the front half of the link before", "pin", of_links,
     forces<&F::joint_friction>, false, false},
    {"joints/axial_friction", "N", "friction of the rocker joint along the pin, on the front half of the link before", "pin", of_links,
     forces<&F::joint_axial>, false, false},
    {"halves/bending_moment_travel", "N*m",
     "bending moment in the middle of every half, in the direction of travel; half = 2 link + (front)", "half", of_halves,
     forces<&F::bending_travel>, false, false},
    {"halves/bending_moment_height", "N*m", "bending moment in the middle of every half, along its height", "half", of_halves,
     forces<&F::bending_height>, false, false},
    {"halves/axial_force", "N", "axial force of every half, tension positive", "half", of_halves, forces<&F::half_axial>, false, false},
    {"followed_pin/plate_tension", "N", "tension of every plate of the link behind the followed pin, damping included", "plate", of_a_link,
     followed_plates, false, false},
    {"followed_pin/bending_moment_travel", "N*m", "bending moment of the followed pin's rear and front half in the direction of travel",
     "half", numbers<2>, followed_halves<&F::bending_travel>, false, false},
    {"followed_pin/bending_moment_height", "N*m", "bending moment of the followed pin's rear and front half along their height", "half",
     numbers<2>, followed_halves<&F::bending_height>, false, false},
    {"followed_pin/half_axial_force", "N", "axial force of the followed pin's rear and front half, tension positive", "half", numbers<2>,
     followed_halves<&F::half_axial>, false, false},
    {"shaft_1/bearing_force", "N", "force of the driving shaft on its bearings: x, y, axial", "axis", numbers<3>, bearing_force<0>, true,
     false},
    {"shaft_2/bearing_force", "N", "force of the driven shaft on its bearings: x, y, axial", "axis", numbers<3>, bearing_force<1>, true,
     false},
    {"shaft_1/bearing_moment", "N*m", "tilting moment of the driving shaft on its bearings about x, y", "axis", numbers<2>,
     bearing_moment<0>, true, false},
    {"shaft_2/bearing_moment", "N*m", "tilting moment of the driven shaft on its bearings about x, y", "axis", numbers<2>,
     bearing_moment<1>, true, false},
    {"shaft_1/slip", "1", "slip on the driving pulley: 1 - pins/shaft, angular speeds", "", a_number, slip_of_driving, true, false},
    {"shaft_2/slip", "1", "slip on the driven pulley: 1 - shaft/pins, angular speeds", "", a_number, slip_of_driven, true, false},
    {"shaft_1/safety_factor", "1", "2 mu S_1 r_1/cos(beta) over the chain's torque on the driving sheaves, at most 1000", "", a_number,
     safety_factor<0>, true, false},
    {"shaft_2/safety_factor", "1", "2 mu S_2 r_2/cos(beta) over the chain's torque on the driven sheaves, at most 1000", "", a_number,
     safety_factor<1>, true, false},
    {"contact_thrust_ratio", "1", "mean axial force of the tips on the driving sheaves over that on the driven ones", "", a_number,
     contact_thrust_ratio, true, false},
    {"misalignment", "m", "axial distance of the middles of the two grooves: driving minus driven", "", a_number, misalignment, true,
     false},
    {"loss/total", "W", "power dissipated in all", "", a_number, total_loss, false, false},
};

}  // namespace

std::span<const Channel> force_channels() { return table_of_forces; }

}  // namespace cvtflow::tasks
