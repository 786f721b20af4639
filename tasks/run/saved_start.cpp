#include "tasks/run/saved_start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "engine/record/run/state_file.hpp"
#include "tasks/scene/parameter_table.hpp"

namespace cvtflow::tasks {

double suspicion_of(const engine::SavedState& saved) {
    for (const engine::Attribute& attribute : saved.attributes) {
        if (attribute.name != suspicion_attribute) continue;
        if (const auto* value = std::get_if<double>(&attribute.value)) return *value;
    }
    return 0.0;
}

namespace {

const std::string* text_attribute(const engine::SavedState& saved, std::string_view name) {
    for (const engine::Attribute& attribute : saved.attributes) {
        if (attribute.name == name) return std::get_if<std::string>(&attribute.value);
    }
    return nullptr;
}

/// Sections whose keys describe the machine, not the run or the operating point.
[[nodiscard]] bool describes_machine(const Parameter& parameter) {
    constexpr std::string_view sections[] = {"detail", "chain", "half", "plate", "joint", "tip", "pulley"};
    return std::find(std::begin(sections), std::end(sections), parameter.section()) != std::end(sections);
}

}  // namespace

std::shared_ptr<const engine::SavedState> saved_start(const Scene& scene) {
    try {
        return scene.start_state.read(scene.state_file);
    } catch (const engine::RecordError& error) {
        throw engine::RecordError(fmt::format("{}start.state: {}", scene.state_place, error.what()));
    }
}

std::vector<std::string> start_differences(const engine::SavedState& saved, const Scene& scene) {
    std::vector<std::string> lines;
    const std::string* text = text_attribute(saved, "scene");
    if (text == nullptr) return lines;
    const Scene then = parse_scene(*text, scene.state_file, StartState::ignored);
    for (const Parameter& parameter : parameter_table()) {
        if (!describes_machine(parameter)) continue;
        const std::string was = value_text(parameter, then);
        const std::string is = value_text(parameter, scene);
        if (was != is) lines.push_back(fmt::format("{} = {}, settled with {}", parameter.key, is, was));
    }
    return lines;
}

}  // namespace cvtflow::tasks
