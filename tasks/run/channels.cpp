#include "tasks/run/channels.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::tasks {

namespace {

using model::ChainLayout;
using model::ChainModel;
using model::Observation;

constexpr std::string_view losses[] = {"inner",       "plate_damping", "plate_friction", "joint_damping", "joint_friction",
                                       "tip_damping", "tip_friction",  "supports",       "cylinder"};
constexpr std::string_view works[] = {"drive", "load", "clamping"};
constexpr std::string_view energies[] = {"kinetic", "inner", "pack", "plates", "joints", "tips", "supports"};

int one(const ChainModel&) { return 1; }
int per_link(const ChainModel& chain) { return chain.layout().links; }
int per_tip(const ChainModel& chain) { return model::tips_per_link * chain.layout().links; }

template <auto Member>
void scalar(const Instant& now, double* out) {
    *out = now.observation.*Member;
}
template <auto Member, std::size_t Index>
void element(const Instant& now, double* out) {
    *out = (now.observation.*Member)[Index];
}
template <auto Member>
void list(const Instant& now, double* out) {
    const auto& values = now.observation.*Member;
    std::copy(values.begin(), values.end(), out);
}
template <auto Member>
void count(const Instant& now, double* out) {
    *out = static_cast<double>(now.counters.*Member);
}
template <std::size_t Kind>
void loss(const Instant& now, double* out) {
    *out = now.observation.account.loss[Kind];
}
template <std::size_t Kind>
void energy(const Instant& now, double* out) {
    *out = now.observation.account.energy[Kind];
}
template <std::size_t Kind>
void work(const Instant& now, double* out) {
    *out = now.observation.work[Kind];
}

/// Sums of works and losses up to the instant.
[[nodiscard]] EnergySums sums(const Instant& now) { return now.workspace.energy.sums(now.observation.time); }

/// Of the instant where no output lies before it.
void efficiency(const Instant& now, double* out) {
    *out = now.workspace.energy.efficiency();
    if (std::isfinite(*out)) return;
    EnergySums powers;
    powers.loss = now.observation.account.loss;
    powers.work = now.observation.work;
    *out = powers.efficiency_since({});
    if (!std::isfinite(*out)) *out = 0.0;
}
template <std::size_t Shaft>
void chain_torque(const Instant& now, double* out) {
    *out = now.workspace.energy.chain_torque()[Shaft];
    if (!std::isfinite(*out)) *out = now.observation.chain_torque[Shaft];
}
template <std::size_t Kind>
void dissipated(const Instant& now, double* out) {
    *out = sums(now).loss[Kind];
}
void dissipated_total(const Instant& now, double* out) { *out = sums(now).lost(); }
template <std::size_t Kind>
void done(const Instant& now, double* out) {
    *out = sums(now).work[Kind];
}
void residual(const Instant& now, double* out) { *out = now.workspace.energy.balance().relative(); }
void suspicion(const Instant& now, double* out) { *out = now.workspace.energy.suspicion(); }
void control_limited(const Instant& now, double* out) { *out = now.observation.control_limited ? 1.0 : 0.0; }
void thrust_ratio(const Instant& now, double* out) {
    const Observation& o = now.observation;
    *out = o.clamping[1] != 0.0 ? o.clamping[0] / o.clamping[1] : 0.0;
}

/// Tips of the pin that is followed: of its rear half on its own link and of its front half on the link before.
void followed_axial(const Instant& now, double* out) {
    const int links = now.workspace.layout().links;
    const int before = (now.followed_pin + links - 1) % links;
    const auto& tips = now.observation.tip_axial;
    const auto force = [&](int link, int end, int side) {
        return tips[static_cast<std::size_t>(model::tips_per_link * link + 2 * end + side)];
    };
    for (int side = 0; side < 2; ++side) out[side] = force(now.followed_pin, 0, side) + force(before, 1, side);
}
void followed_position(const Instant& now, double* out) {
    const ChainLayout& at = now.workspace.layout();
    const double* block = now.workspace.states[0] + at.link_begin(now.followed_pin);
    out[0] = block[at.x(model::End::rear, 0)];
    out[1] = block[at.y(model::End::rear, 0)];
    out[2] = block[at.z(model::End::rear)];
}
void followed_tension(const Instant& now, double* out) { *out = now.observation.tension[static_cast<std::size_t>(now.followed_pin)]; }
int two(const ChainModel&) { return 2; }
int three(const ChainModel&) { return 3; }
int four(const ChainModel&) { return 4; }
void touching(const Instant& now, double* out) { *out = now.observation.touching; }

using O = Observation;
constexpr Channel table[] = {
    {"shaft_1/speed", "rad/s", "speed of the driving shaft", "", one, element<&O::speed, 0>},
    {"shaft_2/speed", "rad/s", "speed of the driven shaft", "", one, element<&O::speed, 1>},
    {"shaft_1/angle", "rad", "angle of the driving shaft", "", one, element<&O::angle, 0>},
    {"shaft_2/angle", "rad", "angle of the driven shaft", "", one, element<&O::angle, 1>},
    {"shaft_1/torque", "N*m", "torque of the drive on the driving shaft", "", one, element<&O::torque, 0>},
    {"shaft_2/torque", "N*m", "torque of the load on the driven shaft (negative brakes)", "", one, element<&O::torque, 1>},
    {"shaft_1/chain_torque", "N*m", "torque of the chain on the driving sheaves, mean since the last output (their change of momentum)", "",
     one, chain_torque<0>},
    {"shaft_2/chain_torque", "N*m", "torque of the chain on the driven sheaves, mean since the last output (their change of momentum)", "",
     one, chain_torque<1>},
    {"shaft_1/clamping", "N", "clamping force S_1 of the driving sheaves", "", one, element<&O::clamping, 0>},
    {"shaft_2/clamping", "N", "clamping force S_2 of the driven sheaves", "", one, element<&O::clamping, 1>},
    {"shaft_1/radius", "m", "mean running radius of the pins between the driving sheaves", "", one, element<&O::radius, 0>},
    {"shaft_2/radius", "m", "mean running radius of the pins between the driven sheaves", "", one, element<&O::radius, 1>},
    {"shaft_1/pin_speed", "rad/s", "mean angular speed of the pins between the driving sheaves", "", one, element<&O::pin_speed, 0>},
    {"shaft_2/pin_speed", "rad/s", "mean angular speed of the pins between the driven sheaves", "", one, element<&O::pin_speed, 1>},
    {"shaft_1/sheave_position", "m", "axial position of the movable driving sheave on its shaft", "", one, element<&O::sheave_position, 0>},
    {"shaft_2/sheave_position", "m", "axial position of the movable driven sheave on its shaft", "", one, element<&O::sheave_position, 1>},
    {"sheaves/axial_force", "N", "axial force of all tips on sheaves 1-, 1+, 2-, 2+", "sheave", four, list<&O::axial_force>},
    {"ratio", "1", "speed ratio: driving over driven", "", one, scalar<&O::ratio>},
    {"slip", "1",
     "creep of the contacts on both pulleys: 1 - (pins/shaft on the driving side) (shaft/pins on the driven side), angular speeds", "", one,
     scalar<&O::slip>},
    {"efficiency", "1", "1 - losses/input over the last whole pin period (input: works of those inputs that brought energy)", "", one,
     efficiency},
    {"thrust_ratio", "1", "S_1/S_2", "", one, thrust_ratio},
    {"chain_speed", "m/s", "mean speed of the pins along the chain", "", one, scalar<&O::chain_speed>, false},
    {"tight_tension", "N", "mean plate tension of the strand that the driving sheaves pull (ring: of all links)", "", one,
     scalar<&O::tight>, false},
    {"slack_tension", "N", "mean plate tension of the other strand (ring: of all links)", "", one, scalar<&O::slack>, false},
    {"links/tension", "N", "elastic tension of the plates of every link", "link", per_link, list<&O::tension>, false},
    {"tips/axial_force", "N", "axial force of every tip on its sheave; tip = 4 link + 2 (front half) + (side +z)", "tip", per_tip,
     list<&O::tip_axial>},
    {"tips/touching", "1", "number of tips that touch a sheave", "", one, touching},
    {"tips/deepest", "m", "largest penetration of a tip", "", one, scalar<&O::deepest>},
    {"followed_pin/axial_force", "N", "axial force of the followed pin on sheaves at -z and +z", "side", two, followed_axial},
    {"followed_pin/position", "m", "x, y, z of the followed pin's rear half", "axis", three, followed_position, false},
    {"followed_pin/tension", "N", "tension of the link behind the followed pin", "", one, followed_tension, false},
    {"energy/kinetic", "J", "kinetic energy of chain, shafts and sheaves", "", one, energy<0>, false},
    {"energy/inner", "J", "elastic energy inside pin halves", "", one, energy<1>, false},
    {"energy/pack", "J", "elastic energy of plate packs in bending, shear and torsion", "", one, energy<2>, false},
    {"energy/plates", "J", "elastic energy of plates in tension", "", one, energy<3>, false},
    {"energy/joints", "J", "elastic energy of joints", "", one, energy<4>, false},
    {"energy/tips", "J", "elastic energy of tip contacts", "", one, energy<5>},
    {"energy/supports", "J", "elastic energy of bearings and sheave attachments", "", one, energy<6>},
    {"loss/inner", "W", "power dissipated inside pin halves and plate packs", "", one, loss<0>, false},
    {"loss/plate_damping", "W", "power dissipated by damping of plates", "", one, loss<1>, false},
    {"loss/plate_friction", "W", "power dissipated by friction of plates on pins", "", one, loss<2>, false},
    {"loss/joint_damping", "W", "power dissipated by damping of joints", "", one, loss<3>, false},
    {"loss/joint_friction", "W", "power dissipated by friction in joints", "", one, loss<4>, false},
    {"loss/tip_damping", "W", "power dissipated by damping of tip contacts", "", one, loss<5>},
    {"loss/tip_friction", "W", "power dissipated by friction of tips on sheaves", "", one, loss<6>},
    {"loss/supports", "W", "power dissipated in bearings and sheave attachments", "", one, loss<7>},
    {"loss/cylinder", "W", "power dissipated in the hydraulic cylinders", "", one, loss<8>},
    {"power/drive", "W", "power of the drive", "", one, work<0>},
    {"power/load", "W", "power of the load (negative: taken out)", "", one, work<1>},
    {"power/clamping", "W", "power of the clamping forces", "", one, work<2>},
    {"dissipated/inner", "J", "energy dissipated inside pin halves and plate packs so far", "", one, dissipated<0>, false},
    {"dissipated/plate_damping", "J", "energy dissipated by damping of plates so far", "", one, dissipated<1>, false},
    {"dissipated/plate_friction", "J", "energy dissipated by friction of plates on pins so far", "", one, dissipated<2>, false},
    {"dissipated/joint_damping", "J", "energy dissipated by damping of joints so far", "", one, dissipated<3>, false},
    {"dissipated/joint_friction", "J", "energy dissipated by friction in joints so far", "", one, dissipated<4>, false},
    {"dissipated/tip_damping", "J", "energy dissipated by damping of tip contacts so far", "", one, dissipated<5>},
    {"dissipated/tip_friction", "J", "energy dissipated by friction of tips on sheaves so far", "", one, dissipated<6>},
    {"dissipated/supports", "J", "energy dissipated in bearings and sheave attachments so far", "", one, dissipated<7>},
    {"dissipated/cylinder", "J", "energy dissipated in the hydraulic cylinders so far", "", one, dissipated<8>},
    {"dissipated/total", "J", "energy dissipated so far", "", one, dissipated_total, false},
    {"work/drive", "J", "work of the drive so far", "", one, done<0>},
    {"work/load", "J", "work of the load so far (negative: taken out)", "", one, done<1>},
    {"work/clamping", "J", "work of the clamping forces so far", "", one, done<2>},
    {"control/limited", "1", "1 while a controller asks for more than its authority", "", one, control_limited},
    {"balance/residual", "1", "|change of stored energy - work + losses| over the losses so far", "", one, residual, false},
    {"balance/suspicion", "1", "residual over what an honest integration may leave; above 1 the results are unreliable", "", one, suspicion,
     false},
    {"run/steps", "1", "steps so far", "", one, count<&Counters::steps>, false},
    {"run/evaluations", "1", "evaluations of the right-hand side so far", "", one, count<&Counters::evaluations>, false},
    {"run/transitions", "1", "transitions of phase so far", "", one, count<&Counters::detected>, false},
    {"run/truncated", "1", "steps cut at a transition so far", "", one, count<&Counters::truncated>, false},
    {"run/suppressed", "1", "transitions put off because the tip had just changed", "", one, count<&Counters::suppressed>, false},
};

}  // namespace

