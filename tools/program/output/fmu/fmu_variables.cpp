#include "tools/program/output/fmu/fmu_variables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <string_view>

#include "engine/base/text.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/units.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::tools {

namespace {

using Names = std::vector<std::string>;

/// What an importer gets unless others are named; of them those that the scene has.
constexpr std::string_view usual_outputs[] = {
    "shaft_1/speed",    "shaft_2/speed", "shaft_1/torque", "shaft_1/chain_torque", "shaft_2/chain_torque", "shaft_1/clamping",
    "shaft_2/clamping", "ratio",         "slip",           "efficiency",           "loss/total",           "balance/suspicion"};
constexpr std::string_view usual_parameters[] = {"drive.inertia",
                                                 "drive.governor_frequency",
                                                 "load.inertia",
                                                 "load.linear",
                                                 "load.quadratic",
                                                 "plate.friction_coefficient",
                                                 "joint.friction_coefficient",
                                                 "tip.friction_coefficient",
                                                 "pulley.cylinder_damping",
                                                 "clamping.safety",
                                                 "control.proportional",
                                                 "control.integral"};

[[nodiscard]] bool is_in(const Names& names, std::string_view name) { return std::find(names.begin(), names.end(), name) != names.end(); }

/// The wanted names; `all` if that is the only one; the usual ones that are there if none is wanted. @param known  all that may be wanted
Names chosen(const char* option, const Names& wanted, const Names& known, const Names& all, std::span<const std::string_view> usual) {
    if (wanted == Names{"all"}) return all;
    for (const std::string& name : wanted) {
        if (is_in(known, name)) continue;
        throw UsageError(fmt::format("{}: the scene has no '{}'{}", option, name, engine::did_you_mean(engine::closest(name, known))));
    }
    if (!wanted.empty()) return wanted;
    Names kept;
    for (const std::string_view name : usual) {
        if (is_in(known, name)) kept.emplace_back(name);
    }
    return kept.empty() ? all : kept;
}

/// A channel's name in the standard's structured convention.
std::string structured(std::string name) {
    std::replace(name.begin(), name.end(), '/', '.');
    return name;
}

/// 10^n nearest below the magnitude; 0 for 0.
double magnitude(double value) {
    const double size = std::abs(value);
    return size > 0.0 && std::isfinite(size) ? std::pow(10.0, std::floor(std::log10(size))) : 0.0;
}

/// What people read a quantity in; empty where that is the SI unit, has an offset (K), or scenes do not know the unit (J, W).
std::string display_unit(const std::string& unit) {
    if (unit == "N*m" || unit == "J" || unit == "W" || unit == "K") return "";
    const auto usual = tasks::usual_units(unit);
    return usual.empty() ? "" : std::string(usual.front());
}

void add_range(FmuVariable& row, const tasks::Parameter& key) {
    row.min = key.min;
    row.max = key.max;
    row.nominal = magnitude(row.start);
    row.display_unit = display_unit(row.unit);
}

/// hydraulics.driving_pressure of pressure_driving.
bool is_pressure_of(std::string_view key, std::string_view input) {
    constexpr std::string_view group = "pressure_", section = "hydraulics_", quantity = "_pressure";
    return input.starts_with(group) && key.starts_with(section) && key.ends_with(quantity) &&
           key.substr(section.size(), key.size() - section.size() - quantity.size()) == input.substr(group.size());
}

/// The key whose table an input replaces: load.torque of load_torque, control.ratio of ratio.
const tasks::Parameter* key_of_input(std::string_view name) {
    for (const tasks::Parameter& row : tasks::parameter_table()) {
        std::string flat(row.key);
        std::replace(flat.begin(), flat.end(), '.', '_');
        if (row.kind() == tasks::Kind::time_table && (flat == name || flat == "control_" + std::string(name) || is_pressure_of(flat, name)))
            return &row;
    }
    return nullptr;
}

std::vector<FmuVariable> inputs(const Simulation& simulation, const Names& wanted) {
    std::vector<FmuVariable> rows;
    Names names;
    for (int number = 0; number <= static_cast<int>(Input::pressure_driven); ++number) {
        const auto input = static_cast<Input>(number);
        const InputInfo info = input_info(input);
        try {
            rows.push_back({0, "input", std::string(info.name), std::string(info.unit), std::string(info.description), 1,
                            simulation.input(input), std::string(info.name)});
            names.emplace_back(info.name);
        } catch (const Error&) {  // not in this scene
            continue;
        }
        if (info.name == "ratio") rows.back().name = "ratio_target";  // an output has its name
        if (const tasks::Parameter* key = key_of_input(info.name)) add_range(rows.back(), *key);
    }
    std::vector<std::string_view> usual;  // an importer that sets every input would hold an angle at its start value
    std::copy_if(names.begin(), names.end(), std::back_inserter(usual), [](const std::string& name) { return !name.ends_with("_angle"); });
    const Names kept = chosen("--inputs", wanted, names, names, usual);
    std::erase_if(rows, [&](const FmuVariable& row) { return !is_in(kept, row.source); });
    return rows;
}

std::vector<FmuVariable> outputs(Simulation& simulation, const Names& wanted, bool arrays) {
    Names names, scalars;
    for (std::size_t index = 0; index < simulation.channels(); ++index) {
        const ChannelInfo info = simulation.channel_info(index);
        names.emplace_back(info.name);
        if (info.width == 1) scalars.emplace_back(info.name);
    }
    std::vector<FmuVariable> rows;
    for (const std::string& channel : chosen("--outputs", wanted, names, scalars, usual_outputs)) {
        const ChannelInfo info = simulation.channel_info(simulation.find_channel(channel));
        const std::span<const double> now = simulation.channel(channel);
        const double largest =
            std::abs(*std::max_element(now.begin(), now.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
        const std::string name = structured(channel);
        const bool whole = arrays || info.width == 1;
        for (std::size_t element = 0; element < (whole ? 1 : info.width); ++element) {
            rows.push_back({0, "output", whole ? name : fmt::format("{}[{}]", name, element), std::string(info.unit),
                            std::string(info.description), whole ? info.width : 1, 0.0, channel, element});
            rows.back().nominal = magnitude(largest);
            rows.back().display_unit = display_unit(rows.back().unit);
        }
    }
    return rows;
}

/// Numbers of the machine. Keys that determine the size of the state, the method or the run remain as exported.
std::vector<FmuVariable> parameters(const Scene& scene, const Names& wanted) {
    Names keys;
    for (const tasks::Parameter& row : tasks::parameter_table()) {
        if (row.kind() == tasks::Kind::number && row.section() != "run" && row.section() != "start") keys.emplace_back(row.key);
    }
    std::vector<FmuVariable> rows;
    for (const std::string& key : chosen("--parameters", wanted, keys, keys, usual_parameters)) {
        const tasks::Parameter& row = *tasks::find_parameter(key);
        rows.push_back(
            {0, "parameter", key, std::string(row.unit), std::string(row.meaning), 1, engine::number_of(scene.value(key)).value(), key});
        add_range(rows.back(), row);
    }
    return rows;
}

}  // namespace

std::vector<FmuVariable> fmu_variables(Simulation& simulation, const FmuChoice& choice, bool arrays) {
    std::vector<FmuVariable> all{{0, "time", "time", "s", "simulated time", 1, 0.0, "time"}};
    for (auto& rows : {inputs(simulation, choice.inputs), outputs(simulation, choice.outputs, arrays),
                       parameters(simulation.scene(), choice.parameters)})
        all.insert(all.end(), rows.begin(), rows.end());
    for (std::size_t number = 0; number < all.size(); ++number) all[number].reference = static_cast<std::uint32_t>(number);
    return all;
}

std::string variables_text(const std::vector<FmuVariable>& variables) {
    std::string text;
    for (const FmuVariable& row : variables)
        text += fmt::format("{} {} {} {} {}\n", row.reference, row.kind, row.width, row.source, row.element);
    return text;
}

}  // namespace cvtflow::tools
