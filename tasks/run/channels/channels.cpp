#include "tasks/run/channels/channels.hpp"

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

/// Of the instant where no output lies before it.
void efficiency(const Instant& now, double* out) {
    *out = now.workspace.energy.efficiency(now.observation.time);
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
void followed_position(const Instant& now, double* out) {
    const ChainLayout& at = now.workspace.layout();
    const double* block = now.workspace.states[0] + at.link_begin(now.followed_pin);
    out[0] = block[at.x(model::End::rear, 0)];
    out[1] = block[at.y(model::End::rear, 0)];
    out[2] = block[at.z(model::End::rear)];
}
void followed_tension(const Instant& now, double* out) { *out = now.observation.tension[static_cast<std::size_t>(now.followed_pin)]; }
void touching(const Instant& now, double* out) { *out = now.observation.touching; }

using O = Observation;
const Channel table[] = {
    {.name = "shaft_1/speed", .unit = "rad/s", .description = "speed of the driving shaft", .read = element(&O::speed, 0)},
    {.name = "shaft_2/speed", .unit = "rad/s", .description = "speed of the driven shaft", .read = element(&O::speed, 1)},
    {.name = "shaft_1/angle", .unit = "rad", .description = "angle of the driving shaft", .read = element(&O::angle, 0)},
    {.name = "shaft_2/angle", .unit = "rad", .description = "angle of the driven shaft", .read = element(&O::angle, 1)},
    {.name = "shaft_1/torque", .unit = "N*m", .description = "torque of the drive on the driving shaft", .read = element(&O::torque, 0)},
    {.name = "shaft_2/torque",
     .unit = "N*m",
     .description = "torque of the load on the driven shaft (negative brakes)",
     .read = element(&O::torque, 1)},
    {.name = "shaft_1/chain_torque",
     .unit = "N*m",
     .description = "torque of the chain on the driving sheaves, mean since the last output (their change of momentum)",
     .read = chain_torque(0)},
    {.name = "shaft_2/chain_torque",
     .unit = "N*m",
     .description = "torque of the chain on the driven sheaves, mean since the last output (their change of momentum)",
     .read = chain_torque(1)},
    {.name = "shaft_1/clamping", .unit = "N", .description = "clamping force S_1 of the driving sheaves", .read = element(&O::clamping, 0)},
    {.name = "shaft_2/clamping", .unit = "N", .description = "clamping force S_2 of the driven sheaves", .read = element(&O::clamping, 1)},
    {.name = "shaft_1/radius",
     .unit = "m",
     .description = "mean running radius of the pins between the driving sheaves",
     .read = element(&O::radius, 0)},
    {.name = "shaft_2/radius",
     .unit = "m",
     .description = "mean running radius of the pins between the driven sheaves",
     .read = element(&O::radius, 1)},
    {.name = "shaft_1/pin_speed",
     .unit = "rad/s",
     .description = "mean angular speed of the pins between the driving sheaves",
     .read = element(&O::pin_speed, 0)},
    {.name = "shaft_2/pin_speed",
     .unit = "rad/s",
     .description = "mean angular speed of the pins between the driven sheaves",
     .read = element(&O::pin_speed, 1)},
    {.name = "shaft_1/sheave_position",
     .unit = "m",
     .description = "axial position of the movable driving sheave on its shaft",
     .read = element(&O::sheave_position, 0)},
    {.name = "shaft_2/sheave_position",
     .unit = "m",
     .description = "axial position of the movable driven sheave on its shaft",
     .read = element(&O::sheave_position, 1)},
    {.name = "sheaves/axial_force",
     .unit = "N",
     .description = "axial force of all tips on sheaves 1-, 1+, 2-, 2+",
     .axis = "sheave",
     .width = Channel::always(4),
     .read = list(&O::axial_force)},
    {.name = "ratio", .unit = "1", .description = "speed ratio: driving over driven", .read = scalar(&O::ratio)},
    {.name = "slip",
     .unit = "1",
     .description =
         "creep of the contacts on both pulleys: 1 - (pins/shaft on the driving side) (shaft/pins on the driven side), angular speeds",
     .read = scalar(&O::slip)},
    {.name = "friction_slip",
     .unit = "1",
     .description = "slip that friction makes: against the speeds of shafts on which it would put no torque; zero without torque, of its "
                    "sign",
     .read = scalar(&O::friction_slip)},
    {.name = "loss_slip",
     .unit = "1",
     .description = "power lost by tips that slide along the circumference over the power of those shafts that bring any; never negative",
     .read = scalar(&O::loss_slip)},
    {.name = "efficiency",
     .unit = "1",
     .description = "1 - losses/input over the last whole pin period (input: works of those inputs that brought energy); NaN without input",
     .read = efficiency,
     .may_be_undefined = true},
    {.name = "thrust_ratio", .unit = "1", .description = "S_1/S_2; NaN without S_2", .read = thrust_ratio, .may_be_undefined = true},
    {.name = "chain_speed",
     .unit = "m/s",
     .description = "mean speed of the pins along the chain",
     .read = scalar(&O::chain_speed),
     .needs_pulleys = false},
    {.name = "tight_tension",
     .unit = "N",
     .description = "mean plate tension of the strand that the driving sheaves pull (ring: of all links)",
     .read = scalar(&O::tight),
     .needs_pulleys = false},
    {.name = "slack_tension",
     .unit = "N",
     .description = "mean plate tension of the other strand (ring: of all links)",
     .read = scalar(&O::slack),
     .needs_pulleys = false},
    {.name = "links/tension",
     .unit = "N",
     .description = "elastic tension of the plates of every link",
     .axis = "link",
     .width = per_link,
     .read = list(&O::tension),
     .needs_pulleys = false},
    {.name = "tips/axial_force",
     .unit = "N",
     .description = "axial force of every tip on its sheave; tip = 4 link + 2 (front half) + (side +z)",
     .axis = "tip",
     .width = per_tip,
     .read = list(&O::tip_axial)},
    {.name = "tips/touching", .unit = "1", .description = "number of tips that touch a sheave", .read = touching},
    {.name = "tips/deepest", .unit = "m", .description = "largest penetration of a tip", .read = scalar(&O::deepest)},
    {.name = "followed_pin/axial_force",
     .unit = "N",
     .description = "axial force of the followed pin on sheaves at -z and +z",
     .axis = "side",
     .width = Channel::always(2),
     .read = followed_axial},
    {.name = "followed_pin/position",
     .unit = "m",
     .description = "x, y, z of the followed pin's rear half",
     .axis = "axis",
     .width = Channel::always(3),
     .read = followed_position,
     .needs_pulleys = false},
    {.name = "followed_pin/tension",
     .unit = "N",
     .description = "tension of the link behind the followed pin",
     .read = followed_tension,
     .needs_pulleys = false},
};

}  // namespace

double Instant::chain_torque(std::size_t shaft) const noexcept {
    const double mean = workspace.energy.chain_torque(observation.time, workspace.shaft_momentum())[shaft];
    return std::isfinite(mean) ? mean : observation.chain_torque[shaft];
}

std::span<const Channel> channels() {
    static const std::vector<Channel> all = [] {
        std::vector<Channel> rows(std::begin(table), std::end(table));
        for (const auto more : {energy_channels(), force_channels(), coupling_channels(), hydraulic_channels(), wear_channels()})
            rows.insert(rows.end(), more.begin(), more.end());
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
        const bool wanted = channel.usual || (channel.of_hydraulics && layout.hydraulic()) ||
                            std::any_of(names.begin(), names.end(), [&](const std::string& name) { return means(name, channel); });
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
