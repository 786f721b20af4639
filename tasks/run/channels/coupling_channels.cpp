/// Channels of what couples the shafts to the outside: couplings, and the impulse that a co-simulation exchanges.

#include "tasks/run/channels/channels.hpp"

namespace cvtflow::tasks {

namespace {

[[nodiscard]] model::CouplingState coupling(const Instant& now, int shaft) {
    const model::ChainLayout& at = now.workspace.layout();
    return now.workspace.variator.pulleys().coupling(now.observation.time, now.workspace.states[0] + at.pulley_begin(), shaft);
}

Channel::Read twist(int shaft) {
    return [shaft](const Instant& now, double* out) { *out = coupling(now, shaft).twist; };
}
Channel::Read stored(int shaft) {
    return [shaft](const Instant& now, double* out) { *out = coupling(now, shaft).energy; };
}
Channel::Read far_work(std::size_t shaft) {
    return [shaft](const Instant& now, double* out) { *out = now.workspace.energy.couplings().work[shaft]; };
}
Channel::Read dissipated(std::size_t shaft) {
    return [shaft](const Instant& now, double* out) { *out = now.workspace.energy.couplings().dissipated[shaft]; };
}
Channel::Read impulse(std::size_t shaft) {
    return [shaft](const Instant& now, double* out) { *out = now.workspace.energy.impulse()[shaft]; };
}

const Channel table_of_couplings[] = {
    {.name = "shaft_1/impulse",
     .unit = "N*m*s",
     .description = "angular impulse of the drive on the driving shaft so far: its change over a time is the mean torque",
     .read = impulse(0),
     .usual = false},
    {.name = "shaft_2/impulse",
     .unit = "N*m*s",
     .description = "angular impulse of the load on the driven shaft so far (negative brakes): its change over a time is the mean torque",
     .read = impulse(1),
     .usual = false},
    {.name = "shaft_1/twist",
     .unit = "rad",
     .description = "twist of the coupling of the driving shaft: far end less shaft",
     .read = twist(0),
     .usual = false},
    {.name = "shaft_2/twist",
     .unit = "rad",
     .description = "twist of the coupling of the driven shaft: far end less shaft",
     .read = twist(1),
     .usual = false},
    {.name = "shaft_1/coupling_energy",
     .unit = "J",
     .description = "energy stored in the coupling of the driving shaft",
     .read = stored(0),
     .usual = false},
    {.name = "shaft_2/coupling_energy",
     .unit = "J",
     .description = "energy stored in the coupling of the driven shaft",
     .read = stored(1),
     .usual = false},
    {.name = "shaft_1/coupling_work",
     .unit = "J",
     .description = "work done at the far end of the coupling of the driving shaft so far",
     .read = far_work(0),
     .usual = false},
    {.name = "shaft_2/coupling_work",
     .unit = "J",
     .description = "work done at the far end of the coupling of the driven shaft so far (negative: taken out)",
     .read = far_work(1),
     .usual = false},
    {.name = "shaft_1/coupling_dissipated",
     .unit = "J",
     .description = "energy dissipated in the coupling of the driving shaft so far",
     .read = dissipated(0),
     .usual = false},
    {.name = "shaft_2/coupling_dissipated",
     .unit = "J",
     .description = "energy dissipated in the coupling of the driven shaft so far",
     .read = dissipated(1),
     .usual = false},
};

}  // namespace

std::span<const Channel> coupling_channels() { return table_of_couplings; }

}  // namespace cvtflow::tasks
