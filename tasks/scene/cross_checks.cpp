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
using Violation = std::optional<std::string>;

bool always(const Scene& /*scene*/) { return true; }
bool has_pulleys(const Scene& s) { return s.parameters.detail.pulleys != model::PulleyDetail::absent; }
bool has_elastic_pulleys(const Scene& s) { return s.parameters.detail.pulleys == model::PulleyDetail::elastic; }
bool has_rigid_pins(const Scene& s) { return s.parameters.detail.pins == model::PinDetail::rigid; }
bool has_guides(const Scene& s) { return s.parameters.guide.present(); }
bool has_cylinders(const Scene& s) { return s.parameters.hydraulics.mode != model::HydraulicMode::none; }
bool has_vehicle(const Scene& s) { return s.vehicle.present(); }
bool has_cycle(const Scene& s) { return s.cycle.present(); }
bool has_control(const Scene& s) { return s.parameters.control.enabled; }
bool has_second_control(const Scene& s) { return s.parameters.control.driven != model::DrivenControl::none; }
bool controls_ratio(const Scene& s) { return has_control(s) && s.parameters.control.quantity == model::ControlledQuantity::ratio; }
bool finds_gains(const Scene& s) { return s.gains != ControlGains::given; }
bool holds_sheave(const Scene& s) { return s.when_steady == WhenSteady::hold; }
bool couples_drive(const Scene& s) { return s.parameters.drive.mode == DriveMode::coupling; }
bool couples_load(const Scene& s) { return s.parameters.load.mode != model::LoadMode::torque; }
bool starts_as_belt(const Scene& s) { return s.parameters.start.layout == model::StartLayout::belt; }
bool has_radii(const Scene& s) { return s.parameters.pulley.innermost < s.parameters.pulley.outermost; }
bool tips_remember(const Scene& s) { return s.parameters.tip.friction_memory > 0.0; }
bool has_friction_table(const Scene& s) { return s.parameters.tip.friction_law == model::TipFriction::table; }
bool has_tip_law(const Scene& s) { return s.parameters.tip.friction_law != model::TipFriction::constant; }

/// A length in mm with four digits, for messages.
std::string mm(double length) { return fmt::format("{:.4g} mm", 1e3 * length); }

std::string seconds(double time) { return number_text(time) + " s"; }

Violation imperfections_have_pulleys(const Scene& scene) {
    const model::Imperfection& i = scene.parameters.imperfection;
    const std::string_view present = i.pin_length_spread != 0.0 ? "pin_length_spread"
                                     : i.unbalance != 0.0       ? "unbalance"
                                     : i.attachment != 1.0      ? "attachment"
                                     : i.runout != 0.0          ? "runout"
                                     : i.misalignment != 0.0    ? "misalignment"
                                                                : "";
    if (present.empty() || has_pulleys(scene)) return {};
    return fmt::format("imperfection.{}: imperfections are of pulleys, which are absent", present);
}

/// The centre of mass is well inside of the sheave, so that its inertia about that is positive.
Violation unbalance_is_small(const Scene& scene) {
    const auto& [pulley, i] = std::tie(scene.parameters.pulley, scene.parameters.imperfection);
    const double most = std::sqrt(0.1 * pulley.sheave_mass * pulley.sheave_polar_inertia);
    if (i.unbalance <= most) return {};
    return fmt::format("imperfection.unbalance: {} kg*m is too much for a sheave of this mass and inertia, which bears {:.2g}",
                       number_text(i.unbalance), most);
}

/// Oil as a spring against the sheave's mass, and its flow through a valve, are slow beside the steps of every method.
Violation oil_is_slow(const Scene& scene) {
    const auto& of = scene.parameters.hydraulics;
    if (!has_cylinders(scene)) return {};
    constexpr double fastest = 1e5;  // [rad/s]: half a radian in 5 us; the longest automatic step is 7.5 us
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
        if (has_cylinders(scene) && of.feed_radius > outer)
            return fmt::format("hydraulics.feed_radius: {:.4g} mm is beyond the outer radius of hydraulics.{}_area, {:.4g} mm",
                               1e3 * of.feed_radius, name, 1e3 * outer);
    }
    return {};
}

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
    if (!starts_as_belt(scene) || !has_pulleys(scene) || !has_radii(scene) || !scene.state_file.empty()) return {};
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

