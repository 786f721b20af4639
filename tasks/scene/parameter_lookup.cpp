/// Searches in the table of parameters: rows by key, kinds by member, the keys that were probably meant, keys in which scenes differ,
/// keys without effect.

#include <fmt/format.h>
#include <algorithm>

#include "engine/base/text.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml_tree.hpp"

namespace cvtflow::tasks {

namespace {

constexpr std::size_t max_suggested = 3;

/// Names that the field, or other programs, use for a quantity whose key has another name.
struct Synonyms {
    std::string_view key, names;  ///< names: separated by spaces
};
constexpr Synonyms synonyms[] = {
    {"tip.angle", "sheave_angle cone_angle flank_angle wedge_angle half_angle groove_angle pulley_angle"},
    {"tip.friction_coefficient", "mu friction"},
    {"pulley.centre_distance", "center_distance axis_distance"},
    {"pulley.arc_radius", "crowning"},
    {"pulley.innermost", "min_radius"},
    {"pulley.outermost", "max_radius"},
    {"chain.pins", "links number_of_pins"},
    {"half.length", "pin_length"},
    {"half.width", "pin_width"},
    {"half.mass", "pin_mass"},
    {"plate.count", "plates"},
    {"drive.speed", "rpm input_speed engine_speed"},
    {"drive.torque", "input_torque engine_torque"},
    {"load.torque", "output_torque load_torque"},
    {"load.speed", "output_speed"},
    {"clamping.driven", "clamping_force axial_force thrust"},
    {"clamping.safety", "safety_factor"},
    {"run.until", "duration end end_time stop_time"},
    {"run.step", "time_step timestep dt step_size"},
    {"run.method", "solver integrator"},
    {"run.output_interval", "sample_time output_step"},
};

/// Whether a list of words contains the word, or its section: "heat.".
bool lists(std::string_view list, std::string_view key) {
    return std::ranges::any_of(words_of(list),
                               [key](std::string_view word) { return word == key || (word.ends_with('.') && key.starts_with(word)); });
}

/// Keys that act under a condition only.
struct Condition {
    std::string_view keys;  ///< separated by spaces; "heat.": a section
    bool (*acts)(const Scene&);
    std::string_view otherwise;  ///< reason why they have no effect
};

bool is_lubricated(const Scene& s) { return s.parameters.tip.friction_law == model::TipFriction::lubricated; }

bool has_affected_sheave(const Scene& s) {
    const auto& of = s.parameters.imperfection;
    return of.runout != 0.0 || of.attachment != 1.0 || of.unbalance != 0.0;
}

using model::DriveMode;
using model::LoadMode;

constexpr Condition conditions[] = {
    {"oil.temperature", [](const Scene& s) { return is_lubricated(s) || s.parameters.heat.enabled; },
     "tip.friction_law is not \"lubricated\" and heat.enabled is false"},
    {"oil.viscosity_40 oil.viscosity_100 oil.pressure_viscosity tip.limiting_traction tip.roughness", is_lubricated,
     "tip.friction_law is not \"lubricated\""},
    {"tip.friction_table", [](const Scene& s) { return s.parameters.tip.friction_law == model::TipFriction::table; },
     "tip.friction_law is not \"table\""},
    {"tip.reference_pressure", [](const Scene& s) { return s.parameters.tip.pressure_sensitivity != 0.0; },
     "tip.pressure_sensitivity is 0"},
    {"detail.smoothing", [](const Scene& s) { return s.parameters.detail.friction == model::FrictionLaw::smoothed; },
     "detail.friction is not \"smoothed\""},
    {"heat.", [](const Scene& s) { return s.parameters.heat.enabled; }, "heat.enabled is false"},
    {"hydraulics.", [](const Scene& s) { return s.parameters.hydraulics.mode != model::HydraulicMode::none; },
     "hydraulics.mode is \"none\""},
    {"guide.", [](const Scene& s) { return s.parameters.guide.present(); }, "guide.stiffness is 0"},
    {"vehicle.", [](const Scene& s) { return s.vehicle.present(); }, "vehicle.mass is 0"},
    {"cycle.", [](const Scene& s) { return s.cycle.present(); }, "cycle.speed is 0"},
    {"drive.torque", [](const Scene& s) { return s.parameters.drive.mode == DriveMode::torque; }, "drive.mode is not \"torque\""},
    {"drive.coupling_stiffness drive.coupling_damping", [](const Scene& s) { return s.parameters.drive.mode == DriveMode::coupling; },
     "drive.mode is not \"coupling\""},
    {"load.speed", [](const Scene& s) { return s.parameters.load.mode != LoadMode::torque; }, "load.mode is \"torque\""},
    {"load.governor_frequency", [](const Scene& s) { return s.parameters.load.mode == LoadMode::speed; }, "load.mode is not \"speed\""},
    {"load.coupling_stiffness load.coupling_damping", [](const Scene& s) { return s.parameters.load.mode == LoadMode::coupling; },
     "load.mode is not \"coupling\""},
    {"drag.bearing_diameter", [](const Scene& s) { return s.parameters.drag.bearing_friction != 0.0; }, "drag.bearing_friction is 0"},
    {"imperfection.sheave", has_affected_sheave, "the sheave has no runout, unbalance or other attachment"},
    {"imperfection.pin_length_seed", [](const Scene& s) { return s.parameters.imperfection.pin_length_spread != 0.0; },
     "imperfection.pin_length_spread is 0"},
    {"control.ratio control.slip control.safety control.proportional control.integral control.authority control.quantity",
     [](const Scene& s) { return s.parameters.control.enabled; }, "control.enabled is false"},
    {"control.driven_proportional control.driven_integral control.driven_authority",
     [](const Scene& s) { return s.parameters.control.driven != model::DrivenControl::none; }, "control.driven is \"none\""},
    {"start.ring_speed", [](const Scene& s) { return s.parameters.start.layout == model::StartLayout::ring; },
     "start.layout is not \"ring\""},
    {"run.state_interval", [](const Scene& s) { return s.run.state_interval >= s.run.output_interval; },
     "run.output_interval is longer: states are recorded at outputs"},
    {"run.steady run.steady_limit", [](const Scene& s) { return s.run.until.automatic(); }, "run.until is not \"steady\""},
    {"run.tolerance", [](const Scene& s) { return s.run.step_control == StepControl::error; }, "run.step_control is not \"error\""},
};

}  // namespace

std::vector<std::string_view> words_of(std::string_view text) {
    std::vector<std::string_view> words;
    while (!text.empty()) {
        words.push_back(text.substr(0, text.find(' ')));
        text.remove_prefix(std::min(text.size(), words.back().size() + 1));
    }
    return words;
}

Kind Parameter::kind() const {
    using enum Kind;
    static constexpr Kind kinds[] = {number,      integer,    integer,     integer,     boolean,  text,
                                     number_list, time_table, speed_table, auto_number, text_list};
    Scene scene;
    const std::size_t index = member(scene).index();
    return index < std::size(kinds) ? kinds[index] : choice;
}

const Parameter* find_parameter(std::string_view key) {
    const auto rows = parameter_table();
    const auto row = std::ranges::find(rows, key, &Parameter::key);
    return row == rows.end() ? nullptr : &*row;
}

std::vector<std::string> nearest_keys(std::string_view key) {
    const auto rows = parameter_table();
    const std::string_view name = key.substr(key.find('.') + 1);
    std::vector<std::string> keys;
    for (const Parameter& parameter : rows) keys.emplace_back(parameter.key);
    const std::string near = engine::closest(key, keys);
    if (!near.empty() && engine::edit_distance(key, near) <= 2) return {near};
    for (const Parameter& parameter : rows)
        if (name.size() > 2 && parameter.key.starts_with(key)) return {std::string(parameter.key)};
    const auto synonym = std::ranges::find_if(synonyms, [&](const Synonyms& each) { return lists(each.names, name); });
    if (synonym != std::end(synonyms)) return {std::string(synonym->key)};
    std::vector<std::string> of_that_name;
    for (const Parameter& parameter : rows)
        if (parameter.name() == name) of_that_name.emplace_back(parameter.key);
    // A dial of detail may have the name of what it is a detail of, which is meant more often.
    std::stable_partition(of_that_name.begin(), of_that_name.end(), [](const std::string& one) { return !one.starts_with("detail."); });
    if (of_that_name.size() > max_suggested) of_that_name.resize(max_suggested);
    if (of_that_name.empty() && !near.empty()) of_that_name.push_back(near);
    return of_that_name;
}

std::string key_hint(std::string_view key) {
    // Keys of earlier versions (docs/stability.md).
    if (key == order_key) return " (pin halves always have order 3: omit the key, or use detail.level = \"fine\" or \"rigid\")";
    if (key == "detail.mass_scaling") return " (gone since 1.0: masses are those of the machine; omit the key)";
    return engine::did_you_mean(nearest_keys(key));
}

std::string choice_hint(std::string_view value, const std::vector<std::string>& choices) {
    if (value == "medium" && std::ranges::count(choices, "fine") > 0) return " (use \"fine\", or \"rigid\" at lower cost)";
    return engine::did_you_mean(engine::closest(value, choices));
}

std::vector<const Entry*> level_first(const std::vector<Entry>& rows) {
    std::vector<const Entry*> ordered;
    for (const Entry& row : rows) ordered.push_back(&row);
    std::stable_partition(ordered.begin(), ordered.end(), [](const Entry* row) { return row->key == "level" || row->key == level_key; });
    return ordered;
}

std::vector<std::string> section_names() {
    std::vector<std::string> names;
    for (const Parameter& parameter : parameter_table())
        if (names.empty() || names.back() != parameter.section()) names.emplace_back(parameter.section());
    return names;
}

std::vector<KeyDifference> differing_keys(const Scene& a, const Scene& b, const std::function<bool(const Parameter&)>& counts,
                                          std::string (*text)(const Parameter&, const Scene&)) {
    std::vector<KeyDifference> keys;
    for (const Parameter& key : parameter_table()) {
        if (!counts(key)) continue;
        KeyDifference each{&key, text(key, a), text(key, b)};
        if (each.a != each.b) keys.push_back(std::move(each));
    }
    return keys;
}

std::vector<std::string> idle_keys(const Scene& scene) {
    std::vector<std::string> lines;
    for (const Condition& row : conditions) {
        if (row.acts(scene)) continue;
        std::vector<std::string_view> idle;
        const auto listed = [&row](const Parameter& key) { return lists(row.keys, key.key); };
        for (const KeyDifference& each : differing_keys(scene, Scene{}, listed)) idle.push_back(each.key->key);
        if (!idle.empty()) lines.push_back(fmt::format("{}: no effect, since {}", fmt::join(idle, ", "), row.otherwise));
    }
    return lines;
}

}  // namespace cvtflow::tasks
