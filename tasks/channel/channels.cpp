#include "tasks/channel/channels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/text.hpp"

namespace cvtflow::tasks {

namespace {

using model::ChainLayout;
using model::ChainModel;
using model::Energy;
using model::Loss;
using model::Observation;
using model::Work;

int per_link(const ChainModel& chain) { return chain.layout().links; }
int per_tip(const ChainModel& chain) { return model::tips_per_link * chain.layout().links; }

/// A member of the observation that is a number; the element of one that has two; all elements.
double scalar(const Instant& now, double Observation::*member) { return now.observation.*member; }
double element(const Instant& now, std::array<double, 2> Observation::*member, std::size_t index) {
    return (now.observation.*member)[index];
}
template <auto member>
void list(const Instant& now, double* out) {
    std::ranges::copy(now.observation.*member, out);
}

/// Efficiency over the last pin period, or of the instant where no output lies before it.
double efficiency(const Instant& now) {
    const EnergyLedger& energy = now.workspace.energy;
    if (const auto before = energy.sums_before(now.observation.time)) return energy.sums(now.observation.time).since(*before).efficiency();
    EnergySums powers;
    powers.loss = now.observation.account.loss;
    powers.work = now.observation.work;
    return powers.since({}).efficiency();
}
/// A share: none where tips lose more than shafts bring.
double loss_slip(const Instant& now) {
    const double share = now.observation.loss_slip;
    return share <= 1.0 ? share : std::numeric_limits<double>::quiet_NaN();
}
double chain_torque(const Instant& now, std::size_t shaft) { return now.chain_torque(shaft); }
double thrust_ratio(const Instant& now) {
    const Observation& o = now.observation;
    return o.clamping[1] != 0.0 ? o.clamping[0] / o.clamping[1] : std::numeric_limits<double>::quiet_NaN();
}

/// Tips of the followed pin: of its rear half on its link and of its front half on the link before.
void followed_axial(const Instant& now, double* out) {
    const int links = now.workspace.layout().links;
    const int before = (now.followed_pin + links - 1) % links;
    const auto& tips = now.observation.tip_axial;
    const auto force = [&](int link, int end, int side) {
        return tips[static_cast<std::size_t>(model::tips_per_link * link + 2 * end + side)];
    };
    for (int side = 0; side < 2; ++side) out[side] = force(now.followed_pin, 0, side) + force(before, 1, side);
}
void followed_position(const Instant& now, double* out) { std::ranges::copy(now.workspace.rear_half(now.followed_pin), out); }
double followed_tension(const Instant& now) { return now.observation.tension[static_cast<std::size_t>(now.followed_pin)]; }
double touching(const Instant& now) { return now.observation.touching; }

constexpr std::string_view losses[] = {"inner",       "plate_damping", "plate_friction", "joint_damping", "joint_friction",
                                       "tip_damping", "tip_friction",  "supports",       "cylinder",      "guide"};
constexpr std::string_view works[] = {"drive", "load", "clamping"};
constexpr std::string_view energies[] = {"kinetic", "inner", "pack", "plates", "joints", "tips", "supports"};

double loss(const Instant& now, Loss kind) { return now.observation.account[kind]; }
double energy(const Instant& now, Energy kind) { return now.observation.account[kind]; }
double work(const Instant& now, Work kind) { return now.observation.work[static_cast<std::size_t>(kind)]; }

/// Sums of works and losses up to the instant.
[[nodiscard]] EnergySums sums(const Instant& now) { return now.workspace.energy.sums(now.observation.time); }

double dissipated(const Instant& now, Loss kind) { return sums(now).loss[static_cast<std::size_t>(kind)]; }
double dissipated_total(const Instant& now) { return sums(now).lost(); }
double done(const Instant& now, Work kind) { return sums(now).work[static_cast<std::size_t>(kind)]; }
double residual(const Instant& now) { return now.workspace.energy.balance().relative(); }
double balance_error_ratio(const Instant& now) { return now.workspace.energy.balance_error_ratio(); }
double control_target(const Instant& now) { return now.observation.control.target; }
double control_error(const Instant& now) { return now.observation.control.value - now.observation.control.target; }
double control_limited(const Instant& now) { return now.observation.control_limited ? 1.0 : 0.0; }
double count(const Instant& now, long Counters::*member) { return static_cast<double>(now.counters.*member); }

using enum Channel::Trait;
using Read = Channel::Read;
using O = Observation;
const Channel table[] = {
    {"shaft_1/speed", "rad/s", "speed of the driving shaft", Read(element, &O::speed, 0), without_chain},
    {"shaft_2/speed", "rad/s", "speed of the driven shaft", Read(element, &O::speed, 1), without_chain},
    {"shaft_1/angle", "rad", "angle of the driving shaft", Read(element, &O::angle, 0), so_far},
    {"shaft_2/angle", "rad", "angle of the driven shaft", Read(element, &O::angle, 1), so_far},
    {"shaft_1/torque", "N*m", "torque of the drive on the driving shaft", Read(element, &O::torque, 0), without_chain},
    {"shaft_2/torque", "N*m", "torque of the load on the driven shaft (negative brakes)", Read(element, &O::torque, 1), without_chain},
    {"shaft_1/chain_torque", "N*m", "torque of the chain on the driving sheaves, mean since the last output (their change of momentum)",
     Read(chain_torque, 0), so_far},
    {"shaft_2/chain_torque", "N*m", "torque of the chain on the driven sheaves, mean since the last output (their change of momentum)",
     Read(chain_torque, 1), so_far},
    {"shaft_1/clamping", "N", "clamping force S_1 of the driving sheaves", Read(element, &O::clamping, 0), without_chain},
    {"shaft_2/clamping", "N", "clamping force S_2 of the driven sheaves", Read(element, &O::clamping, 1), without_chain},
    {"shaft_1/radius", "m", "mean running radius of the pins between the driving sheaves", Read(element, &O::radius, 0)},
    {"shaft_2/radius", "m", "mean running radius of the pins between the driven sheaves", Read(element, &O::radius, 1)},
    {"shaft_1/pin_speed", "rad/s", "mean angular speed of the pins between the driving sheaves", Read(element, &O::pin_speed, 0)},
    {"shaft_2/pin_speed", "rad/s", "mean angular speed of the pins between the driven sheaves", Read(element, &O::pin_speed, 1)},
    {"shaft_1/sheave_position", "m", "axial position of the movable driving sheave on its shaft", Read(element, &O::sheave_position, 0),
     without_chain},
    {"shaft_2/sheave_position", "m", "axial position of the movable driven sheave on its shaft", Read(element, &O::sheave_position, 1),
     without_chain},
    {"sheaves/axial_force", "N", "axial force of all tips on sheaves 1-, 1+, 2-, 2+", list<&O::axial_force>, usual, "sheave",
     Channel::always(4)},
    {"ratio", "1", "speed ratio: driving over driven; its mean is the quotient of the angles", Read(scalar, &O::ratio), without_chain},
    {"slip", "1",
     "creep of the contacts on both pulleys: 1 - (pins/shaft on the driving side) (shaft/pins on the driven side), angular speeds",
     Read(scalar, &O::slip)},
    {"friction_slip", "1",
     "slip that friction makes: against the speeds of shafts on which it would put no torque; zero without torque, of its sign",
     Read(scalar, &O::friction_slip)},
    {"loss_slip", "1",
     "of an instant: power lost by tips that slide along the circumference over the power of those shafts that bring any; NaN where it is "
     "more",
     loss_slip, may_be_undefined},
    {"efficiency", "1",
     "of an instant: 1 - losses/input over the last whole pin period (input: works of those inputs that brought energy); NaN where no "
     "energy "
     "flows; its mean is the quotient of the energies",
     efficiency, may_be_undefined | unaveraged},
    {"thrust_ratio", "1", "S_1/S_2; NaN without S_2", thrust_ratio, may_be_undefined | without_chain},
    {"chain_speed", "m/s", "mean speed of the pins along the chain", Read(scalar, &O::chain_speed), any_machine},
    {"tight_tension", "N", "mean plate tension of the strand that the driving sheaves pull (ring: of all links)", Read(scalar, &O::tight),
     any_machine},
    {"slack_tension", "N", "mean plate tension of the other strand (ring: of all links)", Read(scalar, &O::slack), any_machine},
    {"links/tension", "N", "elastic tension of the plates of every link", list<&O::tension>, any_machine, "link", per_link},
    {"tips/axial_force", "N", "axial force of every tip on its sheave; tip = 4 link + 2 (front half) + (side +z)", list<&O::tip_axial>,
     usual, "tip", per_tip},
    {"tips/touching", "1", "number of tips that touch a sheave", touching},
    {"tips/deepest", "m", "largest penetration of a tip", Read(scalar, &O::deepest)},
    {"followed_pin/axial_force", "N", "axial force of the followed pin on sheaves at -z and +z", followed_axial, usual, "side",
     Channel::always(2)},
    {"followed_pin/position", "m", "x, y, z of the followed pin's rear half", followed_position, any_machine | so_far, "axis",
     Channel::always(3)},
    {"followed_pin/tension", "N", "tension of the link behind the followed pin", followed_tension, any_machine},

    // Energies, losses and works, of an instant and so far; whether their balance closes; counts of the run.
    {"energy/kinetic", "J", "kinetic energy of chain, shafts and sheaves", Read(energy, Energy::kinetic), any_machine | unaveraged},
    {"energy/inner", "J", "elastic energy inside pin halves", Read(energy, Energy::inner), any_machine | unaveraged},
    {"energy/pack", "J", "elastic energy of plate packs in bending, shear and torsion", Read(energy, Energy::pack),
     any_machine | unaveraged},
    {"energy/plates", "J", "elastic energy of plates in tension", Read(energy, Energy::plates), any_machine | unaveraged},
    {"energy/joints", "J", "elastic energy of joints", Read(energy, Energy::joints), any_machine | unaveraged},
    {"energy/tips", "J", "elastic energy of tip contacts", Read(energy, Energy::tips), unaveraged},
    {"energy/supports", "J", "elastic energy of bearings, sheave attachments and guides", Read(energy, Energy::supports), unaveraged},
    {"loss/inner", "W", "power dissipated inside pin halves and plate packs", Read(loss, Loss::inner), any_machine},
    {"loss/plate_damping", "W", "power dissipated by damping of plates", Read(loss, Loss::plate_damping), any_machine},
    {"loss/plate_friction", "W", "power dissipated by friction of plates on pins", Read(loss, Loss::plate_friction), any_machine},
    {"loss/joint_damping", "W", "power dissipated by damping of joints", Read(loss, Loss::joint_damping), any_machine},
    {"loss/joint_friction", "W", "power dissipated by friction in joints", Read(loss, Loss::joint_friction), any_machine},
    {"loss/tip_damping", "W", "power dissipated by damping of tip contacts", Read(loss, Loss::tip_damping)},
    {"loss/tip_friction", "W", "power dissipated by friction of tips on sheaves", Read(loss, Loss::tip_friction)},
    {"loss/supports", "W", "power dissipated in bearings and sheave attachments", Read(loss, Loss::supports)},
    {"loss/cylinder", "W", "power dissipated in the hydraulic cylinders", Read(loss, Loss::cylinder)},
    {"loss/guide", "W", "power dissipated by the guides of the strands", Read(loss, Loss::guide), of_guide},
    {"power/drive", "W", "power of the drive on shaft 1, behind its drag", Read(work, Work::drive), without_chain},
    {"power/load", "W", "power of the load on shaft 2, before its drag (negative: taken out)", Read(work, Work::load), without_chain},
    {"power/clamping", "W", "power of the clamping forces", Read(work, Work::clamping), without_chain},
    {"dissipated/inner", "J", "energy dissipated inside pin halves and plate packs so far", Read(dissipated, Loss::inner),
     any_machine | so_far},
    {"dissipated/plate_damping", "J", "energy dissipated by damping of plates so far", Read(dissipated, Loss::plate_damping),
     any_machine | so_far},
    {"dissipated/plate_friction", "J", "energy dissipated by friction of plates on pins so far", Read(dissipated, Loss::plate_friction),
     any_machine | so_far},
    {"dissipated/joint_damping", "J", "energy dissipated by damping of joints so far", Read(dissipated, Loss::joint_damping),
     any_machine | so_far},
    {"dissipated/joint_friction", "J", "energy dissipated by friction in joints so far", Read(dissipated, Loss::joint_friction),
     any_machine | so_far},
    {"dissipated/tip_damping", "J", "energy dissipated by damping of tip contacts so far", Read(dissipated, Loss::tip_damping), so_far},
    {"dissipated/tip_friction", "J", "energy dissipated by friction of tips on sheaves so far", Read(dissipated, Loss::tip_friction),
     so_far},
    {"dissipated/supports", "J", "energy dissipated in bearings and sheave attachments so far", Read(dissipated, Loss::supports), so_far},
    {"dissipated/cylinder", "J", "energy dissipated in the hydraulic cylinders so far", Read(dissipated, Loss::cylinder), so_far},
    {"dissipated/guide", "J", "energy dissipated by the guides of the strands so far", Read(dissipated, Loss::guide), of_guide | so_far},
    {"dissipated/total", "J", "energy dissipated so far", dissipated_total, any_machine | so_far},
    {"work/drive", "J", "work of the drive so far", Read(done, Work::drive), so_far},
    {"work/load", "J", "work of the load so far (negative: taken out)", Read(done, Work::load), so_far},
    {"work/clamping", "J", "work of the clamping forces so far", Read(done, Work::clamping), so_far},
    {"control/limited", "1", "1 while a controller is at the limit of its authority", control_limited, without_chain},
    {"control/target", "1", "target of the first controller: ratio, slip by the sheaves' positions, or safety factor", control_target,
     of_control},
    {"control/error", "1", "deviation from that target", control_error, of_control},
    {"balance/residual", "1", "|change of stored energy - work + losses| over the losses so far", residual, any_machine | so_far},
    {"balance/error_ratio", "1", "residual of the energy balance over its tolerance; above 1 the results are unreliable",
     balance_error_ratio, any_machine | so_far},
    {"run/steps", "1", "steps so far", Read(count, &Counters::steps), any_machine | so_far},
    {"run/evaluations", "1", "evaluations of the right-hand side so far", Read(count, &Counters::evaluations), any_machine | so_far},
    {"run/transitions", "1", "transitions of phase so far", Read(count, &Counters::detected), any_machine | so_far},
    {"run/truncated", "1", "steps cut at a transition so far", Read(count, &Counters::truncated), any_machine | so_far},
    {"run/suppressed", "1", "transitions postponed because the tip had just changed", Read(count, &Counters::suppressed),
     any_machine | so_far},
};

}  // namespace

std::string_view loss_name(int kind) noexcept { return losses[kind]; }
std::string_view work_name(int kind) noexcept { return works[kind]; }
std::string_view energy_name(int kind) noexcept { return energies[kind]; }

double Instant::chain_torque(std::size_t shaft) const noexcept {
    const double mean = workspace.energy.chain_torque(observation.time, shaft_momentum(workspace))[shaft];
    return std::isfinite(mean) ? mean : observation.chain_torque[shaft];
}

std::span<const Channel> channels() {
    static const std::vector<Channel> all = [] {
        std::vector<Channel> rows(std::begin(table), std::end(table));
        rows.insert(rows.end(), further_channels().begin(), further_channels().end());
        return rows;
    }();
    return all;
}

namespace {

/// The sums of a quotient at an instant.
void read_sums(const Instant& now, double* out, const QuotientChannels* of) {
    for (const auto& names : of->sums) {
        *out = 0.0;
        for (const Channel& channel : channels()) {
            double part = 0.0;
            if (std::ranges::find(names, channel.name) == names.end()) continue;
            channel.read(now, &part);
            *out += part;
        }
        ++out;
    }
}

}  // namespace

std::span<const QuotientChannels> quotient_channels() {
    static const std::vector<std::string_view> lost{"dissipated/total"},
        oil{"hydraulics/mechanical", "hydraulics/volumetric", "hydraulics/relief", "hydraulics/valves", "hydraulics/leaked"},
        drag{"dissipated/shaft_1_drag", "dissipated/shaft_2_drag"};
    static const auto with = [](std::vector<std::string_view> names, const std::vector<std::string_view>& more) {
        names.insert(names.end(), more.begin(), more.end());
        return names;
    };
    static const QuotientChannels rows[] = {
        {"efficiency", {lost, {}, {"work/clamping"}, {"work/drive"}, {"work/load"}}},
        {"efficiency_with_pump", {with(lost, oil), {"hydraulics/pump"}, {"work/clamping"}, {"work/drive"}, {"work/load"}}},
        {"overall_efficiency",
         {with(with(lost, oil), drag), {"hydraulics/pump"}, {"work/clamping"}, {"work/drive", drag[0]}, {"work/load", drag[1]}}},
        {"ratio", {{"shaft_1/angle"}, {"shaft_2/angle"}}}};
    return rows;
}

const QuotientChannels* quotient_channels_of(std::string_view name) {
    const auto all = quotient_channels();
    const auto found = std::ranges::find(all, name, &QuotientChannels::name);
    return found == all.end() ? nullptr : &*found;
}

double quotient_of(std::span<const double> changes) noexcept {
    if (changes.size() == 2) return changes[0] / changes[1];
    return EnergyFlow{changes[0], changes[2], {changes[3], changes[4]}}.with_pump(changes[1], 0.0).efficiency();  // its losses are counted
}

const Channel* Channel::sums() const {
    static const std::vector<Channel> all = [] {
        std::vector<Channel> rows;
        for (const QuotientChannels& of : quotient_channels())
            rows.push_back({of.name, "", "its sums so far", Read(read_sums, &of), so_far, "sum", always(static_cast<int>(of.sums.size()))});
        return rows;
    }();
    const auto found = std::ranges::find(all, name, &Channel::name);
    return found != all.end() ? &*found : nullptr;
}

const Channel* Channel::integral() const {
    constexpr std::pair<std::string_view, std::string_view> pairs[] = {{"shaft_1/speed", "shaft_1/angle"},
                                                                       {"shaft_2/speed", "shaft_2/angle"},
                                                                       {"shaft_1/torque", "shaft_1/impulse"},
                                                                       {"shaft_2/torque", "shaft_2/impulse"},
                                                                       {"shaft_1/chain_torque", "shaft_1/chain_impulse"},
                                                                       {"shaft_2/chain_torque", "shaft_2/chain_impulse"},
                                                                       {"pump/power", "hydraulics/pump"},
                                                                       {"loss/pump_friction", "hydraulics/mechanical"},
                                                                       {"loss/pump_leakage", "hydraulics/volumetric"},
                                                                       {"loss/relief", "hydraulics/relief"},
                                                                       {"loss/valves", "hydraulics/valves"},
                                                                       {"loss/oil_leakage", "hydraulics/leaked"},
                                                                       {"loss/", "dissipated/"},
                                                                       {"power/", "work/"}};
    for (const auto& [of, integral] : pairs) {
        const bool group = of.ends_with('/');
        if (group ? !name.starts_with(of) : name != of) continue;
        const std::string sought = std::string(integral) + std::string(group ? name.substr(of.size()) : "");
        const auto found = std::ranges::find(tasks::channels(), sought, &Channel::name);
        return found != tasks::channels().end() ? &*found : nullptr;
    }
    return nullptr;
}

namespace {

/// Whether a name of record.channels means a channel: by its name, or by "group/*".
bool means(std::string_view name, const Channel& channel) {
    const bool group = name.ends_with("/*");
    return group ? channel.name.starts_with(name.substr(0, name.size() - 1)) : channel.name == name;
}

}  // namespace

std::vector<const Channel*> chosen_channels(std::span<const std::string> names, const model::Parameters& machine) {
    const ChainLayout layout = model::layout_of(machine);
    std::vector<const Channel*> chosen;
    const bool controlled = layout.controls > (layout.hydraulic() ? model::hydraulic_unknowns : 0);
    for (const Channel& channel : channels()) {
        const bool chosen_here = !channel.is(Channel::on_demand) || (channel.is(Channel::of_hydraulics) && layout.hydraulic()) ||
                                 (channel.is(Channel::of_drag) && machine.drag.present()) ||
                                 (channel.is(Channel::of_guide) && machine.guide.present()) ||
                                 (channel.is(Channel::of_control) && controlled) ||
                                 std::any_of(names.begin(), names.end(), [&](const std::string& name) { return means(name, channel); });
        if (chosen_here && (channel.is(Channel::any_machine) || layout.pulley_size != 0)) chosen.push_back(&channel);
    }
    return chosen;
}

std::vector<std::string> unknown_channels(std::span<const std::string> names) {
    std::vector<std::string> unknown;
    for (const std::string& name : names)
        if (std::ranges::none_of(channels(), [&](const Channel& channel) { return means(name, channel); })) unknown.push_back(name);
    return unknown;
}

std::string channel_hint(std::string_view unknown) {
    if (unknown == "balance/suspicion") return " (named balance/error_ratio since 1.0)";
    std::vector<std::string> names;
    for (const Channel& channel : channels()) names.emplace_back(channel.name);
    return engine::did_you_mean(engine::closest(unknown, names));
}

}  // namespace cvtflow::tasks
