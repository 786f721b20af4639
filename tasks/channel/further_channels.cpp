/// Channels that most records have on demand (record.channels): forces; what drives the variator from outside, which is couplings, the
/// impulse that a co-simulation exchanges, drag of the shafts, the vehicle of a cycle and hydraulics; loads of tips that wear comes from;
/// temperatures. Their formulas: model/EQUATIONS.md sections 8, 9 and 12.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "model/law/friction.hpp"
#include "tasks/channel/channels.hpp"

namespace cvtflow::tasks {

namespace {

using model::ChainForces;
using model::HydraulicEnergy;
using model::HydraulicInstant;
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

/// Sum over both halves of a pin, which every level of detail has.
double largest_pin_end(const Instant& now) {
    const auto& tips = now.observation.tip_axial;
    const model::ChainLayout& at = now.workspace.layout();
    double largest = 0.0;
    for (int tip = 0; tip < 2 * at.links; ++tip) {
        const int pin = tip / 2, side = tip % 2, before = model::tips_per_link * at.previous(pin) + 2 + side;
        largest = std::max(
            largest, std::abs(tips[static_cast<std::size_t>(model::tips_per_link * pin + side)] + tips[static_cast<std::size_t>(before)]));
    }
    return largest;
}

/// Half the sum of what spreads the two sheaves of a shaft.
[[nodiscard]] double spreading(const Instant& now, std::size_t shaft) {
    const auto& axial = now.observation.axial_force;
    return 0.5 * (axial[2 * shaft + 1] - axial[2 * shaft]);
}

double contact_thrust_ratio(const Instant& now) {
    const double driven = spreading(now, 1);
    return driven != 0.0 ? spreading(now, 0) / driven : undefined;
}

constexpr double largest_safety = 1e3;  ///< maximum of a record, which contains no infinity: the factor without torque

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

/// A pin's halves: the rear one of its link, the front one of the link before.
void followed_halves(const Instant& now, double* out, Forces member) {
    const auto& all = now.observer.forces().chain.*member;
    const int before = now.workspace.layout().previous(now.followed_pin);
    out[0] = all[static_cast<std::size_t>(2 * now.followed_pin)];
    out[1] = all[static_cast<std::size_t>(2 * before + 1)];
}

/// Rings of a sheave, of equal width from pulley.innermost to pulley.outermost, over which wear is counted.
constexpr int wear_cells = 32;

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

[[nodiscard]] model::CouplingState coupling(const Instant& now, int shaft) {
    return now.workspace.variator.pulleys().torques().coupling(now.observation.time, now.workspace.tail(), shaft);
}

double twist(const Instant& now, int shaft) { return coupling(now, shaft).twist; }
double stored(const Instant& now, int shaft) { return coupling(now, shaft).energy; }
double far_work(const Instant& now, std::size_t shaft) { return now.workspace.energy.input_works().couplings.work[shaft]; }
double coupling_loss(const Instant& now, std::size_t shaft) { return now.workspace.energy.input_works().couplings.dissipated[shaft]; }
double impulse(const Instant& now, std::size_t shaft) { return now.workspace.energy.input_works().impulse[shaft]; }
double chain_impulse(const Instant& now, std::size_t shaft) {
    return shaft_momentum(now.workspace)[shaft] - now.workspace.energy.input_works().net_impulse()[shaft];
}
double drag(const Instant& now, std::size_t shaft) { return now.observation.drag[shaft]; }
double drag_power(const Instant& now, std::size_t shaft) { return now.observation.drag[shaft] * now.observation.speed[shaft]; }
double dragged(const Instant& now, std::size_t shaft) { return now.workspace.energy.input_works().drag.energy[shaft]; }
/// Efficiency over the last pin period, with the pump's powers constant over it. Not all of the pump's power is input: the work of the oil
/// on the sheaves comes back. @param overall with the drag of the shafts
double efficiency_outside(const Instant& now, bool overall) {
    const double time = now.observation.time;
    const HydraulicInstant& oil = now.observation.hydraulics;
    const EnergyLedger& energy = now.workspace.energy;
    const std::optional<EnergySums> before = energy.sums_before(time);
    if (!before) return std::numeric_limits<double>::quiet_NaN();
    const EnergySums sums = energy.sums(time);
    const double lasted = time - before->time;
    return (overall ? sums.outside_since(*before) : sums.since(*before)).with_pump(lasted * oil.pump, lasted * oil.lost()).efficiency();
}

double vehicle_speed(const Instant& now) { return now.workspace.trip.speed(now.observation.time); }
double trip(const Instant& now, model::TripAccount account) {
    return now.workspace.trip.sums(now.observation.time)[static_cast<std::size_t>(account)];
}

double oil(const Instant& now, double HydraulicInstant::*member) { return now.observation.hydraulics.*member; }
double oil_of_shaft(const Instant& now, std::array<double, 2> HydraulicInstant::*member, std::size_t shaft) {
    return (now.observation.hydraulics.*member)[shaft];
}
double oil_energy(const Instant& now, double HydraulicEnergy::*member) { return now.observation.hydraulic_energy.*member; }

using enum Channel::Trait;
using Read = Channel::Read;
using A = model::TripAccount;
using I = HydraulicInstant;
using E = HydraulicEnergy;
const Channel further_table[] = {
    {"tips/normal_force", "N", "normal force of every tip's contact; tip = 4 link + 2 (front half) + (side +z)",
     Read(forces, &F::tip_normal), on_demand, "tip", of_tips},
    {"tips/tangential_force", "N", "circumferential force of every tip on its sheave, positive as the shaft's rotation is",
     Read(forces, &F::tip_tangential), on_demand, "tip", of_tips},
    {"tips/radial_force", "N", "radial force of every tip on its sheave, positive outwards", Read(forces, &F::tip_radial), on_demand, "tip",
     of_tips},
    {"pins/end_force", "N", "largest axial force on an end of a pin, both halves together", largest_pin_end, on_demand},
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
     any_machine | on_demand, "link_plate", of_a_link},
    {"followed_pin/bending_moment_travel", "N*m", "bending moment of the followed pin's rear and front half in the direction of travel",
     Read(followed_halves, &F::bending_travel), any_machine | on_demand, "pin_half", Channel::always(2)},
    {"followed_pin/bending_moment_height", "N*m", "bending moment of the followed pin's rear and front half along their height",
     Read(followed_halves, &F::bending_height), any_machine | on_demand, "pin_half", Channel::always(2)},
    {"followed_pin/half_axial_force", "N", "axial force of the followed pin's rear and front half, tension positive",
     Read(followed_halves, &F::half_axial), any_machine | on_demand, "pin_half", Channel::always(2)},
    {"shaft_1/bearing_force", "N", "force of the driving shaft on its bearings: x, y, axial", Read(bearing_force, 0), on_demand, "axis",
     Channel::always(3)},
    {"shaft_2/bearing_force", "N", "force of the driven shaft on its bearings: x, y, axial", Read(bearing_force, 1), on_demand, "axis",
     Channel::always(3)},
    {"shaft_1/bearing_moment", "N*m", "tilting moment of the driving shaft on its bearings about x, y", Read(bearing_moment, 0), on_demand,
     "tilt", Channel::always(2)},
    {"shaft_2/bearing_moment", "N*m", "tilting moment of the driven shaft on its bearings about x, y", Read(bearing_moment, 1), on_demand,
     "tilt", Channel::always(2)},
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
    {"shaft_1/impulse", "N*m*s", "angular impulse of the drive on the driving shaft so far: its change over a time is the mean torque",
     Read(impulse, 0), on_demand | so_far},
    {"shaft_2/impulse", "N*m*s",
     "angular impulse of the load on the driven shaft so far (negative brakes): its change over a time is the mean torque",
     Read(impulse, 1), on_demand | so_far},
    {"shaft_1/chain_impulse", "N*m*s", "angular impulse of the chain on the driving sheaves: its change over a time is the mean torque",
     Read(chain_impulse, 0), on_demand | so_far},
    {"shaft_2/chain_impulse", "N*m*s", "angular impulse of the chain on the driven sheaves: its change over a time is the mean torque",
     Read(chain_impulse, 1), on_demand | so_far},
    {"shaft_1/twist", "rad", "twist of the coupling of the driving shaft: far end less shaft", Read(twist, 0), on_demand | without_chain},
    {"shaft_2/twist", "rad", "twist of the coupling of the driven shaft: far end less shaft", Read(twist, 1), on_demand | without_chain},
    {"shaft_1/coupling_energy", "J", "energy stored in the coupling of the driving shaft", Read(stored, 0), on_demand | without_chain},
    {"shaft_2/coupling_energy", "J", "energy stored in the coupling of the driven shaft", Read(stored, 1), on_demand | without_chain},
    {"shaft_1/coupling_work", "J", "work done at the far end of the coupling of the driving shaft so far", Read(far_work, 0),
     on_demand | so_far},
    {"shaft_2/coupling_work", "J", "work done at the far end of the coupling of the driven shaft so far (negative: taken out)",
     Read(far_work, 1), on_demand | so_far},
    {"shaft_1/coupling_dissipated", "J", "energy dissipated in the coupling of the driving shaft so far", Read(coupling_loss, 0),
     on_demand | so_far},
    {"shaft_2/coupling_dissipated", "J", "energy dissipated in the coupling of the driven shaft so far", Read(coupling_loss, 1),
     on_demand | so_far},
    {"shaft_1/drag", "N*m", "torque that seals, bearings and oil take from the driving shaft", Read(drag, 0), of_drag},
    {"shaft_2/drag", "N*m", "torque that seals, bearings and oil take from the driven shaft", Read(drag, 1), of_drag},
    {"loss/shaft_1_drag", "W", "power that seals, bearings and oil take from the driving shaft; not in loss/total", Read(drag_power, 0),
     of_drag},
    {"loss/shaft_2_drag", "W", "power that seals, bearings and oil take from the driven shaft; not in loss/total", Read(drag_power, 1),
     of_drag},
    {"dissipated/shaft_1_drag", "J", "energy that seals, bearings and oil have taken from the driving shaft; not in dissipated/total",
     Read(dragged, 0), of_drag | unaveraged},
    {"dissipated/shaft_2_drag", "J", "energy that seals, bearings and oil have taken from the driven shaft; not in dissipated/total",
     Read(dragged, 1), of_drag | unaveraged},
    {"overall_efficiency", "1",
     "of an instant: 1 - losses/input over the last pin period from outside to outside: chain, drag of the shafts and pump; NaN where no "
     "energy flows; its mean is the quotient of the energies",
     Read(efficiency_outside, true), of_drag | may_be_undefined | unaveraged},
    {"vehicle/speed", "m/s", "speed of the vehicle by the cycle; zero without one, as all of vehicle/", vehicle_speed,
     on_demand | without_chain},
    {"vehicle/distance", "m", "distance so far", Read(trip, A::distance), on_demand | so_far},
    {"vehicle/traction", "J", "work of the traction force at the wheels so far, where it drives", Read(trip, A::traction),
     on_demand | so_far},
    {"vehicle/shaft_2", "J", "work that the cycle needs of shaft 2 so far: the sum of the following", Read(trip, A::shaft),
     on_demand | so_far},
    {"vehicle/kinetic", "J", "kinetic energy of the vehicle, gained so far", Read(trip, A::kinetic), on_demand | so_far},
    {"vehicle/climb", "J", "work against gravity so far", Read(trip, A::climb), on_demand | so_far},
    {"vehicle/air", "J", "work against the drag of air so far", Read(trip, A::air), on_demand | so_far},
    {"vehicle/rolling", "J", "work against rolling resistance so far", Read(trip, A::rolling), on_demand | so_far},
    {"vehicle/brakes", "J", "dissipated in the wheels' brakes so far", Read(trip, A::brakes), on_demand | so_far},
    {"vehicle/clutch", "J", "dissipated in the starting clutch so far", Read(trip, A::clutch), on_demand | so_far},
    {"vehicle/final_drive", "J", "dissipated in the final drive so far", Read(trip, A::final_drive), on_demand | so_far},
    {"shaft_1/pressure", "Pa", "pressure of the driving cylinder at the feed radius", Read(oil_of_shaft, &I::pressure, 0), of_hydraulics},
    {"shaft_2/pressure", "Pa", "pressure of the driven cylinder at the feed radius", Read(oil_of_shaft, &I::pressure, 1), of_hydraulics},
    {"shaft_1/pressure_target", "Pa", "pressure that is requested of the driving valve", Read(oil_of_shaft, &I::target, 0), of_hydraulics},
    {"shaft_2/pressure_target", "Pa", "pressure that is requested of the driven valve", Read(oil_of_shaft, &I::target, 1), of_hydraulics},
    {"shaft_1/oil_flow", "m^3/s", "flow through the valve into the driving cylinder (negative: out of it)", Read(oil_of_shaft, &I::flow, 0),
     of_hydraulics},
    {"shaft_2/oil_flow", "m^3/s", "flow through the valve into the driven cylinder (negative: out of it)", Read(oil_of_shaft, &I::flow, 1),
     of_hydraulics},
    {"pump/line_pressure", "Pa", "pressure behind the pump", Read(oil, &I::line), of_hydraulics},
    {"pump/speed", "rad/s", "speed of the pump", Read(oil, &I::pump_speed), of_hydraulics},
    {"pump/torque", "N*m", "torque on the pump's shaft", Read(oil, &I::pump_torque), of_hydraulics},
    {"pump/power", "W", "power of the pump's shaft", Read(oil, &I::pump), of_hydraulics},
    {"pump/flow", "m^3/s", "flow of the pump", Read(oil, &I::pump_flow), of_hydraulics},
    {"pump/spill", "m^3/s", "flow of the pump that no cylinder takes; 0: the pump is short of flow", Read(oil, &I::spill), of_hydraulics},
    {"loss/pump_friction", "W", "power dissipated by friction in the pump", Read(oil, &I::mechanical), of_hydraulics},
    {"loss/pump_leakage", "W", "power dissipated by leakage inside the pump", Read(oil, &I::volumetric), of_hydraulics},
    {"loss/relief", "W", "power dissipated by flow of the pump that no cylinder takes", Read(oil, &I::relief), of_hydraulics},
    {"loss/valves", "W", "power dissipated by throttling in the valves", Read(oil, &I::valves), of_hydraulics},
    {"loss/oil_leakage", "W", "power dissipated by leakage of the cylinders", Read(oil, &I::leakage), of_hydraulics},
    {"hydraulics/pump", "J", "work on the pump's shaft so far", Read(oil_energy, &E::pump), of_hydraulics | unaveraged},
    {"hydraulics/mechanical", "J", "lost in the pump by friction so far", Read(oil_energy, &E::mechanical), of_hydraulics | unaveraged},
    {"hydraulics/volumetric", "J", "lost in the pump by its leakage so far", Read(oil_energy, &E::volumetric), of_hydraulics | unaveraged},
    {"hydraulics/relief", "J", "lost by flow that no cylinder takes so far", Read(oil_energy, &E::relief), of_hydraulics | unaveraged},
    {"hydraulics/valves", "J", "lost by throttling in the valves so far", Read(oil_energy, &E::valves), of_hydraulics | unaveraged},
    {"hydraulics/leaked", "J", "lost by leakage of the cylinders so far", Read(oil_energy, &E::leakage), of_hydraulics | unaveraged},
    {"hydraulics/sheaves", "J", "work of the oil's pressure on the movable sheaves so far", Read(oil_energy, &E::sheaves),
     of_hydraulics | unaveraged},
    {"hydraulics/stored", "J", "energy of the compressed oil", Read(oil_energy, &E::stored), of_hydraulics},
    {"efficiency_with_pump", "1",
     "of an instant: 1 - losses/input over the last pin period, the pump's losses and power included; NaN where no energy flows; its mean "
     "is the quotient of the energies",
     Read(efficiency_outside, false), of_hydraulics | may_be_undefined | unaveraged},
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

std::span<const Channel> further_channels() { return further_table; }

}  // namespace cvtflow::tasks
