/// Channels of cylinders, valves and pump. (model/EQUATIONS.md section 8, hydraulics)

#include <utility>

#include "tasks/run/channels/channels.hpp"

namespace cvtflow::tasks {

namespace {

using model::HydraulicEnergy;
using model::HydraulicInstant;

Channel::Read of(double HydraulicInstant::*member) {
    return [member](const Instant& now, double* out) { *out = now.observation.hydraulics.*member; };
}
Channel::Read of(std::array<double, 2> HydraulicInstant::*member, std::size_t shaft) {
    return [member, shaft](const Instant& now, double* out) { *out = (now.observation.hydraulics.*member)[shaft]; };
}
Channel::Read energy(double HydraulicEnergy::*member) {
    return [member](const Instant& now, double* out) { *out = now.observation.hydraulic_energy.*member; };
}
/// Not all that the pump takes is input: what the oil does on the sheaves comes back.
void efficiency_with_pump(const Instant& now, double* out) {
    const HydraulicInstant& oil = now.observation.hydraulics;
    *out = now.workspace.energy.efficiency(now.observation.time, {oil.pump, oil.lost()});
}

Channel row(std::string_view name, std::string_view unit, std::string_view description, Channel::Read read) {
    return {.name = name, .unit = unit, .description = description, .read = std::move(read), .usual = false, .of_hydraulics = true};
}

}  // namespace

std::span<const Channel> hydraulic_channels() {
    using I = HydraulicInstant;
    using E = HydraulicEnergy;
    static const Channel table[] = {
        row("shaft_1/pressure", "Pa", "pressure of the driving cylinder at the feed radius", of(&I::pressure, 0)),
        row("shaft_2/pressure", "Pa", "pressure of the driven cylinder at the feed radius", of(&I::pressure, 1)),
        row("shaft_1/pressure_target", "Pa", "pressure that is requested of the driving valve", of(&I::target, 0)),
        row("shaft_2/pressure_target", "Pa", "pressure that is requested of the driven valve", of(&I::target, 1)),
        row("shaft_1/oil_flow", "m^3/s", "flow through the valve into the driving cylinder (negative: out of it)", of(&I::flow, 0)),
        row("shaft_2/oil_flow", "m^3/s", "flow through the valve into the driven cylinder (negative: out of it)", of(&I::flow, 1)),
        row("pump/line_pressure", "Pa", "pressure behind the pump", of(&I::line)),
        row("pump/speed", "rad/s", "speed of the pump", of(&I::pump_speed)),
        row("pump/torque", "N*m", "torque on the pump's shaft", of(&I::pump_torque)),
        row("pump/power", "W", "power of the pump's shaft", of(&I::pump)),
        row("pump/flow", "m^3/s", "flow of the pump", of(&I::pump_flow)),
        row("pump/spill", "m^3/s", "flow of the pump that no cylinder takes; 0: the pump is short of flow", of(&I::spill)),
        row("loss/pump_friction", "W", "power dissipated by friction in the pump", of(&I::mechanical)),
        row("loss/pump_leakage", "W", "power dissipated by leakage inside the pump", of(&I::volumetric)),
        row("loss/relief", "W", "power dissipated by flow of the pump that no cylinder takes", of(&I::relief)),
        row("loss/valves", "W", "power dissipated by throttling in the valves", of(&I::valves)),
        row("loss/oil_leakage", "W", "power dissipated by leakage of the cylinders", of(&I::leakage)),
        row("hydraulics/pump", "J", "work on the pump's shaft so far", energy(&E::pump)),
        row("hydraulics/mechanical", "J", "lost in the pump by friction so far", energy(&E::mechanical)),
        row("hydraulics/volumetric", "J", "lost in the pump by its leakage so far", energy(&E::volumetric)),
        row("hydraulics/relief", "J", "lost by flow that no cylinder takes so far", energy(&E::relief)),
        row("hydraulics/valves", "J", "lost by throttling in the valves so far", energy(&E::valves)),
        row("hydraulics/leaked", "J", "lost by leakage of the cylinders so far", energy(&E::leakage)),
        row("hydraulics/sheaves", "J", "work of the oil's pressure on the movable sheaves so far", energy(&E::sheaves)),
        row("hydraulics/stored", "J", "energy of the compressed oil", energy(&E::stored)),
        {.name = "efficiency_with_pump",
         .unit = "1",
         .description = "1 - losses/input over the last pin period, the pump's losses and power included; NaN without input",
         .read = efficiency_with_pump,
         .usual = false,
         .of_hydraulics = true,
         .may_be_undefined = true},
    };
    return table;
}

}  // namespace cvtflow::tasks
