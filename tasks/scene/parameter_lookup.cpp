/// Searches in the table of parameters: rows by key, kinds by member, the keys that were probably meant, keys in which scenes differ.

#include <algorithm>
#include <array>

#include "engine/base/text.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml_tree.hpp"

namespace cvtflow::tasks {

namespace {

constexpr std::size_t max_suggested = 3;

/// Name that the field, or other programs, use for a quantity whose key has another name.
struct Synonym {
    std::string_view name, key;
};
constexpr Synonym synonyms[] = {
    {"sheave_angle", "tip.angle"},
    {"cone_angle", "tip.angle"},
    {"flank_angle", "tip.angle"},
    {"wedge_angle", "tip.angle"},
    {"half_angle", "tip.angle"},
    {"groove_angle", "tip.angle"},
    {"pulley_angle", "tip.angle"},
    {"mu", "tip.friction_coefficient"},
    {"friction", "tip.friction_coefficient"},
    {"center_distance", "pulley.centre_distance"},
    {"axis_distance", "pulley.centre_distance"},
    {"crowning", "pulley.arc_radius"},
    {"min_radius", "pulley.innermost"},
    {"max_radius", "pulley.outermost"},
    {"links", "chain.pins"},
    {"number_of_pins", "chain.pins"},
    {"pin_length", "half.length"},
    {"pin_width", "half.width"},
    {"pin_mass", "half.mass"},
    {"plates", "plate.count"},
    {"rpm", "drive.speed"},
    {"input_speed", "drive.speed"},
    {"engine_speed", "drive.speed"},
    {"input_torque", "drive.torque"},
    {"engine_torque", "drive.torque"},
    {"output_torque", "load.torque"},
    {"load_torque", "load.torque"},
    {"output_speed", "load.speed"},
    {"clamping_force", "clamping.driven"},
    {"axial_force", "clamping.driven"},
    {"thrust", "clamping.driven"},
    {"safety_factor", "clamping.safety"},
    {"duration", "run.until"},
    {"end", "run.until"},
    {"end_time", "run.until"},
    {"stop_time", "run.until"},
    {"time_step", "run.step"},
    {"timestep", "run.step"},
    {"dt", "run.step"},
    {"step_size", "run.step"},
    {"solver", "run.method"},
    {"integrator", "run.method"},
    {"sample_time", "run.output_interval"},
    {"output_step", "run.output_interval"},
};

}  // namespace

Kind Parameter::kind() const {
    static constexpr std::array kinds{Kind::number, Kind::integer,     Kind::integer,     Kind::integer,     Kind::boolean,
                                      Kind::text,   Kind::number_list, Kind::time_table,  Kind::speed_table, Kind::choice,
                                      Kind::choice, Kind::choice,      Kind::choice,      Kind::choice,      Kind::choice,
                                      Kind::choice, Kind::choice,      Kind::choice,      Kind::choice,      Kind::choice,
                                      Kind::choice, Kind::choice,      Kind::choice,      Kind::choice,      Kind::choice,
                                      Kind::choice, Kind::choice,      Kind::auto_number, Kind::text_list};
    static_assert(kinds.size() == std::variant_size_v<Slot>);
    Scene scene;
    return kinds[member(scene).index()];
}

const Parameter* find_parameter(std::string_view key) {
    const auto rows = parameter_table();
    const auto row = std::ranges::find_if(rows, [&](const Parameter& parameter) { return parameter.key == key; });
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
    const auto synonym = std::ranges::find_if(synonyms, [&](const Synonym& each) { return each.name == name; });
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

}  // namespace cvtflow::tasks
