/// Channels of what drives the variator from outside: couplings, the impulse that a co-simulation exchanges, drag of the shafts, and
/// hydraulics (cylinders, valves, pump: model/EQUATIONS.md section 8).

#include <limits>
#include <optional>

#include "tasks/channel/channels.hpp"

namespace cvtflow::tasks {

namespace {

using enum Channel::Trait;
using Read = Channel::Read;
using model::HydraulicEnergy;
using model::HydraulicInstant;

[[nodiscard]] model::CouplingState coupling(const Instant& now, int shaft) {
    return now.workspace.variator.pulleys().coupling(now.observation.time, now.workspace.tail(), shaft);
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
/// Over the last pin period; the pump's powers have lasted as long. Not all that it takes is input: what the oil does on the sheaves comes
/// back. @param overall  the drag of the shafts included
double efficiency_outside(const Instant& now, bool overall) {
    const double time = now.observation.time;
    const HydraulicInstant& oil = now.observation.hydraulics;
    const EnergyLedger& energy = now.workspace.energy;
    const std::optional<EnergySums> before = energy.sums_before(time);
    if (!before) return std::numeric_limits<double>::quiet_NaN();
    const double lasted = time - before->time, pump = lasted * oil.pump, lost = lasted * oil.lost();
    return overall ? energy.sums(time).overall_since(*before, pump, lost) : energy.sums(time).efficiency_since(*before, pump, lost);
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

using A = model::TripAccount;
using I = HydraulicInstant;
using E = HydraulicEnergy;
const Channel table_of_drives[] = {
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
     "1 - losses/input over the last pin period from outside to outside: chain, drag of the shafts and pump; NaN without input",
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
    {"efficiency_with_pump", "1", "1 - losses/input over the last pin period, the pump's losses and power included; NaN without input",
     Read(efficiency_outside, false), of_hydraulics | may_be_undefined | unaveraged},
};

}  // namespace

std::span<const Channel> drive_channels() { return table_of_drives; }

}  // namespace cvtflow::tasks