std::string_view loss_name(int kind) noexcept { return losses[kind]; }
std::string_view work_name(int kind) noexcept { return works[kind]; }
std::string_view energy_name(int kind) noexcept { return energies[kind]; }

std::span<const Channel> channels() {
    static const std::vector<Channel> all = [] {
        std::vector<Channel> rows(std::begin(table), std::end(table));
        rows.insert(rows.end(), force_channels().begin(), force_channels().end());
        return rows;
    }();
    return all;
}

namespace {

/// Whether a name of record.channels means a channel: its own, or "group/*".
bool means(std::string_view name, const Channel& channel) {
    const bool group = name.ends_with("/*");
    return group ? channel.name.starts_with(name.substr(0, name.size() - 1)) : channel.name == name;
}

}  // namespace

std::vector<const Channel*> chosen_channels(std::span<const std::string> names, const model::ChainLayout& layout) {
    std::vector<const Channel*> chosen;
    for (const Channel& channel : channels()) {
        const bool wanted =
            channel.usual || std::any_of(names.begin(), names.end(), [&](const std::string& name) { return means(name, channel); });
        if (wanted && (!channel.needs_pulleys || layout.pulley_size != 0)) chosen.push_back(&channel);
    }
    return chosen;
}

std::vector<std::string> channel_names() {
    std::vector<std::string> names;
    for (const Channel& channel : channels()) names.emplace_back(channel.name);
    return names;
}

std::vector<std::string> unknown_channels(std::span<const std::string> names) {
    std::vector<std::string> unknown;
    for (const std::string& name : names) {
        const auto all = channels();
        if (std::none_of(all.begin(), all.end(), [&](const Channel& channel) { return means(name, channel); })) unknown.push_back(name);
    }
    return unknown;
}

}  // namespace cvtflow::tasks
