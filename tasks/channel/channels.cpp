#include "tasks/channel/channels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cvtflow::tasks {

namespace {

using model::ChainLayout;
using model::ChainModel;
using model::Observation;

int per_link(const ChainModel& chain) { return chain.layout().links; }
int per_tip(const ChainModel& chain) { return model::tips_per_link * chain.layout().links; }

/// A member of the observation that is a number.
Channel::Read scalar(double Observation::*member) {
    return [member](const Instant& now, double* out) { *out = now.observation.*member; };
}
/// A member that has an element for each shaft.
Channel::Read element(std::array<double, 2> Observation::*member, std::size_t index) {
    return [member, index](const Instant& now, double* out) { *out = (now.observation.*member)[index]; };
}
/// All elements of a member.
template <class List>
Channel::Read list(List Observation::*member) {
    return [member](const Instant& now, double* out) {
        const auto& values = now.observation.*member;
        std::copy(values.begin(), values.end(), out);
    };
}

/// Efficiency since the last output, or of the instant if there is none before.
void efficiency(const Instant& now, double* out) {
    const EnergyLedger& energy = now.workspace.energy;
    const std::optional<EnergySums> before = energy.sums_before(now.observation.time);
    *out = before ? energy.sums(now.observation.time).efficiency_since(*before) : std::numeric_limits<double>::quiet_NaN();
    if (std::isfinite(*out)) return;
    EnergySums powers;
    powers.loss = now.observation.account.loss;
    powers.work = now.observation.work;
    *out = powers.efficiency_since({});
}
Channel::Read chain_torque(std::size_t shaft) {
    return [shaft](const Instant& now, double* out) { *out = now.chain_torque(shaft); };
}
void thrust_ratio(const Instant& now, double* out) {
    const Observation& o = now.observation;
    *out = o.clamping[1] != 0.0 ? o.clamping[0] / o.clamping[1] : std::numeric_limits<double>::quiet_NaN();
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
void followed_position(const Instant& now, double* out) { std::ranges::copy(now.workspace.rear_half(now.followed_pin), out); }
void followed_tension(const Instant& now, double* out) { *out = now.observation.tension[static_cast<std::size_t>(now.followed_pin)]; }
void touching(const Instant& now, double* out) { *out = now.observation.touching; }

using enum Channel::Trait;
using O = Observation;
const Channel table[] = {
    {"shaft_1/speed", "rad/s", "speed of the driving shaft", element(&O::speed, 0), without_chain},
    {"shaft_2/speed", "rad/s", "speed of the driven shaft", element(&O::speed, 1), without_chain},
    {"shaft_1/angle", "rad", "angle of the driving shaft", element(&O::angle, 0), without_chain | unaveraged},
    {"shaft_2/angle", "rad", "angle of the driven shaft", element(&O::angle, 1), without_chain | unaveraged},
    {"shaft_1/torque", "N*m", "torque of the drive on the driving shaft", element(&O::torque, 0), without_chain},
    {"shaft_2/torque", "N*m", "torque of the load on the driven shaft (negative brakes)", element(&O::torque, 1), without_chain},
    {"shaft_1/chain_torque", "N*m", "torque of the chain on the driving sheaves, mean since the last output (their change of momentum)",
     chain_torque(0), without_chain | unaveraged},
    {"shaft_2/chain_torque", "N*m", "torque of the chain on the driven sheaves, mean since the last output (their change of momentum)",
     chain_torque(1), without_chain | unaveraged},
    {"shaft_1/clamping", "N", "clamping force S_1 of the driving sheaves", element(&O::clamping, 0), without_chain},
    {"shaft_2/clamping", "N", "clamping force S_2 of the driven sheaves", element(&O::clamping, 1), without_chain},
    {"shaft_1/radius", "m", "mean running radius of the pins between the driving sheaves", element(&O::radius, 0)},
    {"shaft_2/radius", "m", "mean running radius of the pins between the driven sheaves", element(&O::radius, 1)},
    {"shaft_1/pin_speed", "rad/s", "mean angular speed of the pins between the driving sheaves", element(&O::pin_speed, 0)},
    {"shaft_2/pin_speed", "rad/s", "mean angular speed of the pins between the driven sheaves", element(&O::pin_speed, 1)},
    {"shaft_1/sheave_position", "m", "axial position of the movable driving sheave on its shaft", element(&O::sheave_position, 0),
     without_chain},
    {"shaft_2/sheave_position", "m", "axial position of the movable driven sheave on its shaft", element(&O::sheave_position, 1),
     without_chain},
    {"sheaves/axial_force", "N", "axial force of all tips on sheaves 1-, 1+, 2-, 2+", list(&O::axial_force), usual, "sheave",
     Channel::always(4)},
    {"ratio", "1", "speed ratio: driving over driven", scalar(&O::ratio), without_chain},
    {"slip", "1",
     "creep of the contacts on both pulleys: 1 - (pins/shaft on the driving side) (shaft/pins on the driven side), angular speeds",
     scalar(&O::slip)},
    {"friction_slip", "1",
     "slip that friction makes: against the speeds of shafts on which it would put no torque; zero without torque, of its sign",
     scalar(&O::friction_slip)},
    {"loss_slip", "1",
     "power lost by tips that slide along the circumference over the power of those shafts that bring any; never negative",
     scalar(&O::loss_slip)},
    {"efficiency", "1",
     "1 - losses/input over the last whole pin period (input: works of those inputs that brought energy); NaN without input", efficiency,
     may_be_undefined | unaveraged},
    {"thrust_ratio", "1", "S_1/S_2; NaN without S_2", thrust_ratio, may_be_undefined | without_chain},
    {"chain_speed", "m/s", "mean speed of the pins along the chain", scalar(&O::chain_speed), any_machine},
    {"tight_tension", "N", "mean plate tension of the strand that the driving sheaves pull (ring: of all links)", scalar(&O::tight),
     any_machine},
    {"slack_tension", "N", "mean plate tension of the other strand (ring: of all links)", scalar(&O::slack), any_machine},
    {"links/tension", "N", "elastic tension of the plates of every link", list(&O::tension), any_machine, "link", per_link},
    {"tips/axial_force", "N", "axial force of every tip on its sheave; tip = 4 link + 2 (front half) + (side +z)", list(&O::tip_axial),
     usual, "tip", per_tip},
    {"tips/touching", "1", "number of tips that touch a sheave", touching},
    {"tips/deepest", "m", "largest penetration of a tip", scalar(&O::deepest)},
    {"followed_pin/axial_force", "N", "axial force of the followed pin on sheaves at -z and +z", followed_axial, usual, "side",
     Channel::always(2)},
    {"followed_pin/position", "m", "x, y, z of the followed pin's rear half", followed_position, any_machine | without_chain | unaveraged,
     "axis", Channel::always(3)},
    {"followed_pin/tension", "N", "tension of the link behind the followed pin", followed_tension, any_machine},
};

}  // namespace

double Instant::chain_torque(std::size_t shaft) const noexcept {
    const double mean = workspace.energy.chain_torque(observation.time, shaft_momentum(workspace))[shaft];
    return std::isfinite(mean) ? mean : observation.chain_torque[shaft];
}

std::span<const Channel> channels() {
    static const std::vector<Channel> all = [] {
        std::vector<Channel> rows(std::begin(table), std::end(table));
        for (const auto more :
             {energy_channels(), force_channels(), coupling_channels(), vehicle_channels(), hydraulic_channels(), wear_channels()})
            rows.insert(rows.end(), more.begin(), more.end());
        return rows;
    }();
    return all;
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

/// Whether a name of record.channels means a channel: its own, or "group/*".
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
