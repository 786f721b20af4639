#include "tasks/sizing/sizing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "model/force/hydraulics.hpp"
#include "model/force/pulley_inputs.hpp"
#include "model/machine/belt.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/sizing/belt_drive.hpp"

namespace cvtflow::tasks {

namespace {

constexpr double thrust_guess = 1.4, fall_of_thrust = -0.3;  ///< S_1/S_2 about: 1.8 at ratio 0.417, 1.4 at 1, 1.1 at 2.4
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

[[nodiscard]] bool controls_ratio(const model::Control& control) {
    return control.enabled && control.quantity == model::ControlledQuantity::ratio;
}

/// Whether a controller makes S_2 the target multiple of the load's force.
[[nodiscard]] bool controls_safety(const model::Control& control) {
    return control.enabled && (control.quantity == model::ControlledQuantity::safety ||
                               (controls_ratio(control) && control.driven == model::DrivenControl::safety));
}

[[nodiscard]] bool controls_slip(const model::Control& control) {
    return control.enabled && (control.quantity == model::ControlledQuantity::slip ||
                               (controls_ratio(control) && control.driven == model::DrivenControl::slip));
}

[[nodiscard]] double ratio_at(const model::Parameters& p, double time) {
    return controls_ratio(p.control) ? p.control.ratio.at(time) : p.start.ratio;
}

/// d ln(ratio)/dt after an instant [1/s]; 0 in a step of the target, which control follows as its authority permits.
[[nodiscard]] double shift_at(const model::Parameters& p, double time) {
    constexpr double longest_step = 1e-3;  // [s]
    const model::TimeTable& target = p.control.ratio;
    const auto next = std::ranges::upper_bound(target.time, time);
    if (!controls_ratio(p.control) || next == target.time.begin() || next == target.time.end()) return 0.0;
    const auto k = static_cast<std::size_t>(next - target.time.begin());
    const double lasts = target.time[k] - target.time[k - 1];
    return lasts < longest_step ? 0.0 : (target.value[k] - target.value[k - 1]) / (lasts * target.at(time));
}

/// Force on shaft 1 by which ln(ratio) changes at a unit rate: elastic sheaves creep, cylinders damp (docs/reduce.md). speed [rad/s]
/// @return [N s], within a factor of 1.5 at nine of ten of 339 transients of `baseline`
[[nodiscard]] double force_per_shift(double speed) { return 2.4e6 / std::abs(speed) + 8.2e3; }

/// Why no force follows from the scene's tables; empty if they do.
[[nodiscard]] std::string reason_against(const model::Parameters& p) {
    if (p.detail.pulleys == model::PulleyDetail::absent || p.start.layout != model::StartLayout::belt) return "it has no pulleys";
    if (p.load.mode != model::LoadMode::torque) return "the load follows from the run (load.mode)";
    if (controls_slip(p.control)) return "a controller of slip makes S_2 in the run";
    return "";
}

/// Ratio of the radii at which shafts have a ratio of speeds: joints roll, so a bent chain is shorter. The divisor 6.4 fits geometric
/// starts at ratios from 0.35 to 2.8 within 0.2 % of the ratio.
[[nodiscard]] double ratio_of_radii(const model::Parameters& p, double ratio) {
    const double length = model::chain_length(p.chain);
    const auto radii = model::belt_radii(length, ratio, p.pulley.centre_distance);
    if (!radii) return ratio;
    const double bent = p.joint.radius * length / p.chain.pins / 6.4;
    return ratio / (1.0 + bent * (1.0 / (radii->driven * radii->driven) - 1.0 / (radii->driving * radii->driving)));
}

/// Radii at a ratio of radii, or why the sheaves do not permit it.
[[nodiscard]] std::string radii_at(const model::Parameters& p, double ratio, std::array<double, 2>& radius) {
    const auto radii = model::belt_radii(model::chain_length(p.chain), ratio, p.pulley.centre_distance);
    if (!radii) return fmt::format("no chain of this length runs at ratio {:.4g}", ratio);
    radius = {radii->driving, radii->driven};
    const auto [least, most] = std::minmax(radius[0], radius[1]);
    if (least >= p.pulley.innermost && most <= p.pulley.outermost) return "";
    return fmt::format("at ratio {:.4g} the chain runs on radii of {:.4g} and {:.4g} mm, off the sheaves", ratio, 1e3 * radius[0],
                       1e3 * radius[1]);
}

/// Pulleys whose clamping forces make pressures.
class Pistons {
public:
    explicit Pistons(const model::Parameters& p) : p_(p), wedge_(2.0 * std::tan(p.tip.angle)) {
        model_.adopt(p.hydraulics);
        yield_ = p.detail.pulleys == model::PulleyDetail::elastic ? groove_yield(p) : 0.0;
    }

