#include "tools/program/text/attribute_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/text.hpp"
#include "tasks/run/saved_start.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

constexpr std::size_t longest_scene = std::size_t{1} << 20U;  ///< as text; a parser takes a multiple of it [byte]

}  // namespace

std::string value_text(const engine::Attribute& attribute) {
    if (const auto* text = std::get_if<std::string>(&attribute.value)) return *text;
    if (const auto* number = std::get_if<double>(&attribute.value)) return fmt::format("{:.6g}", *number);
    return fmt::format("{}", std::get<std::int64_t>(attribute.value));
}

std::string text_of(const std::vector<engine::Attribute>& attributes, std::string_view name, const std::string& otherwise) {
    const auto found =
        std::find_if(attributes.begin(), attributes.end(), [&](const engine::Attribute& attribute) { return attribute.name == name; });
    return found == attributes.end() ? otherwise : engine::visible(value_text(*found));
}

namespace {

/// 0 if it is absent or no real number.
double number_of(const std::vector<engine::Attribute>& attributes, std::string_view name) {
    const auto found = std::find_if(attributes.begin(), attributes.end(), [&](const engine::Attribute& each) { return each.name == name; });
    const double* number = found == attributes.end() ? nullptr : std::get_if<double>(&found->value);
    return number == nullptr ? 0.0 : *number;
}

}  // namespace

std::string step_text(const std::vector<engine::Attribute>& attributes, double setting) {
    const double taken = number_of(attributes, tasks::step_taken_attribute);
    const std::string set = setting > 0.0 ? time_text(setting) : "auto", used = taken > 0.0 ? time_text(taken) : "";
    if (used.empty() || used == set) return set;
    return setting > 0.0 ? fmt::format("{} ({} taken)", set, used) : fmt::format("auto ({})", used);
}

std::string step_text(const std::vector<engine::Attribute>& attributes) { return step_text(attributes, number_of(attributes, "step")); }

std::optional<tasks::Scene> scene_in(const std::vector<engine::Attribute>& attributes, std::string_view name) {
    const auto found = std::find_if(attributes.begin(), attributes.end(), [&](const engine::Attribute& each) { return each.name == name; });
    const std::string text = found == attributes.end() ? "" : value_text(*found);
    if (text.empty() || text.size() > longest_scene) return {};
    try {
        return tasks::parse_scene(text, "scene", tasks::StartState::recorded);
    } catch (const tasks::SceneError&) {
        return {};
    }
}

}  // namespace cvtflow::tools