Violation vehicle_loads_within_range(const Scene& scene) {
    const auto& [drive, load] = std::tie(scene.parameters.drive, scene.parameters.load);
    for (const auto& [key, value] : {std::pair{"load.inertia", load.inertia},
                                     {"load.quadratic", load.quadratic},
                                     {"load.torque", load.torque.largest_magnitude()},
                                     {"drive.speed", drive.speed.largest_magnitude()}}) {
        const Parameter& row = *find_parameter(key);
        if (has_vehicle(scene) && is_derived(scene, key) && value > row.max)
            return fmt::format("vehicle.mass: {} = {} {} follows from the vehicle, above {}", key, number_text(value), row.unit,
                               number_text(row.max));
    }
    return {};
}

Violation cycle_has_time(const Scene& scene) {
    const model::Cycle& cycle = scene.cycle;
    if (!has_cycle(scene)) return {};
    if (cycle.begin >= cycle.speed.time.back())
        return fmt::format("cycle.begin: {} is not before the end of cycle.speed, {}", seconds(cycle.begin),
                           seconds(cycle.speed.time.back()));
    if (cycle.intervals() < static_cast<double>(max_points)) return {};
    return fmt::format("cycle.pedal_time: {} divides the cycle into more than {} points", seconds(cycle.pedal_time), max_points);
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
    return fmt::format("record.channels: unknown channel '{}'{} (cvtflow list channels)", unknown.front(), channel_hint(unknown.front()));
}

Violation executor_exists(const Scene& scene) {
    const std::string& name = scene.run.schedule;
    if (name == "auto" || engine::find_executor(name) != nullptr) return {};
    constexpr std::array<std::string_view, 1> others{"auto"};
    return fmt::format("run.schedule: unknown executor '{}'{} (cvtflow list executors; or auto)", name,
                       engine::missing_executor(name, others));
}

/// The text with the value of a key in place of "{key}"; of "{key mm}", "{key s}" with its unit; of "{key/2 mm}" half of it.
std::string with_values(std::string_view text, Scene scene) {
    const auto number = [](const auto* member) -> double {
        if constexpr (std::is_convertible_v<decltype(*member), double>) return static_cast<double>(*member);
        throw std::logic_error("no number");
    };
    std::string filled;
    while (true) {
        const auto begin = text.find('{'), end = text.find('}');
        filled += text.substr(0, begin);
        if (begin == text.npos) return filled;
        const auto words = words_of(text.substr(begin + 1, end - begin - 1));
        const std::string_view key = words.front().substr(0, words.front().find('/'));
        const double value = std::visit(number, find_parameter(key)->member(scene)) / (key == words.front() ? 1.0 : 2.0);
        filled += words.back() == "mm" ? mm(value) : words.back() == "s" ? seconds(value) : number_text(value);
        text.remove_prefix(end + 1);
    }
}

