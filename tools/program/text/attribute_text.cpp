#include "tools/program/text/attribute_text.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cvtflow::tools {

std::string value_text(const engine::Attribute& attribute) {
    if (const auto* text = std::get_if<std::string>(&attribute.value)) return *text;
    if (const auto* number = std::get_if<double>(&attribute.value)) return fmt::format("{:.6g}", *number);
    return fmt::format("{}", std::get<std::int64_t>(attribute.value));
}

std::string text_of(const std::vector<engine::Attribute>& attributes, std::string_view name, const std::string& otherwise) {
    const auto found =
        std::find_if(attributes.begin(), attributes.end(), [&](const engine::Attribute& attribute) { return attribute.name == name; });
    return found == attributes.end() ? otherwise : value_text(*found);
}

std::optional<tasks::Scene> scene_in(const std::vector<engine::Attribute>& attributes, std::string_view name) {
    const std::string text = text_of(attributes, name, "");
    if (text.empty()) return {};
    try {
        return tasks::parse_scene(text, "scene", tasks::StartState::ignored);
    } catch (const tasks::SceneError&) {
        return {};
    }
}

}  // namespace cvtflow::tools
