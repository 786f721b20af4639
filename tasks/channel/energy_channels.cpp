/// Channels of energies, losses and works, of an instant and so far; whether their balance closes; counts of the run.

#include "tasks/channel/channels.hpp"

namespace cvtflow::tasks {

namespace {

using model::Energy;
using model::Loss;
using model::Work;

constexpr std::string_view losses[] = {"inner",       "plate_damping", "plate_friction", "joint_damping", "joint_friction",
                                       "tip_damping", "tip_friction",  "supports",       "cylinder",      "guide"};
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
void balance_error_ratio(const Instant& now, double* out) { *out = now.workspace.energy.balance_error_ratio(); }
void control_target(const Instant& now, double* out) { *out = now.observation.control.target; }
void control_error(const Instant& now, double* out) { *out = now.observation.control.value - now.observation.control.target; }
void control_limited(const Instant& now, double* out) { *out = now.observation.control_limited ? 1.0 : 0.0; }
Channel::Read count(long Counters::*member) {
    return [member](const Instant& now, double* out) { *out = static_cast<double>(now.counters.*member); };
}

using enum Channel::Trait;
const Channel table_of_energies[] = {
    {"energy/kinetic", "J", "kinetic energy of chain, shafts and sheaves", energy(Energy::kinetic), any_machine},
    {"energy/inner", "J", "elastic energy inside pin halves", energy(Energy::inner), any_machine},
    {"energy/pack", "J", "elastic energy of plate packs in bending, shear and torsion", energy(Energy::pack), any_machine},
    {"energy/plates", "J", "elastic energy of plates in tension", energy(Energy::plates), any_machine},
    {"energy/joints", "J", "elastic energy of joints", energy(Energy::joints), any_machine},
    {"energy/tips", "J", "elastic energy of tip contacts", energy(Energy::tips)},
    {"energy/supports", "J", "elastic energy of bearings, sheave attachments and guides", energy(Energy::supports)},
    {"loss/inner", "W", "power dissipated inside pin halves and plate packs", loss(Loss::inner), any_machine},
    {"loss/plate_damping", "W", "power dissipated by damping of plates", loss(Loss::plate_damping), any_machine},
    {"loss/plate_friction", "W", "power dissipated by friction of plates on pins", loss(Loss::plate_friction), any_machine},
    {"loss/joint_damping", "W", "power dissipated by damping of joints", loss(Loss::joint_damping), any_machine},
    {"loss/joint_friction", "W", "power dissipated by friction in joints", loss(Loss::joint_friction), any_machine},
    {"loss/tip_damping", "W", "power dissipated by damping of tip contacts", loss(Loss::tip_damping)},
    {"loss/tip_friction", "W", "power dissipated by friction of tips on sheaves", loss(Loss::tip_friction)},
    {"loss/supports", "W", "power dissipated in bearings and sheave attachments", loss(Loss::supports)},
    {"loss/cylinder", "W", "power dissipated in the hydraulic cylinders", loss(Loss::cylinder)},
    {"loss/guide", "W", "power dissipated by the guides of the strands", loss(Loss::guide), of_guide},
    {"power/drive", "W", "power of the drive on shaft 1, behind its drag", work(Work::drive), without_chain},
    {"power/load", "W", "power of the load on shaft 2, before its drag (negative: taken out)", work(Work::load), without_chain},
    {"power/clamping", "W", "power of the clamping forces", work(Work::clamping), without_chain},
    {"dissipated/inner", "J", "energy dissipated inside pin halves and plate packs so far", dissipated(Loss::inner),
     any_machine | without_chain | unaveraged},
    {"dissipated/plate_damping", "J", "energy dissipated by damping of plates so far", dissipated(Loss::plate_damping),
     any_machine | without_chain | unaveraged},
    {"dissipated/plate_friction", "J", "energy dissipated by friction of plates on pins so far", dissipated(Loss::plate_friction),
     any_machine | without_chain | unaveraged},
    {"dissipated/joint_damping", "J", "energy dissipated by damping of joints so far", dissipated(Loss::joint_damping),
     any_machine | without_chain | unaveraged},
    {"dissipated/joint_friction", "J", "energy dissipated by friction in joints so far", dissipated(Loss::joint_friction),
     any_machine | without_chain | unaveraged},
    {"dissipated/tip_damping", "J", "energy dissipated by damping of tip contacts so far", dissipated(Loss::tip_damping),
     without_chain | unaveraged},
    {"dissipated/tip_friction", "J", "energy dissipated by friction of tips on sheaves so far", dissipated(Loss::tip_friction),
     without_chain | unaveraged},
    {"dissipated/supports", "J", "energy dissipated in bearings and sheave attachments so far", dissipated(Loss::supports),
     without_chain | unaveraged},
    {"dissipated/cylinder", "J", "energy dissipated in the hydraulic cylinders so far", dissipated(Loss::cylinder),
     without_chain | unaveraged},
    {"dissipated/guide", "J", "energy dissipated by the guides of the strands so far", dissipated(Loss::guide),
     of_guide | without_chain | unaveraged},
    {"dissipated/total", "J", "energy dissipated so far", dissipated_total, any_machine | without_chain | unaveraged},
    {"work/drive", "J", "work of the drive so far", done(Work::drive), without_chain | unaveraged},
    {"work/load", "J", "work of the load so far (negative: taken out)", done(Work::load), without_chain | unaveraged},
    {"work/clamping", "J", "work of the clamping forces so far", done(Work::clamping), without_chain | unaveraged},
    {"control/limited", "1", "1 while a controller is at the limit of its authority", control_limited, without_chain},
    {"control/target", "1", "target of the first controller: ratio, slip by the sheaves' positions, or safety factor", control_target,
     of_control},
    {"control/error", "1", "deviation from that target", control_error, of_control},
    {"balance/residual", "1", "|change of stored energy - work + losses| over the losses so far", residual,
     any_machine | without_chain | unaveraged},
    {"balance/suspicion", "1", "residual of the energy balance over its tolerance; above 1 the results are unreliable", balance_error_ratio,
     any_machine | without_chain | unaveraged},
    {"run/steps", "1", "steps so far", count(&Counters::steps), any_machine | without_chain | unaveraged},
    {"run/evaluations", "1", "evaluations of the right-hand side so far", count(&Counters::evaluations),
     any_machine | without_chain | unaveraged},
    {"run/transitions", "1", "transitions of phase so far", count(&Counters::detected), any_machine | without_chain | unaveraged},
    {"run/truncated", "1", "steps cut at a transition so far", count(&Counters::truncated), any_machine | without_chain | unaveraged},
    {"run/suppressed", "1", "transitions postponed because the tip had just changed", count(&Counters::suppressed),
     any_machine | without_chain | unaveraged},
};

}  // namespace

std::string_view loss_name(int kind) noexcept { return losses[kind]; }
std::string_view work_name(int kind) noexcept { return works[kind]; }
std::string_view energy_name(int kind) noexcept { return energies[kind]; }

std::span<const Channel> energy_channels() { return table_of_energies; }

}  // namespace cvtflow::tasks
