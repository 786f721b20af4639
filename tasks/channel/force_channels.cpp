/// Channels that a record has on demand (record.channels): forces, loads of tips that wear comes from, temperatures. Their formulas:
/// model/EQUATIONS.md sections 9 and 12.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "model/law/friction.hpp"
#include "tasks/channel/channels.hpp"

namespace cvtflow::tasks {

namespace {

using model::ChainForces;
using F = ChainForces;

int of_links(const model::ChainModel& chain) { return chain.layout().links; }
int of_halves(const model::ChainModel& chain) { return 2 * chain.layout().links; }
int of_tips(const model::ChainModel& chain) { return model::tips_per_link * chain.layout().links; }
int of_plates(const model::ChainModel& chain) { return model::plates_per_link(chain) * chain.layout().links; }
int of_a_link(const model::ChainModel& chain) { return model::plates_per_link(chain); }

using Forces = std::vector<double> ChainForces::*;

void forces(const Instant& now, double* out, Forces member) { std::ranges::copy(now.observer.forces().chain.*member, out); }
void bearing_force(const Instant& now, double* out, std::size_t shaft) {
    std::ranges::copy(now.observer.forces().bearing[shaft].force, out);
}
void bearing_moment(const Instant& now, double* out, std::size_t shaft) {
    std::ranges::copy(now.observer.forces().bearing[shaft].moment, out);
}
double misalignment(const Instant& now) { return now.observer.forces().misalignment; }

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

/// Half the sum of what spreads the two sheaves of a shaft.
[[nodiscard]] double spreading(const Instant& now, std::size_t shaft) {
    const auto& axial = now.observation.axial_force;
    return 0.5 * (axial[2 * shaft + 1] - axial[2 * shaft]);
}

double contact_thrust_ratio(const Instant& now) {
    const double driven = spreading(now, 1);
    return driven != 0.0 ? spreading(now, 0) / driven : undefined;
}

constexpr double largest_safety = 1e3;  ///< without torque it is infinite; records hold numbers

double safety_factor(const Instant& now, std::size_t shaft) {
    const model::TipCoefficients& tip = now.workspace.variator.chain().coefficients().tip;
    const model::Observation& o = now.observation;
    const double torque = std::abs(now.chain_torque(shaft));
    const double bearable = 2.0 * tip.friction.coefficient * o.clamping[shaft] * o.radius[shaft] / tip.cosine;
    return bearable < largest_safety * torque ? bearable / torque : largest_safety;
}

/// Slip of the slower part against the faster one on its pulley, in the flow of power from shaft 1 to shaft 2.
double slip_of_driving(const Instant& now) {
    const double shaft = now.observation.speed[0];
    return shaft != 0.0 ? 1.0 - now.observation.pin_speed[0] / shaft : undefined;
}
double slip_of_driven(const Instant& now) {
    const double pins = now.observation.pin_speed[1];
    return pins != 0.0 ? 1.0 - now.observation.speed[1] / pins : undefined;
}

double total_loss(const Instant& now) {
    const auto& loss = now.observation.account.loss;
    return std::accumulate(loss.begin(), loss.end(), 0.0);
}

void followed_plates(const Instant& now, double* out) {
    const ChainForces& all = now.observer.forces().chain;
    std::copy_n(all.plate_tension.begin() + all.plates_per_link * now.followed_pin, all.plates_per_link, out);
}

/// A pin's halves: the rear one of its own link, the front one of the link before.
void followed_halves(const Instant& now, double* out, Forces member) {
    const auto& all = now.observer.forces().chain.*member;
    const int before = now.workspace.layout().previous(now.followed_pin);
    out[0] = all[static_cast<std::size_t>(2 * now.followed_pin)];
    out[1] = all[static_cast<std::size_t>(2 * before + 1)];
}

using enum Channel::Trait;
using Read = Channel::Read;
const Channel table_of_forces[] = {
    {"tips/normal_force", "N", "normal force of every tip's contact; tip = 4 link + 2 (front half) + (side +z)",
     Read(forces, &F::tip_normal), on_demand, "tip", of_tips},
    {"tips/tangential_force", "N", "circumferential force of every tip on its sheave, positive as the shaft's rotation is",
     Read(forces, &F::tip_tangential), on_demand, "tip", of_tips},
    {"tips/radial_force", "N", "radial force of every tip on its sheave, positive outwards", Read(forces, &F::tip_radial), on_demand, "tip",
     of_tips},
    {"plates/tension", "N", "tension of every plate as it is resolved, damping included; plate = (plates per link) link + number",
     Read(forces, &F::plate_tension), any_machine | on_demand, "plate", of_plates},
    {"joints/normal_force", "N", "force that presses the halves of every pin together; joint of the pin behind the link",
     Read(forces, &F::joint_normal), any_machine | on_demand, "pin", of_links},
    {"joints/friction_force", "N", "friction of the rocker joint along its profile, on the front half of the link before",
     Read(forces, &F::joint_friction), any_machine | on_demand, "pin", of_links},
    {"joints/axial_friction", "N", "friction of the rocker joint along the pin, on the front half of the link before",
     Read(forces, &F::joint_axial), any_machine | on_demand, "pin", of_links},
    {"halves/bending_moment_travel", "N*m",
     "bending moment in the middle of every half, in the direction of travel; half = 2 link + (front)", Read(forces, &F::bending_travel),
     any_machine | on_demand, "half", of_halves},
    {"halves/bending_moment_height", "N*m", "bending moment in the middle of every half, along its height",
     Read(forces, &F::bending_height), any_machine | on_demand, "half", of_halves},
    {"halves/axial_force", "N", "axial force of every half, tension positive", Read(forces, &F::half_axial), any_machine | on_demand,
     "half", of_halves},
    {"followed_pin/plate_tension", "N", "tension of every plate of the link behind the followed pin, damping included", followed_plates,
     any_machine | on_demand, "plate", of_a_link},
    {"followed_pin/bending_moment_travel", "N*m", "bending moment of the followed pin's rear and front half in the direction of travel",
     Read(followed_halves, &F::bending_travel), any_machine | on_demand, "half", Channel::always(2)},
    {"followed_pin/bending_moment_height", "N*m", "bending moment of the followed pin's rear and front half along their height",
     Read(followed_halves, &F::bending_height), any_machine | on_demand, "half", Channel::always(2)},
    {"followed_pin/half_axial_force", "N", "axial force of the followed pin's rear and front half, tension positive",
     Read(followed_halves, &F::half_axial), any_machine | on_demand, "half", Channel::always(2)},
    {"shaft_1/bearing_force", "N", "force of the driving shaft on its bearings: x, y, axial", Read(bearing_force, 0), on_demand, "axis",
     Channel::always(3)},
    {"shaft_2/bearing_force", "N", "force of the driven shaft on its bearings: x, y, axial", Read(bearing_force, 1), on_demand, "axis",
     Channel::always(3)},
    {"shaft_1/bearing_moment", "N*m", "tilting moment of the driving shaft on its bearings about x, y", Read(bearing_moment, 0), on_demand,
     "axis", Channel::always(2)},
    {"shaft_2/bearing_moment", "N*m", "tilting moment of the driven shaft on its bearings about x, y", Read(bearing_moment, 1), on_demand,
     "axis", Channel::always(2)},
    {"shaft_1/slip", "1", "slip on the driving pulley: 1 - pins/shaft, angular speeds", slip_of_driving, on_demand | may_be_undefined},
    {"shaft_2/slip", "1", "slip on the driven pulley: 1 - shaft/pins, angular speeds", slip_of_driven, on_demand | may_be_undefined},
    {"shaft_1/safety_factor", "1", "2 mu S_1 r_1/cos(beta) over the chain's torque on the driving sheaves, at most 1000",
     Read(safety_factor, 0), on_demand},
    {"shaft_2/safety_factor", "1", "2 mu S_2 r_2/cos(beta) over the chain's torque on the driven sheaves, at most 1000",
     Read(safety_factor, 1), on_demand},
    {"contact_thrust_ratio", "1", "mean axial force of the tips on the driving sheaves over that on the driven ones", contact_thrust_ratio,
     on_demand | may_be_undefined},
    {"misalignment", "m", "axial distance of the middles of the two grooves: driving minus driven", misalignment, on_demand},
    {"loss/total", "W", "total power dissipated", total_loss, any_machine | on_demand},
};

/// Hertz' largest pressure of a tip: p_c (N/K)^(1/3) [Pa].
[[nodiscard]] double pressure_of(const model::Parameters& p, double normal) {
    return model::pressure_per_root_depth(p) * std::cbrt(normal / p.tip.hertz);
}

/// Calls each(tip, cell, normal force, sliding speed) for every tip that presses.
template <class Each>
void for_cells(const Instant& now, const Each& each) {
    const ChainForces& f = now.observer.forces().chain;
    const model::Parameters& p = now.workspace.parameters;
    const model::ChainModel& chain = now.workspace.variator.chain();
    const double per_radius = wear_cells / (p.pulley.outermost - p.pulley.innermost);
    for (std::size_t tip = 0; tip < f.tip_normal.size(); ++tip) {
        if (f.tip_normal[tip] <= 0.0) continue;
        const int link = static_cast<int>(tip) / model::tips_per_link;
        const int shaft = chain.shaft_of(now.workspace.state() + chain.layout().link_begin(link));
        const int place = std::clamp(static_cast<int>((f.tip_radius[tip] - p.pulley.innermost) * per_radius), 0, wear_cells - 1);
        const int sheave = 2 * shaft + static_cast<int>(tip % 2);
        each(tip, static_cast<std::size_t>(wear_cells * sheave + place), f.tip_normal[tip], f.tip_sliding[tip]);
    }
}

void cell_power(const Instant& now, double* out) {
    std::fill_n(out, 4 * wear_cells, 0.0);
    const auto& power = now.observer.forces().chain.tip_power;
    for_cells(now, [&](std::size_t tip, std::size_t cell, double, double) { out[cell] += power[tip]; });
}

void cell_force_speed(const Instant& now, double* out) {
    std::fill_n(out, 4 * wear_cells, 0.0);
    for_cells(now, [&](std::size_t, std::size_t cell, double normal, double speed) { out[cell] += normal * speed; });
}

void cell_pressure_speed(const Instant& now, double* out) {
    std::fill_n(out, 4 * wear_cells, 0.0);
    for_cells(now, [&](std::size_t, std::size_t cell, double normal, double speed) {
        out[cell] = std::max(out[cell], pressure_of(now.workspace.parameters, normal) * speed);
    });
}

void tip_pressure(const Instant& now, double* out) {
    const auto& normal = now.observer.forces().chain.tip_normal;
    std::transform(normal.begin(), normal.end(), out, [&](double n) { return pressure_of(now.workspace.parameters, n); });
}

void tip_force_speed(const Instant& now, double* out) {
    const ChainForces& f = now.observer.forces().chain;
    std::transform(f.tip_normal.begin(), f.tip_normal.end(), f.tip_sliding.begin(), out, std::multiplies<>());
}

double guide(const Instant& now, double model::GuideLoad::*member, std::size_t strand) { return now.observation.guide[strand].*member; }

double limit_use(const Instant& now) { return now.observation.limit_use; }

using Temperature = double (model::HeatBalance::*)() const noexcept;
double heat(const Instant& now, Temperature member) { return (now.workspace.heat.*member)(); }

const Channel table_of_wear[] = {
    {"wear/friction_power", "W",
     "friction of the tips by radius: 32 rings from pulley.innermost to pulley.outermost of sheaves 1-, 1+, 2-, 2+", cell_power, on_demand,
     "ring", Channel::always(4 * wear_cells)},
    {"wear/force_speed", "N*m/s",
     "sum of normal force times sliding speed of the tips by radius, rings as above: Archard's wear per coefficient", cell_force_speed,
     on_demand, "ring", Channel::always(4 * wear_cells)},
    {"wear/pressure_speed", "Pa*m/s", "largest Hertz pressure times sliding speed of a tip by radius, rings as above", cell_pressure_speed,
     on_demand, "ring", Channel::always(4 * wear_cells)},
    {"wear/tip_power", "W", "friction of every tip; tip = 4 link + 2 (front half) + (side +z)", Read(forces, &F::tip_power), on_demand,
     "tip", of_tips},
    {"wear/tip_force_speed", "N*m/s", "normal force times sliding speed of every tip", tip_force_speed, on_demand, "tip", of_tips},
    {"wear/tip_pressure", "Pa", "largest Hertz pressure of every tip", tip_pressure, on_demand, "tip", of_tips},
    {"wear/tip_sliding", "m/s", "sliding speed of every tip on its sheave", Read(forces, &F::tip_sliding), on_demand, "tip", of_tips},
    {"clamping_limit_use", "1", "clamping force over wear.clamping_limit at the slip speed, of the pulley where it is larger; 0: no limit",
     limit_use, on_demand},
    {"guide/tight_force", "N", "sum of the normal forces of the rails at the strand that the driving sheaves pull",
     Read(guide, &model::GuideLoad::force, 0), of_guide},
    {"guide/slack_force", "N", "sum of the normal forces of the rails at the other strand", Read(guide, &model::GuideLoad::force, 1),
     of_guide},
    {"guide/tight_deflection", "m",
     "distance of the strand that the driving sheaves pull from the middle between its rails, outwards, of the pin that is farthest",
     Read(guide, &model::GuideLoad::deflection, 0), of_guide},
    {"guide/slack_deflection", "m", "likewise of the other strand", Read(guide, &model::GuideLoad::deflection, 1), of_guide},
    {"temperature/pulleys", "K", "of pulleys and chain (heat.enabled)", Read(heat, &model::HeatBalance::pulleys),
     any_machine | on_demand | without_chain},
    {"temperature/oil", "K", "of the oil around pulleys and chain (heat.enabled)", Read(heat, &model::HeatBalance::oil),
     any_machine | on_demand | without_chain},
};

}  // namespace

std::span<const Channel> force_channels() { return table_of_forces; }
std::span<const Channel> wear_channels() { return table_of_wear; }

}  // namespace cvtflow::tasks
