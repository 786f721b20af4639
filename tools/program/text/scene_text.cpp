#include "tools/program/text/scene_text.hpp"

#include <fmt/format.h>

#include "tasks/scene/parameter_table.hpp"

namespace cvtflow::tools {

namespace {

/// A choice without the quotes of TOML.
std::string choice(const tasks::Scene& scene, std::string_view key) {
    const std::string text = tasks::value_text(*tasks::find_parameter(key), scene);
    return text.size() > 1 && text.front() == '"' ? text.substr(1, text.size() - 2) : text;
}

std::string_view preset_name(const model::Detail& detail) {
    for (const tasks::DetailPreset& preset : tasks::detail_presets()) {
        const bool pulleys = preset.pulleys == detail.pulleys || detail.pulleys == model::PulleyDetail::absent;
        if (preset.pins == detail.pins && preset.order == detail.order && preset.plates == detail.plates &&
            preset.joint_points == detail.joint_points && preset.mass_scaling == detail.mass_scaling && pulleys)
            return preset.name;
    }
    return {};
}

}  // namespace

std::string detail_text(const tasks::Scene& scene) {
    const model::Detail& detail = scene.parameters.detail;
    const std::string_view name = preset_name(detail);
    const std::string joints = detail.pins != model::PinDetail::halves
                                   ? fmt::format("{} pins", name_of(detail.pins))
                                   : fmt::format("{} joint point{}", detail.joint_points, detail.joint_points == 1 ? "" : "s");
    const std::string dials =
        fmt::format("order {}, {}, {}, {}", detail.order, detail.plates == model::PlateDetail::each ? "every plate" : "lumped plates",
                    joints, detail.pulleys == model::PulleyDetail::absent ? "no pulleys" : choice(scene, "detail.pulleys") + " pulleys");
    const std::string slowed = detail.mass_scaling == 1.0 ? "" : fmt::format(", mass scaling {}", choice(scene, "detail.mass_scaling"));
    const std::string friction = choice(scene, "detail.friction") + " friction" + (detail.stick_slip ? " with stick and slip" : "");
    return name.empty() ? fmt::format("{}{}; {}", dials, slowed, friction) : fmt::format("{} ({}{}); {}", name, dials, slowed, friction);
}

}  // namespace cvtflow::tools