/// Requirement that the values of some keys must satisfy together.
struct Row {
    std::string_view keys{};                    ///< keys of the CrossCheck; empty: those of the row above, if it found nothing
    bool (*when)(const Scene&) = nullptr;       ///< condition of the requirement
    bool (*required)(const Scene&) = nullptr;   ///< the requirement
    std::string_view violation{};               ///< text for with_values()
    Violation (*find)(const Scene&) = nullptr;  ///< instead of the three, where code is necessary
};
constexpr std::string_view also;
constexpr Row rows[] = {
    // A name becomes part of files' names, and both go onto terminals and into other files.
    {.keys = "scene.name",
     .find =
         [](const Scene& s) {
             const std::string wrong = engine::name_problem(s.name);
             return wrong.empty() ? Violation{} : fmt::format("scene.name: {} {}", toml_text(s.name.substr(0, 60)), wrong);
         }},
    {.keys = "scene.description",
     .find =
         [](const Scene& s) {
             const std::string wrong = engine::text_problem(s.description);
             return wrong.empty() ? Violation{} : "scene.description: " + wrong;
         }},
    {.keys = "chain.pins chain.pitch pulley.centre_distance start.ratio pulley.innermost pulley.outermost detail.pulleys start.layout "
             "start.state",
     .find = geometry_closes},
    {.keys = "chain.pitch half.width",
     .find =
         [](const Scene& s) {
             const double smallest = *std::ranges::min_element(s.parameters.chain.pitch), width = s.parameters.half.width;
             if (smallest > width) return Violation{};
             return Violation{fmt::format("chain.pitch: {} is not larger than half.width = {}", mm(smallest), mm(width))};
         }},
    {.keys = "chain.pitch chain.pins",
     .find =
         [](const Scene& s) {
             const auto& chain = s.parameters.chain;
             if (chain.pitch.size() <= static_cast<std::size_t>(chain.pins)) return Violation{};
             return Violation{fmt::format("chain.pitch: {} pitches for chain.pins = {}", chain.pitch.size(), chain.pins)};
         }},
    {"plate.span half.length", always, [](const Scene& s) { return s.parameters.plate.span <= 0.5 * s.parameters.half.length; },
     "plate.span: {plate.span mm} is beyond the end of the pin, half.length/2 = {half.length/2 mm}"},
    {"joint.radius half.width", always, [](const Scene& s) { return s.parameters.joint.radius > 0.5 * s.parameters.half.width; },
     "joint.radius: {joint.radius mm} is not larger than half.width/2 = {half.width/2 mm}"},
    {"pulley.innermost pulley.outermost", always, has_radii,
     "pulley.innermost: {pulley.innermost mm} is not smaller than pulley.outermost = {pulley.outermost mm}"},
    {"pulley.arc_position pulley.innermost pulley.outermost", has_radii,
     [](const Scene& s) {
         const auto& pulley = s.parameters.pulley;
         return pulley.arc_position >= pulley.innermost && pulley.arc_position <= pulley.outermost;
     },
     "pulley.arc_position: {pulley.arc_position mm} is outside pulley.innermost = {pulley.innermost mm} to pulley.outermost = "
     "{pulley.outermost mm}"},
    {"start.layout detail.pulleys", starts_as_belt, has_pulleys,
     "start.layout: \"belt\" requires pulleys, but detail.pulleys is \"absent\""},
    {also, has_pulleys, starts_as_belt, "start.layout: \"ring\" requires detail.pulleys = \"absent\""},
    {"start.ramp_time start.settling_time start.layout",
     [](const Scene& s) { return starts_as_belt(s) && s.parameters.start.settling_time > 0.0; },
     [](const Scene& s) { return s.parameters.start.ramp_time <= s.parameters.start.settling_time; },
     "start.ramp_time: {start.ramp_time s} is longer than start.settling_time = {start.settling_time s}"},
    {"control.enabled detail.pulleys", has_control, has_pulleys,
     "control.enabled: control requires pulleys, but detail.pulleys is \"absent\""},
    {"control.enabled control.quantity drive.speed drive.mode", controls_ratio,
     [](const Scene& s) { return s.parameters.drive.mode == DriveMode::torque || s.parameters.drive.speed.largest_magnitude() > 0.0; },
     "control.enabled: the control error is relative to drive.speed, which is always 0"},
    {"load.mode load.speed", couples_load, [](const Scene& s) { return s.parameters.load.speed.largest_magnitude() > 0.0; },
     "load.mode: \"speed\" and \"coupling\" need load.speed, which is 0 throughout"},
    {"drive.mode load.mode detail.pulleys", couples_drive, has_pulleys,
     "drive.mode: couplings need pulleys, but detail.pulleys is \"absent\""},
    {also, couples_load, has_pulleys, "load.mode: couplings need pulleys, but detail.pulleys is \"absent\""},
    {"control.driven control.quantity control.enabled", has_second_control, has_control,
     "control.driven: the second controller requires the first one, but control.enabled is false"},
    {also, has_second_control, controls_ratio, "control.driven: control.quantity already controls the clamping force of shaft 2"},
    {"run.until detail.pulleys", [](const Scene& s) { return s.run.until.automatic(); }, has_pulleys,
     "run.until: \"steady\" is about means of whole pin periods on pulleys, but detail.pulleys is \"absent\""},
    {"control.gains control.enabled control.quantity clamping.driven", finds_gains, controls_ratio,
     "control.gains: \"found\" is about control of the ratio (control.enabled = true, control.quantity = \"ratio\")"},
    {also, finds_gains, [](const Scene& s) { return driven_clamping_at_start(s.parameters) > 0.0; },
     "control.gains: \"found\" requires a clamping force of shaft 2 at t = 0 (clamping.driven, or clamping.safety and a load)"},
    {"run.until heat.enabled heat.pulley_conductance heat.ambient_conductance",
     [](const Scene& s) { return s.run.until.automatic() && s.parameters.heat.enabled; },
     [](const Scene& s) { return std::min(s.parameters.heat.pulley_conductance, s.parameters.heat.ambient_conductance) > 0.0; },
     "run.until: \"steady\" needs heat.pulley_conductance and heat.ambient_conductance above 0: else no temperature is steady"},
    {"clamping.safety clamping.driven hydraulics.driven_pressure load.torque load.linear load.quadratic",
     [](const Scene& s) {
         const auto& [clamping, load] = std::tie(s.parameters.clamping, s.parameters.load);
         return clamping.safety > 0.0 && load.linear == 0.0 && load.quadratic == 0.0;
     },
     [](const Scene& s) { return driven_clamping_at_start(s.parameters) > 0.0; },
     "clamping.safety: without a load at t = 0 shaft 2 has no clamping force; give the least one, clamping.driven "
     "(hydraulics.driven_pressure)"},
    {"control.when_steady control.enabled control.quantity run.until hydraulics.mode", holds_sheave, controls_ratio,
     "control.when_steady: \"hold\" is about control of the ratio (control.enabled = true, control.quantity = \"ratio\")"},
    {also, holds_sheave, [](const Scene& s) { return s.run.until.automatic(); },
     "control.when_steady: \"hold\" is about runs that end when they are steady (run.until = \"steady\")"},
    {also, holds_sheave, [](const Scene& s) { return !has_cylinders(s); },
     "control.when_steady: \"hold\" replaces what makes the clamping force, and so does hydraulics.mode"},
    // An automatic step is 0 here: it becomes shorter where outputs require it.
    {"run.output_interval run.step", always, [](const Scene& s) { return s.run.output_interval >= s.run.step; },
     "run.output_interval: {run.output_interval s} is shorter than run.step = {run.step s}"},
    {"run.followed_pin chain.pins", always, [](const Scene& s) { return s.run.followed_pin < s.parameters.chain.pins; },
     "run.followed_pin: {run.followed_pin} is not below chain.pins = {chain.pins} (pins count from 0)"},
    {"run.segments chain.pins", always, [](const Scene& s) { return s.run.segments <= s.parameters.chain.pins; },
     "run.segments: {run.segments} segments for chain.pins = {chain.pins}"},
    {"run.method", always, [](const Scene& s) { return !s.run.method.empty(); }, "run.method: the name is empty"},
    {.find =
         [](const Scene& s) {  // numbers of a family are checked when the method is made
             return may_be_method(method_of(s)) ? Violation{} : "run.method: " + no_method(s.run.method);
         }},
    {.keys = "run.method chain.pins detail.pins detail.friction tip.friction_law imperfection.runout imperfection.unbalance",
     .find =
         [](const Scene& s) {
             const std::string objection = objection_to(method_of(s), s.parameters);
             return objection.empty() ? Violation{} : "run.method: " + objection;
         }},
    {"run.assembly detail.pins", always, [](const Scene& s) { return has_assembly(s.run.assembly); },
     "run.assembly: \"staged\" belongs to the laboratory: cvtflow-lab run"},
    {also, has_rigid_pins, [](const Scene& s) { return s.run.assembly == Assembly::fused; },
     "run.assembly: \"staged\" requires detail.pins = \"halves\": rigid pins have no separate joints"},
    {"detail.pins detail.plates detail.stick_slip joint.law", has_rigid_pins,
     [](const Scene& s) { return s.parameters.detail.plates == model::PlateDetail::lumped; },
     "detail.plates: detail.pins = \"rigid\" has \"lumped\" plates"},
    {also, has_rigid_pins, [](const Scene& s) { return !s.parameters.detail.stick_slip; },
     "detail.stick_slip: detail.pins = \"rigid\" has no phases stick and slip"},
    {also, has_rigid_pins, [](const Scene& s) { return s.parameters.joint.law == model::JointLaw::linear; },
     "joint.law: detail.pins = \"rigid\" has joints of law \"linear\""},
    {"detail.pins run.schedule run.segments", has_rigid_pins, [](const Scene& s) { return s.run.segments <= 1; },
     "run.segments: detail.pins = \"rigid\" is one segment, not {run.segments}"},
    {.find =
         [](const Scene& s) {
             if (!has_rigid_pins(s) || s.run.schedule == "auto" || s.run.schedule == "serial") return Violation{};
             return Violation{fmt::format("run.schedule: detail.pins = \"rigid\" runs on one thread: \"serial\" or \"auto\", not \"{}\"",
                                          s.run.schedule)};
         }},
    {.keys = "run.step_control run.method", .find = method_estimates_error},
    {.keys = "record.channels", .find = channels_exist},
    {.keys = "run.schedule", .find = executor_exists},
    {"tip.friction_table tip.limiting_traction tip.friction_law tip.friction_coefficient",
     [](const Scene& s) { return s.parameters.tip.friction_law == model::TipFriction::lubricated; },
     [](const Scene& s) { return s.parameters.tip.limiting_traction <= s.parameters.tip.friction.coefficient; },
     "tip.limiting_traction: {tip.limiting_traction} is above tip.friction_coefficient = {tip.friction_coefficient}"},
    {"tip.friction_table tip.friction_law", has_friction_table,
     [](const Scene& s) { return s.parameters.tip.friction_table.speed.size() > 1; },
     "tip.friction_table: tip.friction_law = \"table\" takes its friction from at least two points [speed, coefficient]"},
    {"tip.friction_memory tip.friction_law detail.pins detail.friction run.method", tips_remember, has_tip_law,
     "tip.friction_memory: friction of tip.friction_law = \"constant\" does not depend on the sliding speed"},
    {.find =
         [](const Scene& s) {
             if (!tips_remember(s) || method_of(s) == "leapfrog-rigid") return Violation{};
             return Violation{
                 fmt::format("tip.friction_memory: requires method leapfrog-rigid (detail.pins = \"rigid\"), not {}", method_of(s))};
         }},
    {.keys = "imperfection.attachment imperfection.runout imperfection.misalignment imperfection.unbalance imperfection.pin_length_spread "
             "detail.pulleys",
     .find = imperfections_have_pulleys},
    {also, [](const Scene& s) { return s.parameters.imperfection.attachment != 1.0; }, has_elastic_pulleys,
     "imperfection.attachment: an attachment yields with detail.pulleys = \"elastic\" only"},
    {also, [](const Scene& s) { return s.parameters.imperfection.unbalance != 0.0; }, has_elastic_pulleys,
     "imperfection.unbalance: a sheave yields to it with detail.pulleys = \"elastic\" only"},
    {.keys = "imperfection.unbalance pulley.sheave_mass pulley.sheave_polar_inertia", .find = unbalance_is_small},
    {"vehicle.mass vehicle.wheel_radius vehicle.final_drive vehicle.drag_area load.mode detail.pulleys", has_vehicle, has_pulleys,
     "vehicle.mass: a vehicle needs pulleys, but detail.pulleys is \"absent\""},
    {also, has_vehicle, [](const Scene& s) { return !couples_load(s); },
     "load.mode: a vehicle loads shaft 2 with load.mode = \"torque\" only"},
    {.find = vehicle_loads_within_range},
    {"cycle.speed cycle.begin cycle.pedal_time cycle.min_ratio cycle.max_ratio vehicle.mass drive.mode control.enabled control.quantity",
     has_cycle, has_vehicle, "cycle.speed: a cycle needs a vehicle, but vehicle.mass is 0"},
    {also, has_cycle, [](const Scene& s) { return s.parameters.drive.mode == DriveMode::speed; },
     "drive.mode: a cycle turns shaft 1 with drive.mode = \"speed\" only"},
    {also, has_cycle, controls_ratio,
     "control.enabled: a cycle needs control of the ratio (control.enabled = true, control.quantity = \"ratio\")"},
    {also, has_cycle, [](const Scene& s) { return s.cycle.min_ratio <= s.cycle.max_ratio; },
     "cycle.min_ratio: {cycle.min_ratio} is above cycle.max_ratio = {cycle.max_ratio}"},
    {.find = cycle_has_time},
    {"drag.driving_seals drag.driving_viscous drag.driving_churning drag.driven_seals drag.driven_viscous drag.driven_churning "
     "drag.bearing_friction detail.pulleys",
     [](const Scene& s) { return s.parameters.drag.present(); }, has_pulleys,
     "drag.driving_seals: drag is of shafts, but detail.pulleys is \"absent\""},
    {"guide.stiffness start.ratio detail.pulleys", has_guides, has_pulleys,
     "guide.stiffness: guides are of strands between pulleys, which are absent"},
    {also, has_guides,
     [](const Scene& s) {
         const auto& p = s.parameters;
         return model::belt_radii(model::chain_length(p.chain), p.start.ratio, p.pulley.centre_distance).has_value();
     },
     "guide.stiffness: at start.ratio the chain runs on no radii, and guides have no place"},
    {"guide.begin guide.end guide.stiffness", has_guides, [](const Scene& s) { return s.parameters.guide.begin < s.parameters.guide.end; },
     "guide.begin: {guide.begin} is not before guide.end = {guide.end}"},
    {"hydraulics.mode detail.pulleys", has_cylinders, has_pulleys,
     "hydraulics.mode: cylinders need pulleys, but detail.pulleys is \"absent\""},
    {.keys = "hydraulics.oil_volume hydraulics.oil_modulus hydraulics.valve_conductance hydraulics.driving_area hydraulics.driven_area "
             "pulley.sheave_mass",
     .find = oil_is_slow},
    {.keys = "hydraulics.feed_radius hydraulics.driving_area hydraulics.driven_area hydraulics.driving_inner hydraulics.driven_inner",
     .find = oil_is_behind_pistons},
    {"hydraulics.pump_ratio hydraulics.pump_speed hydraulics.pump_displacement", has_cylinders,
     [](const Scene& s) { return s.parameters.hydraulics.pump_displacement != 0.0; }, "hydraulics.pump_displacement: 0 feeds no cylinder"},
    {also, has_cylinders,
     [](const Scene& s) {
         return s.parameters.hydraulics.pump_ratio > 0.0 || s.parameters.hydraulics.pump_speed.largest_magnitude() > 0.0;
     },
     "hydraulics.pump_ratio: 0 and hydraulics.pump_speed = 0 leave the pump at rest"},
};

Violation find_violation(std::span<const Row> checked, const Scene& scene) {
    for (const Row& row : checked) {
        Violation found = row.find ? row.find(scene) : Violation{};
        if (!row.find && row.when(scene) && !row.required(scene)) found = with_values(row.violation, scene);
        if (found) return found;
    }
    return {};
}

}  // namespace

std::span<const CrossCheck> cross_checks() {
    static const std::vector<CrossCheck> all = [] {
        std::vector<CrossCheck> checks;
        for (auto row = std::begin(rows); row != std::end(rows);) {
            const auto next = std::find_if(row + 1, std::end(rows), [](const Row& each) { return !each.keys.empty(); });
            checks.push_back({words_of(row->keys), [row, next](const Scene& scene) { return find_violation({row, next}, scene); }});
            row = next;
        }
        return checks;
    }();
    return all;
}

}  // namespace cvtflow::tasks
