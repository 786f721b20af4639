/// Channels of energies, losses and works, of an instant and so far; whether their balance closes; counts of the run.

#include "tasks/run/channels/channels.hpp"

namespace cvtflow::tasks {

namespace {

using model::Energy;
using model::Loss;
using model::Work;

constexpr std::string_view losses[] = {"inner",       "plate_damping", "plate_friction", "joint_damping", "joint_friction",
                                       "tip_damping", "tip_friction",  "supports",       "cylinder"};
constexpr std::string_view works[] = {"drive", "load", "clamping"};
constexpr std::string_view energies[] = {"kinetic", "inner", "pack", "plates", "joints", "tips", "supports"};

Channel::Read loss(Loss kind) {
    return [kind](const Instant& now, double* out) { *out = now.observation.account[kind]; };
}
Channel::Read energy(Energy kind) {
    return [kind](const Instant& now, double* out) { *out = now.observation.account[kind]; };
}
Channel::Read work(Work kind) {
    return [kind](const Instant& now, double* out) { *out = now.observation.work[static_cast<std::size_t>(kind)]; };
}

/// Sums of works and losses up to the instant.
[[nodiscard]] EnergySums sums(const Instant& now) { return now.workspace.energy.sums(now.observation.time); }

Channel::Read dissipated(Loss kind) {
    return [kind](const Instant& now, double* out) { *out = sums(now).loss[static_cast<std::size_t>(kind)]; };
}
void dissipated_total(const Instant& now, double* out) { *out = sums(now).lost(); }
Channel::Read done(Work kind) {
    return [kind](const Instant& now, double* out) { *out = sums(now).work[static_cast<std::size_t>(kind)]; };
}
void residual(const Instant& now, double* out) { *out = now.workspace.energy.balance().relative(); }
void suspicion(const Instant& now, double* out) { *out = now.workspace.energy.suspicion(); }
void control_limited(const Instant& now, double* out) { *out = now.observation.control_limited ? 1.0 : 0.0; }
Channel::Read count(long Counters::*member) {
    return [member](const Instant& now, double* out) { *out = static_cast<double>(now.counters.*member); };
}

const Channel table_of_energies[] = {
    {.name = "energy/kinetic",
     .unit = "J",
     .description = "kinetic energy of chain, shafts and sheaves",
     .read = energy(Energy::kinetic),
     .needs_pulleys = false},
    {.name = "energy/inner",
     .unit = "J",
     .description = "elastic energy inside pin halves",
     .read = energy(Energy::inner),
     .needs_pulleys = false},
    {.name = "energy/pack",
     .unit = "J",
     .description = "elastic energy of plate packs in bending, shear and torsion",
     .read = energy(Energy::pack),
     .needs_pulleys = false},
    {.name = "energy/plates",
     .unit = "J",
     .description = "elastic energy of plates in tension",
     .read = energy(Energy::plates),
     .needs_pulleys = false},
    {.name = "energy/joints",
     .unit = "J",
     .description = "elastic energy of joints",
     .read = energy(Energy::joints),
     .needs_pulleys = false},
    {.name = "energy/tips", .unit = "J", .description = "elastic energy of tip contacts", .read = energy(Energy::tips)},
    {.name = "energy/supports",
     .unit = "J",
     .description = "elastic energy of bearings and sheave attachments",
     .read = energy(Energy::supports)},
    {.name = "loss/inner",
     .unit = "W",
     .description = "power dissipated inside pin halves and plate packs",
     .read = loss(Loss::inner),
     .needs_pulleys = false},
    {.name = "loss/plate_damping",
     .unit = "W",
     .description = "power dissipated by damping of plates",
     .read = loss(Loss::plate_damping),
     .needs_pulleys = false},
    {.name = "loss/plate_friction",
     .unit = "W",
     .description = "power dissipated by friction of plates on pins",
     .read = loss(Loss::plate_friction),
     .needs_pulleys = false},
    {.name = "loss/joint_damping",
     .unit = "W",
     .description = "power dissipated by damping of joints",
     .read = loss(Loss::joint_damping),
     .needs_pulleys = false},
    {.name = "loss/joint_friction",
     .unit = "W",
     .description = "power dissipated by friction in joints",
     .read = loss(Loss::joint_friction),
     .needs_pulleys = false},
    {.name = "loss/tip_damping",
     .unit = "W",
     .description = "power dissipated by damping of tip contacts",
     .read = loss(Loss::tip_damping)},
    {.name = "loss/tip_friction",
     .unit = "W",
     .description = "power dissipated by friction of tips on sheaves",
     .read = loss(Loss::tip_friction)},
    {.name = "loss/supports",
     .unit = "W",
     .description = "power dissipated in bearings and sheave attachments",
     .read = loss(Loss::supports)},
    {.name = "loss/cylinder", .unit = "W", .description = "power dissipated in the hydraulic cylinders", .read = loss(Loss::cylinder)},
    {.name = "power/drive", .unit = "W", .description = "power of the drive", .read = work(Work::drive)},
    {.name = "power/load", .unit = "W", .description = "power of the load (negative: taken out)", .read = work(Work::load)},
    {.name = "power/clamping", .unit = "W", .description = "power of the clamping forces", .read = work(Work::clamping)},
    {.name = "dissipated/inner",
     .unit = "J",
     .description = "energy dissipated inside pin halves and plate packs so far",
     .read = dissipated(Loss::inner),
     .needs_pulleys = false},
    {.name = "dissipated/plate_damping",
     .unit = "J",
     .description = "energy dissipated by damping of plates so far",
     .read = dissipated(Loss::plate_damping),
     .needs_pulleys = false},
    {.name = "dissipated/plate_friction",
     .unit = "J",
     .description = "energy dissipated by friction of plates on pins so far",
     .read = dissipated(Loss::plate_friction),
     .needs_pulleys = false},
    {.name = "dissipated/joint_damping",
     .unit = "J",
     .description = "energy dissipated by damping of joints so far",
     .read = dissipated(Loss::joint_damping),
     .needs_pulleys = false},
    {.name = "dissipated/joint_friction",
     .unit = "J",
     .description = "energy dissipated by friction in joints so far",
     .read = dissipated(Loss::joint_friction),
     .needs_pulleys = false},
    {.name = "dissipated/tip_damping",
     .unit = "J",
     .description = "energy dissipated by damping of tip contacts so far",
     .read = dissipated(Loss::tip_damping)},
    {.name = "dissipated/tip_friction",
     .unit = "J",
     .description = "energy dissipated by friction of tips on sheaves so far",
     .read = dissipated(Loss::tip_friction)},
    {.name = "dissipated/supports",
     .unit = "J",
     .description = "energy dissipated in bearings and sheave attachments so far",
     .read = dissipated(Loss::supports)},
    {.name = "dissipated/cylinder",
     .unit = "J",
     .description = "energy dissipated in the hydraulic cylinders so far",
     .read = dissipated(Loss::cylinder)},
    {.name = "dissipated/total", .unit = "J", .description = "energy dissipated so far", .read = dissipated_total, .needs_pulleys = false},
    {.name = "work/drive", .unit = "J", .description = "work of the drive so far", .read = done(Work::drive)},
    {.name = "work/load", .unit = "J", .description = "work of the load so far (negative: taken out)", .read = done(Work::load)},
    {.name = "work/clamping", .unit = "J", .description = "work of the clamping forces so far", .read = done(Work::clamping)},
    {.name = "control/limited",
     .unit = "1",
     .description = "1 while a controller is at the limit of its authority",
     .read = control_limited},
    {.name = "balance/residual",
     .unit = "1",
     .description = "|change of stored energy - work + losses| over the losses so far",
     .read = residual,
     .needs_pulleys = false},
    {.name = "balance/suspicion",
     .unit = "1",
     .description = "residual of the energy balance over its tolerance; above 1 the results are unreliable",
     .read = suspicion,
     .needs_pulleys = false},
    {.name = "run/steps", .unit = "1", .description = "steps so far", .read = count(&Counters::steps), .needs_pulleys = false},
    {.name = "run/evaluations",
     .unit = "1",
     .description = "evaluations of the right-hand side so far",
     .read = count(&Counters::evaluations),
     .needs_pulleys = false},
    {.name = "run/transitions",
     .unit = "1",
     .description = "transitions of phase so far; at rigid pins 0, not counted",
     .read = count(&Counters::detected),
     .needs_pulleys = false},
    {.name = "run/truncated",
     .unit = "1",
     .description = "steps cut at a transition so far",
     .read = count(&Counters::truncated),
     .needs_pulleys = false},
    {.name = "run/suppressed",
     .unit = "1",
     .description = "transitions postponed because the tip had just changed",
     .read = count(&Counters::suppressed),
     .needs_pulleys = false},
};

}  // namespace

std::string_view loss_name(int kind) noexcept { return losses[kind]; }
std::string_view work_name(int kind) noexcept { return works[kind]; }
std::string_view energy_name(int kind) noexcept { return energies[kind]; }

std::span<const Channel> energy_channels() { return table_of_energies; }

}  // namespace cvtflow::tasks
