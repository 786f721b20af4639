/// Keys whose values follow from others: of vehicle and cycle, gains of ratio control, and the largest friction of a table.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "model/basis/portable_math.hpp"
#include "model/force/pulley_inputs.hpp"
#include "model/machine/belt.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::tasks {

namespace {

constexpr std::string_view friction_key = "tip.friction_coefficient";

[[nodiscard]] bool is_gain(std::string_view key) noexcept { return key == "control.proportional" || key == "control.integral"; }

constexpr std::string_view floor_keys[] = {"clamping.driven", "hydraulics.driven_pressure"};

[[nodiscard]] bool table_gives_friction(const Scene& scene) noexcept {
    return scene.parameters.tip.friction_law == model::TipFriction::table && !scene.parameters.tip.friction_table.value.empty();
}

/// Force of a cylinder per change of ln i, by which tips, attachment and tilt of its sheaves yield [N].
[[nodiscard]] double elastic_stiffness(const model::Parameters& p) {
    const auto radii = model::belt_radii(model::chain_length(p.chain), p.start.ratio, p.pulley.centre_distance);
    const double inverse = radii ? 1.0 / radii->driving + 1.0 / radii->driven : 2.0 / p.pulley.arc_position;
    return 2.0 * model::portable_sin(p.tip.angle) / model::portable_cos(p.tip.angle) / (inverse * groove_yield(p));
}

/// Takes the gains of control.gains = "found" (model/EQUATIONS.md section 8, which states their margins).
void find_gains(const Scene& scene, model::Control& control) {
    constexpr double fastest = 60.0, slowest = 0.5;                           // [1/s, s]
    constexpr double softening = 100.0, gain_margin = 2.0, separation = 4.0;  // [rad/s]; [1]; of both parts' time constants [1]
    const model::Parameters& p = scene.parameters;
    const double clamping = driven_clamping_at_start(p), speed = model::scaling_speed(p), rate_of_ratio = ratio_mobility * speed / clamping;
    if (!(clamping > 0.0 && speed > 0.0)) return;
    const bool valves = p.hydraulics.mode != model::HydraulicMode::none && p.hydraulics.valve_lag > 0.0;
    const double rate = valves ? std::min(fastest, 1.0 / (separation * p.hydraulics.valve_lag)) : fastest;
    const double bound = elastic_stiffness(p) * speed / (speed + softening) / gain_margin;
    control.proportional = std::min(rate / rate_of_ratio, bound);
    control.integral = control.proportional / std::max(slowest, separation / (control.proportional * rate_of_ratio));
}

}  // namespace

double groove_yield(const model::Parameters& p) {
    const double radius = p.pulley.arc_position, tip = 1.5 * p.tip.hertz * std::sqrt(p.tip.reference_depth);
    const double tips = 2.0 * std::numbers::pi * radius * p.chain.pins / model::chain_length(p.chain);  // of half a turn, on one sheave
    const double lever = 2.0 * radius / std::numbers::pi;                                               // to the middle of the arc
    return 1.0 / p.pulley.attachment_axial + 2.0 * lever * lever / p.pulley.attachment_tilt + 2.0 / (tips * tip);
}

double driven_clamping_at_start(const model::Parameters& p) {
    const bool pressures = p.hydraulics.mode == model::HydraulicMode::pressure;
    const double table = pressures ? p.hydraulics.driven.area * p.hydraulics.driven.pressure.at(0.0) : p.clamping.driven.at(0.0);
    const auto radii = model::belt_radii(model::chain_length(p.chain), p.start.ratio, p.pulley.centre_distance);
    return radii ? model::driven_clamping(p.clamping, table, p.load.torque.at(0.0), model::grip(p.tip) * radii->driven) : table;
}

void note_floor(Scene& scene, std::string_view key) noexcept {
    for (std::size_t k = 0; k < scene.floors.size(); ++k) scene.floors[k] = scene.floors[k] || key == floor_keys[k];
}

bool lacks_floor(const Scene& scene, std::string_view key) noexcept {
    const auto at = std::ranges::find(floor_keys, key);
    return at != std::end(floor_keys) && !scene.floors[static_cast<std::size_t>(at - std::begin(floor_keys))];
}

bool is_derived(const Scene& scene, std::string_view key) noexcept {
    if (const bool pressures = scene.parameters.hydraulics.mode == model::HydraulicMode::pressure; lacks_floor(scene, key))
        return scene.parameters.clamping.safety > 0.0 && pressures == (key == floor_keys[1]);
    if (is_gain(key)) return scene.gains == ControlGains::found;
    if (key == friction_key) return table_gives_friction(scene);
    if (!scene.vehicle.present()) return false;
    if (scene.cycle.present()) return key == "load.torque" || key == "drive.speed" || key == "control.ratio" || key == "start.ratio";
    return key == "load.torque" || key == "load.inertia" || key == "load.quadratic";
}

std::string derived_text(const Scene& scene, std::string_view key) {
    if (is_gain(key)) return fmt::format("{}: follows from control.gains = \"found\"; remove one of both", key);
    if (key == friction_key)
        return fmt::format("{}: is the largest value of tip.friction_table, {}; remove it, and use tip.friction_scale to vary friction",
                           key, number_text(*std::ranges::max_element(scene.parameters.tip.friction_table.value)));
    return fmt::format("{}: follows from [vehicle]{}; remove it", key, scene.cycle.present() ? " and [cycle]" : "");
}

bool has_derived(const Scene& scene) noexcept {
    return scene.vehicle.present() || scene.gains == ControlGains::found || scene.parameters.clamping.safety > 0.0 ||
           table_gives_friction(scene);
}

void derive(Scene& scene) {
    model::Tip& tip = scene.parameters.tip;
    if (table_gives_friction(scene)) tip.friction.coefficient = *std::ranges::max_element(tip.friction_table.value);
    if (scene.vehicle.present() && !scene.cycle.present()) model::load_by(scene.vehicle, scene.parameters.load);
    if (scene.vehicle.present() && scene.cycle.present() && scene.cycle.intervals() < static_cast<double>(max_points))
        model::Trip(scene.vehicle, scene.cycle).command(scene.parameters);
    if (is_derived(scene, floor_keys[0])) scene.parameters.clamping.driven = model::TimeTable{0.0};
    if (is_derived(scene, floor_keys[1])) scene.parameters.hydraulics.driven.pressure = model::TimeTable{0.0};
    if (scene.gains == ControlGains::found) find_gains(scene, scene.parameters.control);
}

void forget_derived(Scene& scene) {
    if (!has_derived(scene)) return;
    Scene defaults;
    for (const Parameter& key : parameter_table()) {
        if (key.key == friction_key || !is_derived(scene, key.key)) continue;  // friction stays when the law changes
        std::visit([&](auto* member) { *member = *std::get<decltype(member)>(key.member(defaults)); }, key.member(scene));
    }
}

}  // namespace cvtflow::tasks
