/// Loads of tips that wear comes from, on demand, over radii of the sheaves and tip by tip; and temperatures. (model/EQUATIONS.md sections
/// 9 and 12)

#include <algorithm>
#include <cmath>

#include "model/law/friction.hpp"
#include "tasks/run/channels/channels.hpp"

namespace cvtflow::tasks {

namespace {

using model::ChainForces;

int each_tip(const model::ChainModel& chain) { return model::tips_per_link * chain.layout().links; }

/// Hertz' largest pressure of a tip: p_c (N/K)^(1/3) [Pa].
[[nodiscard]] double pressure_of(const model::Parameters& p, double normal) {
    return model::pressure_per_root_depth(p) * std::cbrt(normal / p.tip.hertz);
}

/// Calls each(tip, cell, normal force, sliding speed) for every tip that presses.
template <class Each>
void for_cells(const Instant& now, const Each& each) {
    const ChainForces& f = now.observer.forces().chain;
    const model::Parameters& p = now.workspace.parameters;
    const model::ChainModel& chain = now.workspace.variator.chain();
    const double per_radius = wear_cells / (p.pulley.outermost - p.pulley.innermost);
    for (std::size_t tip = 0; tip < f.tip_normal.size(); ++tip) {
        if (f.tip_normal[tip] <= 0.0) continue;
        const int link = static_cast<int>(tip) / model::tips_per_link;
        const int shaft = chain.shaft_of(now.workspace.states[0] + chain.layout().link_begin(link));
        const int place = std::clamp(static_cast<int>((f.tip_radius[tip] - p.pulley.innermost) * per_radius), 0, wear_cells - 1);
        const int sheave = 2 * shaft + static_cast<int>(tip % 2);
        each(tip, static_cast<std::size_t>(wear_cells * sheave + place), f.tip_normal[tip], f.tip_sliding[tip]);
    }
}

void cell_power(const Instant& now, double* out) {
    std::fill_n(out, 4 * wear_cells, 0.0);
    const auto& power = now.observer.forces().chain.tip_power;
    for_cells(now, [&](std::size_t tip, std::size_t cell, double, double) { out[cell] += power[tip]; });
}

void cell_force_speed(const Instant& now, double* out) {
    std::fill_n(out, 4 * wear_cells, 0.0);
    for_cells(now, [&](std::size_t, std::size_t cell, double normal, double speed) { out[cell] += normal * speed; });
}

void cell_pressure_speed(const Instant& now, double* out) {
    std::fill_n(out, 4 * wear_cells, 0.0);
    for_cells(now, [&](std::size_t, std::size_t cell, double normal, double speed) {
        out[cell] = std::max(out[cell], pressure_of(now.workspace.parameters, normal) * speed);
    });
}

Channel::Read of_each(std::vector<double> ChainForces::*member) {
    return [member](const Instant& now, double* out) {
        const auto& values = now.observer.forces().chain.*member;
        std::copy(values.begin(), values.end(), out);
    };
}

void tip_pressure(const Instant& now, double* out) {
    const auto& normal = now.observer.forces().chain.tip_normal;
    std::transform(normal.begin(), normal.end(), out, [&](double n) { return pressure_of(now.workspace.parameters, n); });
}

void tip_force_speed(const Instant& now, double* out) {
    const ChainForces& f = now.observer.forces().chain;
    std::transform(f.tip_normal.begin(), f.tip_normal.end(), f.tip_sliding.begin(), out, std::multiplies<>());
}

void limit_use(const Instant& now, double* out) { *out = now.observation.limit_use; }

using Temperature = double (model::HeatBalance::*)() const noexcept;
Channel::Read heat(Temperature member) {
    return [member](const Instant& now, double* out) { *out = (now.workspace.heat.*member)(); };
}

const Channel table_of_wear[] = {
    {.name = "wear/friction_power",
     .unit = "W",
     .description = "friction of the tips by radius: 32 rings from pulley.innermost to pulley.outermost of sheaves 1-, 1+, 2-, 2+",
     .axis = "ring",
     .width = Channel::always(4 * wear_cells),
     .read = cell_power,
     .usual = false},
    {.name = "wear/force_speed",
     .unit = "N*m/s",
     .description = "sum of normal force times sliding speed of the tips by radius, rings as above: Archard's wear per coefficient",
     .axis = "ring",
     .width = Channel::always(4 * wear_cells),
     .read = cell_force_speed,
     .usual = false},
    {.name = "wear/pressure_speed",
     .unit = "Pa*m/s",
     .description = "largest Hertz pressure times sliding speed of a tip by radius, rings as above",
     .axis = "ring",
     .width = Channel::always(4 * wear_cells),
     .read = cell_pressure_speed,
     .usual = false},
    {.name = "wear/tip_power",
     .unit = "W",
     .description = "friction of every tip; tip = 4 link + 2 (front half) + (side +z)",
     .axis = "tip",
     .width = each_tip,
     .read = of_each(&ChainForces::tip_power),
     .usual = false},
    {.name = "wear/tip_force_speed",
     .unit = "N*m/s",
     .description = "normal force times sliding speed of every tip",
     .axis = "tip",
     .width = each_tip,
     .read = tip_force_speed,
     .usual = false},
    {.name = "wear/tip_pressure",
     .unit = "Pa",
     .description = "largest Hertz pressure of every tip",
     .axis = "tip",
     .width = each_tip,
     .read = tip_pressure,
     .usual = false},
    {.name = "wear/tip_sliding",
     .unit = "m/s",
     .description = "sliding speed of every tip on its sheave",
     .axis = "tip",
     .width = each_tip,
     .read = of_each(&ChainForces::tip_sliding),
     .usual = false},
    {.name = "clamping_limit_use",
     .unit = "1",
     .description = "clamping force over wear.clamping_limit at the slip speed, of the pulley where it is larger; 0: no limit",
     .read = limit_use,
     .usual = false},
    {.name = "temperature/pulleys",
     .unit = "K",
     .description = "of pulleys and chain (heat.enabled)",
     .read = heat(&model::HeatBalance::pulleys),
     .needs_pulleys = false,
     .usual = false},
    {.name = "temperature/oil",
     .unit = "K",
     .description = "of the oil around pulleys and chain (heat.enabled)",
     .read = heat(&model::HeatBalance::oil),
     .needs_pulleys = false,
     .usual = false},
};

}  // namespace

std::span<const Channel> wear_channels() { return table_of_wear; }

}  // namespace cvtflow::tasks
