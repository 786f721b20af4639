/// Channels of what drives the variator from outside: couplings, the impulse that a co-simulation exchanges, drag of the shafts, and
/// hydraulics (cylinders, valves, pump: model/EQUATIONS.md section 8).

#include <limits>
#include <optional>

#include "tasks/channel/channels.hpp"

namespace cvtflow::tasks {

namespace {

using enum Channel::Trait;
using model::HydraulicEnergy;
using model::HydraulicInstant;

[[nodiscard]] model::CouplingState coupling(const Instant& now, int shaft) {
    return now.workspace.variator.pulleys().coupling(now.observation.time, now.workspace.tail(), shaft);
}

Channel::Read twist(int shaft) {
    return [shaft](const Instant& now, double* out) { *out = coupling(now, shaft).twist; };
}
Channel::Read stored(int shaft) {
    return [shaft](const Instant& now, double* out) { *out = coupling(now, shaft).energy; };
}
Channel::Read far_work(std::size_t shaft) {
    return [shaft](const Instant& now, double* out) { *out = now.workspace.energy.input_works().couplings.work[shaft]; };
}
Channel::Read dissipated(std::size_t shaft) {
    return [shaft](const Instant& now, double* out) { *out = now.workspace.energy.input_works().couplings.dissipated[shaft]; };
}
Channel::Read impulse(std::size_t shaft) {
    return [shaft](const Instant& now, double* out) { *out = now.workspace.energy.input_works().impulse[shaft]; };
}
Channel::Read chain_impulse(std::size_t shaft) {
    return [shaft](const Instant& now, double* out) {
        *out = shaft_momentum(now.workspace)[shaft] - now.workspace.energy.input_works().net_impulse()[shaft];
    };
}
Channel::Read drag(std::size_t shaft) {
    return [shaft](const Instant& now, double* out) { *out = now.observation.drag[shaft]; };
}
Channel::Read drag_power(std::size_t shaft) {
    return [shaft](const Instant& now, double* out) { *out = now.observation.drag[shaft] * now.observation.speed[shaft]; };
}
Channel::Read dragged(std::size_t shaft) {
    return [shaft](const Instant& now, double* out) { *out = now.workspace.energy.input_works().drag.energy[shaft]; };
}
/// Over the last pin period; the pump's powers have lasted as long. Not all that it takes is input: what the oil does on the sheaves comes
/// back. @param overall  the drag of the shafts included
Channel::Read efficiency(bool overall) {
    return [overall](const Instant& now, double* out) {
        const double time = now.observation.time;
        const HydraulicInstant& oil = now.observation.hydraulics;
        const EnergyLedger& energy = now.workspace.energy;
        const std::optional<EnergySums> before = energy.sums_before(time);
        *out = std::numeric_limits<double>::quiet_NaN();
        if (!before) return;
        const double lasted = time - before->time, pump = lasted * oil.pump, lost = lasted * oil.lost();
        *out = overall ? energy.sums(time).overall_since(*before, pump, lost) : energy.sums(time).efficiency_since(*before, pump, lost);
    };
}

void vehicle_speed(const Instant& now, double* out) { *out = now.workspace.trip.speed(now.observation.time); }
Channel::Read trip(model::TripAccount account) {
    return [account](const Instant& now, double* out) {
        *out = now.workspace.trip.sums(now.observation.time)[static_cast<std::size_t>(account)];
    };
}

const Channel table_of_couplings[] = {
    {"shaft_1/impulse", "N*m*s", "angular impulse of the drive on the driving shaft so far: its change over a time is the mean torque",
     impulse(0), on_demand | without_chain | unaveraged},
    {"shaft_2/impulse", "N*m*s",
     "angular impulse of the load on the driven shaft so far (negative brakes): its change over a time is the mean torque", impulse(1),
     on_demand | without_chain | unaveraged},
    {"shaft_1/chain_impulse", "N*m*s", "angular impulse of the chain on the driving sheaves: its change over a time is the mean torque",
     chain_impulse(0), on_demand | without_chain | unaveraged},
    {"shaft_2/chain_impulse", "N*m*s", "angular impulse of the chain on the driven sheaves: its change over a time is the mean torque",
     chain_impulse(1), on_demand | without_chain | unaveraged},
    {"shaft_1/twist", "rad", "twist of the coupling of the driving shaft: far end less shaft", twist(0), on_demand | without_chain},
    {"shaft_2/twist", "rad", "twist of the coupling of the driven shaft: far end less shaft", twist(1), on_demand | without_chain},
    {"shaft_1/coupling_energy", "J", "energy stored in the coupling of the driving shaft", stored(0), on_demand | without_chain},
    {"shaft_2/coupling_energy", "J", "energy stored in the coupling of the driven shaft", stored(1), on_demand | without_chain},
    {"shaft_1/coupling_work", "J", "work done at the far end of the coupling of the driving shaft so far", far_work(0),
     on_demand | without_chain | unaveraged},
    {"shaft_2/coupling_work", "J", "work done at the far end of the coupling of the driven shaft so far (negative: taken out)", far_work(1),
     on_demand | without_chain | unaveraged},
    {"shaft_1/coupling_dissipated", "J", "energy dissipated in the coupling of the driving shaft so far", dissipated(0),
     on_demand | without_chain | unaveraged},
    {"shaft_2/coupling_dissipated", "J", "energy dissipated in the coupling of the driven shaft so far", dissipated(1),
     on_demand | without_chain | unaveraged},
    {"shaft_1/drag", "N*m", "torque that seals, bearings and oil take from the driving shaft", drag(0), of_drag},
    {"shaft_2/drag", "N*m", "torque that seals, bearings and oil take from the driven shaft", drag(1), of_drag},
    {"loss/shaft_1_drag", "W", "power that seals, bearings and oil take from the driving shaft; not in loss/total", drag_power(0), of_drag},
    {"loss/shaft_2_drag", "W", "power that seals, bearings and oil take from the driven shaft; not in loss/total", drag_power(1), of_drag},
    {"dissipated/shaft_1_drag", "J", "energy that seals, bearings and oil have taken from the driving shaft; not in dissipated/total",
     dragged(0), of_drag | unaveraged},
    {"dissipated/shaft_2_drag", "J", "energy that seals, bearings and oil have taken from the driven shaft; not in dissipated/total",
     dragged(1), of_drag | unaveraged},
    {"overall_efficiency", "1",
     "1 - losses/input over the last pin period from outside to outside: chain, drag of the shafts and pump; NaN without input",
     efficiency(true), of_drag | may_be_undefined | unaveraged},
};

Channel::Read of(double HydraulicInstant::*member) {
    return [member](const Instant& now, double* out) { *out = now.observation.hydraulics.*member; };
}
Channel::Read of(std::array<double, 2> HydraulicInstant::*member, std::size_t shaft) {
    return [member, shaft](const Instant& now, double* out) { *out = (now.observation.hydraulics.*member)[shaft]; };
}
Channel::Read energy(double HydraulicEnergy::*member) {
    return [member](const Instant& now, double* out) { *out = now.observation.hydraulic_energy.*member; };
}

}  // namespace

std::span<const Channel> coupling_channels() { return table_of_couplings; }

std::span<const Channel> vehicle_channels() {
    using A = model::TripAccount;
    static const Channel table[] = {
        {"vehicle/speed", "m/s", "speed of the vehicle by the cycle; zero without one, as all of vehicle/", vehicle_speed,
         on_demand | without_chain},
        {"vehicle/distance", "m", "distance so far", trip(A::distance), on_demand | without_chain | unaveraged},
        {"vehicle/traction", "J", "work of the traction force at the wheels so far, where it drives", trip(A::traction),
         on_demand | without_chain | unaveraged},
        {"vehicle/shaft_2", "J", "work that the cycle needs of shaft 2 so far: the sum of the following", trip(A::shaft),
         on_demand | without_chain | unaveraged},
        {"vehicle/kinetic", "J", "kinetic energy of the vehicle, gained so far", trip(A::kinetic), on_demand | without_chain | unaveraged},
        {"vehicle/climb", "J", "work against gravity so far", trip(A::climb), on_demand | without_chain | unaveraged},
        {"vehicle/air", "J", "work against the drag of air so far", trip(A::air), on_demand | without_chain | unaveraged},
        {"vehicle/rolling", "J", "work against rolling resistance so far", trip(A::rolling), on_demand | without_chain | unaveraged},
        {"vehicle/brakes", "J", "dissipated in the wheels' brakes so far", trip(A::brakes), on_demand | without_chain | unaveraged},
        {"vehicle/clutch", "J", "dissipated in the starting clutch so far", trip(A::clutch), on_demand | without_chain | unaveraged},
        {"vehicle/final_drive", "J", "dissipated in the final drive so far", trip(A::final_drive), on_demand | without_chain | unaveraged},
    };
    return table;
}

std::span<const Channel> hydraulic_channels() {
    using I = HydraulicInstant;
    using E = HydraulicEnergy;
    static const Channel table[] = {
        {"shaft_1/pressure", "Pa", "pressure of the driving cylinder at the feed radius", of(&I::pressure, 0), of_hydraulics},
        {"shaft_2/pressure", "Pa", "pressure of the driven cylinder at the feed radius", of(&I::pressure, 1), of_hydraulics},
        {"shaft_1/pressure_target", "Pa", "pressure that is requested of the driving valve", of(&I::target, 0), of_hydraulics},
        {"shaft_2/pressure_target", "Pa", "pressure that is requested of the driven valve", of(&I::target, 1), of_hydraulics},
        {"shaft_1/oil_flow", "m^3/s", "flow through the valve into the driving cylinder (negative: out of it)", of(&I::flow, 0),
         of_hydraulics},
        {"shaft_2/oil_flow", "m^3/s", "flow through the valve into the driven cylinder (negative: out of it)", of(&I::flow, 1),
         of_hydraulics},
        {"pump/line_pressure", "Pa", "pressure behind the pump", of(&I::line), of_hydraulics},
        {"pump/speed", "rad/s", "speed of the pump", of(&I::pump_speed), of_hydraulics},
        {"pump/torque", "N*m", "torque on the pump's shaft", of(&I::pump_torque), of_hydraulics},
        {"pump/power", "W", "power of the pump's shaft", of(&I::pump), of_hydraulics},
        {"pump/flow", "m^3/s", "flow of the pump", of(&I::pump_flow), of_hydraulics},
        {"pump/spill", "m^3/s", "flow of the pump that no cylinder takes; 0: the pump is short of flow", of(&I::spill), of_hydraulics},
        {"loss/pump_friction", "W", "power dissipated by friction in the pump", of(&I::mechanical), of_hydraulics},
        {"loss/pump_leakage", "W", "power dissipated by leakage inside the pump", of(&I::volumetric), of_hydraulics},
        {"loss/relief", "W", "power dissipated by flow of the pump that no cylinder takes", of(&I::relief), of_hydraulics},
        {"loss/valves", "W", "power dissipated by throttling in the valves", of(&I::valves), of_hydraulics},
        {"loss/oil_leakage", "W", "power dissipated by leakage of the cylinders", of(&I::leakage), of_hydraulics},
        {"hydraulics/pump", "J", "work on the pump's shaft so far", energy(&E::pump), of_hydraulics | unaveraged},
        {"hydraulics/mechanical", "J", "lost in the pump by friction so far", energy(&E::mechanical), of_hydraulics | unaveraged},
        {"hydraulics/volumetric", "J", "lost in the pump by its leakage so far", energy(&E::volumetric), of_hydraulics | unaveraged},
        {"hydraulics/relief", "J", "lost by flow that no cylinder takes so far", energy(&E::relief), of_hydraulics | unaveraged},
        {"hydraulics/valves", "J", "lost by throttling in the valves so far", energy(&E::valves), of_hydraulics | unaveraged},
        {"hydraulics/leaked", "J", "lost by leakage of the cylinders so far", energy(&E::leakage), of_hydraulics | unaveraged},
        {"hydraulics/sheaves", "J", "work of the oil's pressure on the movable sheaves so far", energy(&E::sheaves),
         of_hydraulics | unaveraged},
        {"hydraulics/stored", "J", "energy of the compressed oil", energy(&E::stored), of_hydraulics},
        {"efficiency_with_pump", "1", "1 - losses/input over the last pin period, the pump's losses and power included; NaN without input",
         efficiency(false), of_hydraulics | may_be_undefined | unaveraged},
    };
    return table;
}

}  // namespace cvtflow::tasks
