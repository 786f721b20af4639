#include "tools/program/text/scene_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/text.hpp"
#include "model/machine/belt.hpp"
#include "tasks/run/saved_start.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

/// A choice without the quotes of TOML.
std::string choice(const tasks::Scene& scene, std::string_view key) {
    const std::string text = tasks::value_text(*tasks::find_parameter(key), scene);
    return text.size() > 1 && text.front() == '"' ? text.substr(1, text.size() - 2) : text;
}

double number_of(const std::vector<engine::Attribute>& attributes, std::string_view name) {
    const auto* number = engine::attribute_value<double>(attributes, name);
    return number == nullptr ? 0.0 : *number;
}

}  // namespace

std::string detail_text(const tasks::Scene& scene) {
    const model::Detail& detail = scene.parameters.detail;
    const std::string_view name = tasks::level_of(scene);
    const std::string joints = detail.pins != model::PinDetail::halves
                                   ? fmt::format("{} pins", name_of(detail.pins))
                                   : fmt::format("{} joint point{}", detail.joint_points, detail.joint_points == 1 ? "" : "s");
    const std::string dials =
        fmt::format("{}, {}, {}", detail.plates == model::PlateDetail::each ? "every plate" : "lumped plates", joints,
                    detail.pulleys == model::PulleyDetail::absent ? "no pulleys" : choice(scene, "detail.pulleys") + " pulleys");
    const std::string friction = choice(scene, "detail.friction") + " friction" + (detail.stick_slip ? " with stick and slip" : "");
    return name.empty() ? fmt::format("{}; {}", dials, friction) : fmt::format("{} ({}); {}", name, dials, friction);
}

std::string value_text(const engine::Attribute& attribute) {
    if (const auto* text = std::get_if<std::string>(&attribute.value)) return *text;
    if (const auto* number = std::get_if<double>(&attribute.value)) return fmt::format("{:.6g}", *number);
    return fmt::format("{}", std::get<std::int64_t>(attribute.value));
}

std::string text_of(const std::vector<engine::Attribute>& attributes, std::string_view name, const std::string& otherwise) {
    const auto found = std::ranges::find(attributes, name, &engine::Attribute::name);
    return found == attributes.end() ? otherwise : engine::visible(value_text(*found));
}

std::string step_text(double taken, double setting) {
    const std::string set = setting > 0.0 ? time_text(setting) : "auto", used = taken > 0.0 ? time_text(taken) : "";
    if (used.empty() || used == set) return set;
    return setting > 0.0 ? fmt::format("{} ({} taken)", set, used) : fmt::format("auto ({})", used);
}

std::string step_text(const std::vector<engine::Attribute>& attributes) {
    return step_text(number_of(attributes, tasks::step_taken_attribute), number_of(attributes, "step"));
}

std::optional<tasks::Scene> scene_in(const std::string* text) {
    constexpr std::size_t longest = std::size_t{1} << 20U;  // a parser takes a multiple of it [byte]
    if (text == nullptr || text->empty() || text->size() > longest) return {};
    try {
        return tasks::parse_scene(*text, "scene", tasks::StartState::recorded);
    } catch (const tasks::SceneError&) {
        return {};
    }
}

std::string machine_lines(const tasks::Scene& scene) {
    const model::Parameters& p = scene.parameters;
    if (p.detail.pulleys == model::PulleyDetail::absent || p.start.layout != model::StartLayout::belt) return "";
    const double length = model::chain_length(p.chain), distance = p.pulley.centre_distance;
    const auto radii = model::belt_radii(length, p.start.ratio, distance);
    if (!radii) return "";
    const double incline = std::asin((radii->driven - radii->driving) / distance), degree = 180.0 / std::numbers::pi;
    const double arcs[] = {std::numbers::pi - 2.0 * incline, std::numbers::pi + 2.0 * incline};
    std::string text = field("chain length", fmt::format("{:.2f} mm, {} pins", 1e3 * length, p.chain.pins));
    text += field("radii", fmt::format("{:.2f} mm driving, {:.2f} mm driven; arcs {:.0f} deg, {:.0f} deg at ratio {:.4g}",
                                       1e3 * radii->driving, 1e3 * radii->driven, degree * arcs[0], degree * arcs[1], p.start.ratio));
    if (p.drive.mode != model::DriveMode::torque)
        text += field("pins pass",
                      fmt::format("{:.4g} Hz at the start", std::abs(p.drive.speed.at(0.0)) * radii->driving * p.chain.pins / length));
    if (scene.gains == tasks::ControlGains::found)
        text += field("gains found", fmt::format("proportional {:.4g} N, integral {:.4g} N/s", p.control.proportional, p.control.integral));
    return text;
}

}  // namespace cvtflow::tools