    /// Running radius by the sheave's position, as a transmission measures it: the flank is crowned, and its groove yields. radius [m],
    /// clamping [N]
    [[nodiscard]] double measured_radius(double radius, double clamping) const {
        const double out = radius - p_.pulley.arc_position;
        const double sine = std::sin(p_.tip.angle) + 0.5 * out / (p_.pulley.arc_radius + p_.tip.radius);  // halfway out
        const double opens = 2.0 * out * sine / std::sqrt(1.0 - sine * sine);
        return p_.pulley.arc_position + (opens + yield_ * clamping) / wedge_;
    }
    /// Force of rotating oil and spring [N].
    [[nodiscard]] double other_force(int shaft, const SizedPoint& at, double clamping) const {
        const double measured = measured_radius(at.radius[static_cast<std::size_t>(shaft)], clamping);
        return model_.other_force(shaft, {(measured - p_.pulley.arc_position) * wedge_, 0.0, shaft == 0 ? at.speed : at.speed / at.ratio});
    }
    /// Piston force and pressure of a clamping force.
    void press(int shaft, SizedPoint& at) const {
        const auto k = static_cast<std::size_t>(shaft);
        at.least[k] = other_force(shaft, at, at.clamping[k]);
        at.piston[k] = at.clamping[k] - at.least[k];
        at.pressure[k] = at.piston[k] / model_.area(shaft);
    }
    /// How much deeper than the radius of the pins the chain runs where the groove yields [m]. clamping [N]
    [[nodiscard]] double deeper(double clamping) const { return yield_ * clamping / wedge_; }
    [[nodiscard]] double area(int shaft) const { return model_.area(shaft); }

private:
    const model::Parameters& p_;
    double wedge_, yield_;
    model::HydraulicModel model_;
};

/// Adds S_2 and what follows from it. limited: by the relief pressure; asked: force that the load asks for by the torque per force that a
/// transmission knows [N], lever [m]
void size_driven(const model::Parameters& p, const Pistons& pistons, bool limited, SizedPoint& at,
                 const std::function<double(double lever)>& asked) {
    const double grip = model::grip(p.tip);
    double force = asked(grip * at.radius[1]);
    for (int k = 0; k < 4; ++k) force = asked(grip * pistons.measured_radius(at.radius[1], force));
    if (p.hydraulics.mode != model::HydraulicMode::none) {
        const double least = pistons.other_force(1, at, force), most = pistons.area(1) * p.hydraulics.relief_pressure + least;
        if (force <= least) at.decided = "rotating oil";
        if (limited && force > most) at.decided = "hydraulics.relief_pressure";
        force = std::clamp(force, least, limited ? most : std::numeric_limits<double>::infinity());
    }
    at.clamping = {unknown, force};
    at.limit = grip * at.radius[1] * force;
    pistons.press(1, at);
}

/// S_2 that the load asks for, or the larger one of the scene's table; `at.decided` is the key that gives the table, else `by`.
[[nodiscard]] double table_or(double asked, const char* by, const model::Parameters& p, const Pistons& pistons, SizedPoint& at) {
    const bool pressures = p.hydraulics.mode == model::HydraulicMode::pressure;
    const double given = p.clamping.driven.at(at.time);
    const double table =
        !pressures ? given : pistons.area(1) * p.hydraulics.driven.pressure.at(at.time) + pistons.other_force(1, at, given);
    at.decided = asked > table ? by : pressures ? "hydraulics.driven_pressure" : "clamping.driven";
    return std::max(asked, table);
}

/// A point of the scene's tables.
[[nodiscard]] SizedPoint point_at(const model::Parameters& p, const Pistons& pistons, double time, std::string& objection) {
    SizedPoint at;
    at.time = time;
    at.ratio = ratio_at(p, time);
    at.speed = p.drive.mode == model::DriveMode::torque ? p.control.reference_speed : p.drive.speed.at(time);
    at.shift = shift_at(p, time);
    const double of_radii = controls_ratio(p.control) ? ratio_of_radii(p, at.ratio) : at.ratio;
    if (objection = radii_at(p, of_radii, at.radius); !objection.empty()) return at;
    const double turning = std::abs(at.speed) / at.ratio;
    const double load = (at.speed < 0.0 ? -1.0 : 1.0) * p.load.torque.at(time) + (p.load.linear + p.load.quadratic * turning) * turning;
    at.load = load + p.drag.driven.seals + (p.drag.driven.viscous + p.drag.driven.churning * turning) * turning;
    size_driven(p, pistons, true, at, [&](double lever) {
        if (controls_safety(p.control)) {
            at.decided = "control.safety";
            return model::carrying_clamping(p.control.safety.at(time), load, lever);
        }
        return table_or(model::carrying_clamping(p.clamping.safety, load, lever), "clamping.safety", p, pistons, at);
    });
    return at;
}

/// Instants at which tables have points, and some in between; the beginning alone where all of them are constant [s].
[[nodiscard]] std::vector<double> instants_of(const Scene& scene) {
    constexpr int between = 200;
    const model::Parameters& p = scene.parameters;
    const double end = latest_end(scene);
    const model::TimeTable* tables[] = {&p.load.torque,   &p.drive.speed,    &p.clamping.driven,
                                        &p.control.ratio, &p.control.safety, &p.hydraulics.driven.pressure};
    std::vector<double> times{0.0};
    if (std::ranges::all_of(tables, [](const model::TimeTable* table) { return table->time.size() < 2; })) return times;
    for (int k = 1; k <= between; ++k) times.push_back(end * k / between);
    for (const model::TimeTable* table : tables)
        std::ranges::copy_if(table->time, std::back_inserter(times), [&](double t) { return t > 0.0 && t < end; });
    std::ranges::sort(times);
    times.erase(std::unique(times.begin(), times.end()), times.end());
    return times;
}

/// Whether a chain stays on the sheaves: its groove yields, and pins of a strand touch up to 2.3 pitches before the arc (vl300, baseline).
[[nodiscard]] bool stays(const model::Parameters& p, const Pistons& pistons, const SizedPoint& at) {
    constexpr double ahead = 2.3, margin = 1e-4;  // [pitches], [m]
    const auto [least, most] = std::minmax(at.radius[0], at.radius[1]);
    const double larger = at.clamping[1] * std::max(1.0, thrust_guess * std::pow(at.ratio, fall_of_thrust));
    const double pitch = model::chain_length(p.chain) / p.chain.pins;
    return least - pistons.deeper(larger) >= p.pulley.innermost + margin && std::hypot(most, ahead * pitch) <= p.pulley.outermost - margin;
}

}  // namespace

double SizedPoint::factor() const noexcept { return load == 0.0 ? INFINITY : limit / std::abs(load); }

Sizing size_scene(const Scene& scene) {
    const model::Parameters& p = scene.parameters;
    Sizing sizing{{}, reason_against(p), true};
    if (!sizing.objection.empty()) return sizing;
    using Badness = double (*)(const SizedPoint&);
    const std::pair<const char*, Badness> kinds[] = {
        {"least safety", [](const SizedPoint& at) { return at.load == 0.0 ? -1.0 : 1.0 / at.factor(); }},
        {"largest S_2", [](const SizedPoint& at) { return at.clamping[1]; }},
        {"largest S_1", [](const SizedPoint& at) { return at.clamping[1] * std::pow(at.ratio, fall_of_thrust); }},
        {"fastest shift", [](const SizedPoint& at) { return at.speed == 0.0 ? -1.0 : std::abs(at.shift) * force_per_shift(at.speed); }}};
    std::vector<SizedPoint> all;
    const Pistons pistons(p);
    for (const double time : instants_of(scene)) {
        std::string objection;
        all.push_back(point_at(p, pistons, time, objection));
        if (!objection.empty()) return {{}, fmt::format("{} (at {:.4g} s)", objection, time)};
    }
    for (const auto& [name, badness] : kinds) {
        const auto worst = std::ranges::max_element(all, {}, badness);
        if (badness(*worst) <= 0.0) continue;
        auto same = std::ranges::find(sizing.points, worst->time, &SizedPoint::time);
        if (same == sizing.points.end()) same = sizing.points.insert(same, *worst);
        same->reason += (same->reason.empty() ? "" : ", ") + std::string(name);
    }
    sizing.instants = std::move(all);
    return sizing;
}

Sizing size_for_torque(const Scene& scene, double torque, double safety) {
    constexpr int count = 5;
    const model::Parameters& p = scene.parameters;
    if (p.detail.pulleys == model::PulleyDetail::absent || p.start.layout != model::StartLayout::belt) return {{}, reason_against(p)};
    const Pistons pistons(p);
    const auto sized = [&](double ratio) {
        SizedPoint at;
        at.ratio = ratio;
        at.reason = fmt::format("ratio {:.3g}", at.ratio);
        at.speed = p.drive.mode == model::DriveMode::torque ? p.control.reference_speed : p.drive.speed.at(0.0);
        at.load = torque * at.ratio;
        at.objection = radii_at(p, ratio_of_radii(p, at.ratio), at.radius);
        size_driven(p, pistons, false, at, [&](double lever) {
            const double asked = model::carrying_clamping(safety, at.load, lever);
            at.decided = "--safety";
            return p.clamping.safety > 0.0 ? table_or(asked, "--safety", p, pistons, at) : asked;
        });
        if (at.objection.empty() && !stays(p, pistons, at))
            at.objection =
                fmt::format("at ratio {:.4g} the chain runs off the sheaves under S_2 = {:.4g} kN", ratio, 1e-3 * at.clamping[1]);
        return at;
    };
    const auto farthest = [&](double factor) {  // within a thousandth
        double ratio = p.start.ratio;
        while (sized(ratio * factor).objection.empty()) ratio *= factor;
        return ratio;
    };
    Sizing sizing{{}, sized(p.start.ratio).objection};
    if (!sizing.objection.empty()) return sizing;
    const double most = farthest(1.001), least = farthest(1.0 / 1.001);
    for (int k = 0; k < count; ++k) sizing.points.push_back(sized(most * std::pow(least / most, static_cast<double>(k) / (count - 1))));
    return sizing;
}

void size_driving(const Scene& scene, SizedPoint& at) {
    constexpr double largest_share = 0.9;  // of the limit, up to which theory has been compared (docs/validation.md)
    const model::Parameters& p = scene.parameters;
    at.clamping[0] = at.piston[0] = at.pressure[0] = at.shifting = at.correction = unknown;
    if (at.factor() * largest_share < 1.0) {
        at.objection = fmt::format("S_1 by theory requires a safety factor of {:.2g} at least", 1.0 / largest_share);
        return;
    }
    if (at.speed == 0.0) {
        at.objection = "S_1 by theory requires that shaft 1 turns";
        return;
    }
    BeltParts parts;
    parts.vibration = 10e-3;  // pins vibrate: closer to the chain (docs/validation.md)
    parts.nodes = 100;
    const BeltPoint point{at.ratio, at.clamping[1], at.load, std::abs(at.speed)};
    try {
        at.clamping[0] = solve_belt(p, point, parts).thrust_ratio * at.clamping[1];
        Pistons(p).press(0, at);
    } catch (const std::domain_error& error) {
        at.objection = std::string("S_1 by theory: ") + error.what();
        return;
    }
    at.shifting = at.clamping[0] - at.shift * force_per_shift(at.speed);
    const double table = p.clamping.driving.at(at.time), holding = at.clamping[0] - table, shifting = at.shifting - table;
    at.correction = std::abs(holding) > std::abs(shifting) ? holding : shifting;
}

}  // namespace cvtflow::tasks
