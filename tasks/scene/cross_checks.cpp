#include "tasks/scene/parameter_table.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include "engine/base/text.hpp"
#include "engine/executor/catalogue.hpp"
#include "engine/thread/guards.hpp"
#include "model/machine/belt.hpp"
#include "tasks/channel/channels.hpp"
#include "tasks/method/method.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/scene/toml_tree.hpp"
#include "tasks/scene/units.hpp"
#include "tasks/step/step_graph.hpp"

namespace cvtflow::tasks {

namespace {

using model::DriveMode;
using model::PulleyDetail;
using model::StartLayout;
using Violation = std::optional<std::string>;

/// The largest friction of a tip is known everywhere as tip.friction_coefficient: clamping by torque, safety factors, stability.
Violation tip_law_has_its_largest(const Scene& scene) {
    const model::Tip& tip = scene.parameters.tip;
    const double coefficient = tip.friction.coefficient;
    if (tip.friction_law == model::TipFriction::lubricated && tip.limiting_traction > coefficient)
        return fmt::format("tip.limiting_traction: {} is above tip.friction_coefficient = {}", number_text(tip.limiting_traction),
                           number_text(coefficient));
    if (tip.friction_law != model::TipFriction::table) return {};
    if (tip.friction_table.speed.size() < 2)
        return "tip.friction_table: tip.friction_law = \"table\" takes its friction from at least two points [speed, coefficient]";
    const double largest = *std::ranges::max_element(tip.friction_table.value);
    if (std::abs(largest - coefficient) <= 1e-9 * coefficient) return {};
    return fmt::format("tip.friction_table: its largest value is {}, but tip.friction_coefficient is {}; they must be equal",
                       number_text(largest), number_text(coefficient));
}

Violation tip_law_suits_steps(const Scene& scene) {
    const auto& p = scene.parameters;
    const bool constant = p.tip.friction_law == model::TipFriction::constant, remembers = p.tip.friction_memory > 0.0;
    if (remembers && constant)
        return "tip.friction_memory: friction of tip.friction_law = \"constant\" does not depend on the sliding speed";
    if (remembers && method_of(scene) != "leapfrog-rigid")
        return fmt::format("tip.friction_memory: requires method leapfrog-rigid (detail.pins = \"rigid\"), not {}", method_of(scene));
    if (constant || p.detail.pins != model::PinDetail::rigid || p.detail.friction == model::FrictionLaw::piecewise) return {};
    return "tip.friction_law: detail.pins = \"rigid\" takes it with detail.friction = \"piecewise\" only";
}

Violation imperfections_have_pulleys(const Scene& scene) {
    const auto& [detail, i] = std::tie(scene.parameters.detail, scene.parameters.imperfection);
    const std::string_view present = i.pin_length_spread != 0.0 ? "pin_length_spread"
                                     : i.unbalance != 0.0       ? "unbalance"
                                     : i.attachment != 1.0      ? "attachment"
                                     : i.runout != 0.0          ? "runout"
                                     : i.misalignment != 0.0    ? "misalignment"
                                                                : "";
    if (present.empty() || detail.pulleys == PulleyDetail::elastic) return {};
    if (detail.pulleys == PulleyDetail::absent)
        return fmt::format("imperfection.{}: imperfections are of pulleys, which are absent", present);
    if (i.attachment != 1.0) return "imperfection.attachment: an attachment yields with detail.pulleys = \"elastic\" only";
    if (i.unbalance != 0.0) return "imperfection.unbalance: a sheave yields to it with detail.pulleys = \"elastic\" only";
    return {};
}

/// The centre of mass is well inside of the sheave, so that its inertia about that is positive.
Violation unbalance_is_small(const Scene& scene) {
    const auto& [pulley, i] = std::tie(scene.parameters.pulley, scene.parameters.imperfection);
    const double most = std::sqrt(0.1 * pulley.sheave_mass * pulley.sheave_polar_inertia);
    if (i.unbalance <= most) return {};
    return fmt::format("imperfection.unbalance: {} kg*m is too much for a sheave of this mass and inertia, which bears {:.2g}",
                       number_text(i.unbalance), most);
}

Violation drag_has_shafts(const Scene& scene) {
    if (!scene.parameters.drag.present() || scene.parameters.detail.pulleys != PulleyDetail::absent) return {};
    return "drag.driving_seals: drag is of shafts, but detail.pulleys is \"absent\"";
}

Violation guide_begins_before_it_ends(const Scene& scene) {
    const auto& guide = scene.parameters.guide;
    if (!guide.present() || guide.begin < guide.end) return {};
    return fmt::format("guide.begin: {} is not before guide.end = {}", number_text(guide.begin), number_text(guide.end));
}

Violation guide_has_strands(const Scene& scene) {
    const auto& p = scene.parameters;
    if (!p.guide.present()) return {};
    if (p.detail.pulleys == PulleyDetail::absent) return "guide.stiffness: guides are of strands between pulleys, which are absent";
    if (model::belt_radii(model::chain_length(p.chain), p.start.ratio, p.pulley.centre_distance)) return {};
    return "guide.stiffness: at start.ratio the chain runs on no radii, and guides have no place";
}

Violation hydraulics_have_pulleys(const Scene& scene) {
    const auto& p = scene.parameters;
    if (p.hydraulics.mode == model::HydraulicMode::none || p.detail.pulleys != PulleyDetail::absent) return {};
    return "hydraulics.mode: cylinders need pulleys, but detail.pulleys is \"absent\"";
}

/// Oil as a spring against the sheave's mass, and its flow through a valve, are slow beside the steps of every method.
Violation oil_is_slow(const Scene& scene) {
    const auto& of = scene.parameters.hydraulics;
    if (of.mode == model::HydraulicMode::none) return {};
    constexpr double fastest = 1e5;  // [rad/s]: half a radian in a step of 5 us, the longest automatic one
    const double area = std::max(of.driving.area, of.driven.area), capacity = of.oil_volume / of.oil_modulus;
    const double frequency = area / std::sqrt(capacity * scene.parameters.pulley.sheave_mass), rate = of.valve_conductance / capacity;
    if (frequency > fastest)
        return fmt::format(
            "hydraulics.oil_volume: sheave and oil would vibrate at {:.3g} kHz, above {:.3g}: a larger oil_volume or a smaller oil_modulus",
            5e-4 * frequency / std::numbers::pi, 5e-4 * fastest / std::numbers::pi);
    if (rate > fastest)
        return fmt::format("hydraulics.valve_conductance: a cylinder would follow its valve within {:.3g} us, below {:.3g}: a smaller one",
                           1e6 / rate, 1e6 / fastest);
    return {};
}

Violation oil_is_behind_pistons(const Scene& scene) {
    const auto& of = scene.parameters.hydraulics;
    for (const auto& [name, cylinder] : {std::pair{"driving", &of.driving}, {"driven", &of.driven}}) {
        const double outer = std::sqrt(cylinder->inner * cylinder->inner + cylinder->area / std::numbers::pi);
        if (of.mode != model::HydraulicMode::none && of.feed_radius > outer)
            return fmt::format("hydraulics.feed_radius: {:.4g} mm is beyond the outer radius of hydraulics.{}_area, {:.4g} mm",
                               1e3 * of.feed_radius, name, 1e3 * outer);
    }
    return {};
}

Violation pump_turns(const Scene& scene) {
    const auto& of = scene.parameters.hydraulics;
    if (of.mode == model::HydraulicMode::none) return {};
    if (of.pump_displacement == 0.0) return "hydraulics.pump_displacement: 0 feeds no cylinder";
    if (of.pump_ratio > 0.0 || of.pump_speed.largest_magnitude() > 0.0) return {};
    return "hydraulics.pump_ratio: 0 and hydraulics.pump_speed = 0 leave the pump at rest";
}

/// A length in mm with four digits, for messages.
std::string mm(double length) { return fmt::format("{:.4g} mm", 1e3 * length); }

std::string seconds(double time) { return number_text(time) + " s"; }

/// Radii on which a chain runs, kept: a sweep of a million cases has a few geometries.
std::optional<model::BeltRadii> known_radii(double length, double ratio, double centre_distance) {
    constexpr std::size_t max_known = 1000;
    static engine::Mutex mutex;
    static std::map<std::array<double, 3>, std::optional<model::BeltRadii>> known;
    return mutex.guard([&] {
        if (known.size() >= max_known) known.clear();
        const auto [at, missing] = known.try_emplace({length, ratio, centre_distance});
        if (missing) at->second = model::belt_radii(length, ratio, centre_distance);
        return at->second;
    });
}

Violation geometry_closes(const Scene& scene) {
    const auto& chain = scene.parameters.chain;
    const auto& pulley = scene.parameters.pulley;
    const auto& start = scene.parameters.start;
    const bool absent = scene.parameters.detail.pulleys == PulleyDetail::absent;
    if (start.layout != StartLayout::belt || absent || !scene.state_file.empty()) return {};
    if (pulley.innermost >= pulley.outermost) return {};  // reported by radii_ordered
    const double length = model::chain_length(chain);
    const auto radii = known_radii(length, start.ratio, pulley.centre_distance);
    const auto chain_text = fmt::format("chain.pins: {} pins make a chain of {}", chain.pins, mm(length));
    const auto centre_distance = mm(pulley.centre_distance);
    if (!radii && length <= 2.0 * pulley.centre_distance)
        return fmt::format("{}, too short for pulley.centre_distance = {}", chain_text, centre_distance);
    if (!radii) return fmt::format("{}, too long: the pulleys would touch at pulley.centre_distance = {}", chain_text, centre_distance);
    const auto [smaller, larger] = std::minmax(radii->driving, radii->driven);
    if (smaller >= pulley.innermost && larger <= pulley.outermost) return {};
    return fmt::format("{}, which at start.ratio = {} runs on radii of {} and {}, outside pulley.innermost = {} to pulley.outermost = {}",
                       chain_text, number_text(start.ratio), mm(radii->driving), mm(radii->driven), mm(pulley.innermost),
                       mm(pulley.outermost));
}

Violation pitch_clears_halves(const Scene& scene) {
    const auto& pitch = scene.parameters.chain.pitch;
    const double smallest = *std::min_element(pitch.begin(), pitch.end());
    if (smallest > scene.parameters.half.width) return {};
    return fmt::format("chain.pitch: {} is not larger than half.width = {}", mm(smallest), mm(scene.parameters.half.width));
}

Violation pitches_fit(const Scene& scene) {
    const auto& chain = scene.parameters.chain;
    if (chain.pitch.size() <= static_cast<std::size_t>(chain.pins)) return {};
    return fmt::format("chain.pitch: {} pitches for chain.pins = {}", chain.pitch.size(), chain.pins);
}

Violation plates_on_pin(const Scene& scene) {
    const auto& plate = scene.parameters.plate;
    const auto& half = scene.parameters.half;
    if (plate.span <= 0.5 * half.length) return {};
    return fmt::format("plate.span: {} is beyond the end of the pin, half.length/2 = {}", mm(plate.span), mm(0.5 * half.length));
}

Violation profile_is_round(const Scene& scene) {
    const auto& joint = scene.parameters.joint;
    const auto& half = scene.parameters.half;
    if (joint.radius > 0.5 * half.width) return {};
    return fmt::format("joint.radius: {} is not larger than half.width/2 = {}", mm(joint.radius), mm(0.5 * half.width));
}

Violation radii_ordered(const Scene& scene) {
    const auto& pulley = scene.parameters.pulley;
    if (pulley.innermost < pulley.outermost) return {};
    return fmt::format("pulley.innermost: {} is not smaller than pulley.outermost = {}", mm(pulley.innermost), mm(pulley.outermost));
}

Violation arc_on_sheave(const Scene& scene) {
    const auto& pulley = scene.parameters.pulley;
    if (pulley.innermost >= pulley.outermost) return {};  // reported by radii_ordered
    if (pulley.arc_position >= pulley.innermost && pulley.arc_position <= pulley.outermost) return {};
    return fmt::format("pulley.arc_position: {} is outside pulley.innermost = {} to pulley.outermost = {}", mm(pulley.arc_position),
                       mm(pulley.innermost), mm(pulley.outermost));
}

Violation layout_has_pulleys(const Scene& scene) {
    const bool ring = scene.parameters.start.layout == StartLayout::ring;
    const bool absent = scene.parameters.detail.pulleys == PulleyDetail::absent;
    if (ring == absent) return {};
    return ring ? "start.layout: \"ring\" requires detail.pulleys = \"absent\""
                : "start.layout: \"belt\" requires pulleys, but detail.pulleys is \"absent\"";
}

Violation ramp_within_settling(const Scene& scene) {
    const auto& start = scene.parameters.start;
    const bool settles = start.layout == StartLayout::belt && start.settling_time > 0.0;
    if (!settles || start.ramp_time <= start.settling_time) return {};
    return fmt::format("start.ramp_time: {} is longer than start.settling_time = {}", seconds(start.ramp_time),
                       seconds(start.settling_time));
}

Violation control_has_pulleys(const Scene& scene) {
    if (!scene.parameters.control.enabled || scene.parameters.detail.pulleys != PulleyDetail::absent) return {};
    return "control.enabled: control requires pulleys, but detail.pulleys is \"absent\"";
}

Violation control_has_speed(const Scene& scene) {
    const auto& drive = scene.parameters.drive;
    const auto& control = scene.parameters.control;
    if (!control.enabled || control.quantity != model::ControlledQuantity::ratio) return {};
    if (drive.mode == DriveMode::torque || drive.speed.largest_magnitude() > 0.0) return {};
    return "control.enabled: the control error is relative to drive.speed, which is always 0";
}

Violation load_has_speed(const Scene& scene) {
    const auto& load = scene.parameters.load;
    if (load.mode == model::LoadMode::torque || load.speed.largest_magnitude() > 0.0) return {};
    return "load.mode: \"speed\" and \"coupling\" need load.speed, which is 0 throughout";
}

Violation couplings_have_pulleys(const Scene& scene) {
    const auto& p = scene.parameters;
    const bool couples = p.drive.mode == DriveMode::coupling || p.load.mode != model::LoadMode::torque;
    if (!couples || p.detail.pulleys != PulleyDetail::absent) return {};
    return fmt::format("{}.mode: couplings need pulleys, but detail.pulleys is \"absent\"",
                       p.drive.mode == DriveMode::coupling ? "drive" : "load");
}

Violation controllers_differ(const Scene& scene) {
    const auto& control = scene.parameters.control;
    if (control.driven == model::DrivenControl::none) return {};
    if (!control.enabled) return "control.driven: the second controller requires the first one, but control.enabled is false";
    if (control.quantity == model::ControlledQuantity::ratio) return {};
    return "control.driven: control.quantity already controls the clamping force of shaft 2";
}

Violation vehicle_loads_shaft(const Scene& scene) {
    const auto& p = scene.parameters;
    if (!scene.vehicle.present()) return {};
    if (p.detail.pulleys == PulleyDetail::absent) return "vehicle.mass: a vehicle needs pulleys, but detail.pulleys is \"absent\"";
    if (p.load.mode != model::LoadMode::torque) return "load.mode: a vehicle loads shaft 2 with load.mode = \"torque\" only";
    for (const auto& [key, value] : {std::pair{"load.inertia", p.load.inertia},
                                     {"load.quadratic", p.load.quadratic},
                                     {"load.torque", p.load.torque.largest_magnitude()},
                                     {"drive.speed", p.drive.speed.largest_magnitude()}}) {
        const Parameter& row = *find_parameter(key);
        if (is_derived(scene, key) && value > row.max)
            return fmt::format("vehicle.mass: {} = {} {} follows from the vehicle, above {}", key, number_text(value), row.unit,
                               number_text(row.max));
    }
    return {};
}

Violation cycle_is_driven(const Scene& scene) {
    const auto& [drive, control] = std::tie(scene.parameters.drive, scene.parameters.control);
    const model::Cycle& cycle = scene.cycle;
    if (!cycle.present()) return {};
    if (!scene.vehicle.present()) return "cycle.speed: a cycle needs a vehicle, but vehicle.mass is 0";
    if (drive.mode != DriveMode::speed) return "drive.mode: a cycle turns shaft 1 with drive.mode = \"speed\" only";
    if (!control.enabled || control.quantity != model::ControlledQuantity::ratio)
        return "control.enabled: a cycle needs control of the ratio (control.enabled = true, control.quantity = \"ratio\")";
    if (cycle.min_ratio > cycle.max_ratio)
        return fmt::format("cycle.min_ratio: {} is above cycle.max_ratio = {}", number_text(cycle.min_ratio), number_text(cycle.max_ratio));
    if (cycle.begin >= cycle.speed.time.back())
        return fmt::format("cycle.begin: {} is not before the end of cycle.speed, {}", seconds(cycle.begin),
                           seconds(cycle.speed.time.back()));
    if (cycle.intervals() < static_cast<double>(max_points)) return {};
    return fmt::format("cycle.pedal_time: {} divides the cycle into more than {} points", seconds(cycle.pedal_time), max_points);
}

Violation outputs_take_steps(const Scene& scene) {
    if (scene.run.output_interval >= scene.run.step) return {};  // an automatic step is 0 here: it gives way
    return fmt::format("run.output_interval: {} is shorter than run.step = {}", seconds(scene.run.output_interval),
                       seconds(scene.run.step));
}

Violation followed_pin_exists(const Scene& scene) {
    const int pins = scene.parameters.chain.pins;
    if (scene.run.followed_pin < pins) return {};
    return fmt::format("run.followed_pin: {} is not below chain.pins = {} (pins count from 0)", scene.run.followed_pin, pins);
}

Violation segments_have_links(const Scene& scene) {
    const int pins = scene.parameters.chain.pins;
    if (scene.run.segments <= pins) return {};
    return fmt::format("run.segments: {} segments for chain.pins = {}", scene.run.segments, pins);
}

Violation method_exists(const Scene& scene) {
    if (scene.run.method.empty()) return "run.method: the name is empty";
    if (may_be_method(method_of(scene))) return {};  // numbers of a family are checked when the method is made
    return "run.method: " + no_method(scene.run.method);
}

Violation method_takes_machine(const Scene& scene) {
    const std::string objection = objection_to(method_of(scene), scene.parameters);
    return objection.empty() ? Violation{} : "run.method: " + objection;
}

Violation assembly_takes_pins(const Scene& scene) {
    if (!has_assembly(scene.run.assembly)) return "run.assembly: \"staged\" belongs to the laboratory: cvtflow-lab run";
    if (scene.run.assembly == Assembly::fused || scene.parameters.detail.pins == model::PinDetail::halves) return {};
    return "run.assembly: \"staged\" requires detail.pins = \"halves\": rigid pins have no separate joints";
}

Violation rigid_pins_are_simple(const Scene& scene) {
    const model::Detail& detail = scene.parameters.detail;
    if (detail.pins != model::PinDetail::rigid) return {};
    constexpr const char* rigid = "detail.pins = \"rigid\"";
    if (detail.order != 2) return fmt::format("detail.order: {} has order 2, not {}", rigid, detail.order);
    if (detail.plates != model::PlateDetail::lumped) return fmt::format("detail.plates: {} has \"lumped\" plates", rigid);
    if (detail.stick_slip) return fmt::format("detail.stick_slip: {} has no phases stick and slip", rigid);
    if (scene.parameters.joint.law != model::JointLaw::linear) return fmt::format("joint.law: {} has joints of law \"linear\"", rigid);
    return {};
}

Violation rigid_pins_are_serial(const Scene& scene) {
    if (scene.parameters.detail.pins != model::PinDetail::rigid) return {};
    const RunSettings& run = scene.run;
    if (run.segments > 1) return fmt::format("run.segments: detail.pins = \"rigid\" is one segment, not {}", run.segments);
    if (run.schedule == "auto" || run.schedule == "serial") return {};
    return fmt::format("run.schedule: detail.pins = \"rigid\" runs on one thread: \"serial\" or \"auto\", not \"{}\"", run.schedule);
}

Violation method_estimates_error(const Scene& scene) {
    if (scene.run.step_control == StepControl::fixed) return {};
    const std::optional<Method> method = Method::find(method_of(scene));
    if (!method || method->estimates_error()) return {};
    return fmt::format("run.step_control: '{}' has no error estimate; only \"fixed\" steps are possible (cvtflow list methods --all)",
                       method_of(scene));
}

Violation channels_exist(const Scene& scene) {
    const std::vector<std::string> unknown = unknown_channels(scene.run.channels);
    if (unknown.empty()) return {};
    std::vector<std::string> names;
    for (const Channel& channel : channels()) names.emplace_back(channel.name);
    return fmt::format("record.channels: unknown channel '{}'{} (cvtflow list channels)", unknown.front(),
                       engine::did_you_mean(engine::closest(unknown.front(), names)));
}

Violation executor_exists(const Scene& scene) {
    const std::string& name = scene.run.schedule;
    if (name == "auto" || engine::find_executor(name) != nullptr) return {};
    constexpr std::array<std::string_view, 1> others{"auto"};
    return fmt::format("run.schedule: unknown executor '{}'{} (cvtflow list executors; or auto)", name,
                       engine::missing_executor(name, others));
}

/// Names become parts of files' names, and both go onto terminals and into other files.
Violation name_is_plain(const Scene& scene) {
    const std::string wrong = engine::name_problem(scene.name);
    if (wrong.empty()) return {};
    return fmt::format("scene.name: {} {}", toml_text(scene.name.substr(0, 60)), wrong);
}

Violation description_is_text(const Scene& scene) {
    const std::string wrong = engine::text_problem(scene.description);
    if (wrong.empty()) return {};
    return fmt::format("scene.description: {}", wrong);
}

Violation gains_are_of_the_ratio(const Scene& scene) {
    const model::Control& control = scene.parameters.control;
    if (scene.gains == ControlGains::given) return {};
    if (!control.enabled || control.quantity != model::ControlledQuantity::ratio)
        return "control.gains: \"found\" is about control of the ratio (control.enabled = true, control.quantity = \"ratio\")";
    if (driven_clamping_at_start(scene.parameters) > 0.0) return {};
    return "control.gains: \"found\" requires a clamping force of shaft 2 at t = 0 (clamping.driven, or clamping.safety and a load)";
}

Violation steady_has_pulleys(const Scene& scene) {
    if (!scene.run.until.automatic() || scene.parameters.detail.pulleys != PulleyDetail::absent) return {};
    return "run.until: \"steady\" is about means of whole pin periods on pulleys, but detail.pulleys is \"absent\"";
}

/// A CrossCheck: its keys, separated by spaces.
struct Row {
    std::string_view keys;
    Violation (*violation)(const Scene&);
};
constexpr Row rows_of_checks[] = {
    {"scene.name", name_is_plain},
    {"scene.description", description_is_text},
    {"chain.pins chain.pitch pulley.centre_distance start.ratio pulley.innermost pulley.outermost detail.pulleys start.layout start.state",
     geometry_closes},
    {"chain.pitch half.width", pitch_clears_halves},
    {"chain.pitch chain.pins", pitches_fit},
    {"plate.span half.length", plates_on_pin},
    {"joint.radius half.width", profile_is_round},
    {"pulley.innermost pulley.outermost", radii_ordered},
    {"pulley.arc_position pulley.innermost pulley.outermost", arc_on_sheave},
    {"start.layout detail.pulleys", layout_has_pulleys},
    {"start.ramp_time start.settling_time start.layout", ramp_within_settling},
    {"control.enabled detail.pulleys", control_has_pulleys},
    {"control.enabled control.quantity drive.speed drive.mode", control_has_speed},
    {"load.mode load.speed", load_has_speed},
    {"drive.mode load.mode detail.pulleys", couplings_have_pulleys},
    {"control.driven control.quantity control.enabled", controllers_differ},
    {"run.until detail.pulleys", steady_has_pulleys},
    {"control.gains control.enabled control.quantity clamping.driven", gains_are_of_the_ratio},
    {"run.output_interval run.step", outputs_take_steps},
    {"run.followed_pin chain.pins", followed_pin_exists},
    {"run.segments chain.pins", segments_have_links},
    {"run.method", method_exists},
    {"run.method detail.pins detail.friction tip.friction_law imperfection.runout imperfection.unbalance", method_takes_machine},
    {"run.assembly detail.pins", assembly_takes_pins},
    {"detail.pins detail.order detail.plates detail.stick_slip joint.law", rigid_pins_are_simple},
    {"detail.pins run.schedule run.segments", rigid_pins_are_serial},
    {"run.step_control run.method", method_estimates_error},
    {"record.channels", channels_exist},
    {"run.schedule", executor_exists},
    {"tip.friction_table tip.limiting_traction tip.friction_law tip.friction_coefficient", tip_law_has_its_largest},
    {"tip.friction_memory tip.friction_law detail.pins detail.friction run.method", tip_law_suits_steps},
    {"imperfection.attachment imperfection.runout imperfection.misalignment imperfection.unbalance imperfection.pin_length_spread "
     "detail.pulleys",
     imperfections_have_pulleys},
    {"imperfection.unbalance pulley.sheave_mass pulley.sheave_polar_inertia", unbalance_is_small},
    {"vehicle.mass vehicle.wheel_radius vehicle.final_drive vehicle.drag_area load.mode detail.pulleys", vehicle_loads_shaft},
    {"cycle.speed cycle.begin cycle.pedal_time cycle.min_ratio cycle.max_ratio vehicle.mass drive.mode control.enabled control.quantity",
     cycle_is_driven},
    {"drag.driving_seals drag.driving_viscous drag.driving_churning drag.driven_seals drag.driven_viscous drag.driven_churning "
     "drag.bearing_friction detail.pulleys",
     drag_has_shafts},
    {"guide.stiffness start.ratio detail.pulleys", guide_has_strands},
    {"guide.begin guide.end guide.stiffness", guide_begins_before_it_ends},
    {"hydraulics.mode detail.pulleys", hydraulics_have_pulleys},
    {"hydraulics.oil_volume hydraulics.oil_modulus hydraulics.valve_conductance hydraulics.driving_area hydraulics.driven_area "
     "pulley.sheave_mass",
     oil_is_slow},
    {"hydraulics.feed_radius hydraulics.driving_area hydraulics.driven_area hydraulics.driving_inner hydraulics.driven_inner",
     oil_is_behind_pistons},
    {"hydraulics.pump_ratio hydraulics.pump_speed hydraulics.pump_displacement", pump_turns},
};

}  // namespace

std::span<const CrossCheck> cross_checks() {
    static const std::vector<CrossCheck> all = [] {
        std::vector<CrossCheck> checks;
        for (const Row& row : rows_of_checks) checks.push_back({words_of(row.keys), row.violation});
        return checks;
    }();
    return all;
}

}  // namespace cvtflow::tasks
