#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

std::span<const DetailPreset> detail_presets() noexcept {
    using enum model::PinDetail;
    using model::PlateDetail;
    using model::PulleyDetail;
    static constexpr std::array presets{
        DetailPreset{"rigid", "pins of one body, whose halves slide along it and bend in one shape, lumped plates", rigid, 2,
                     PlateDetail::lumped, 1, PulleyDetail::elastic, 1.0, 0.06, 0.006, 0.033},
        DetailPreset{"medium", "halves with slope, lumped plates, elastic pulleys", halves, 1, PlateDetail::lumped, 3,
                     PulleyDetail::elastic, 1.0, 0.71, 0.004, 0.029},
        DetailPreset{"fine", "bending halves, every plate, elastic pulleys", halves, 3, PlateDetail::each, 3, PulleyDetail::elastic, 1.0,
                     1.0, 0.0031, 0.0053},
        DetailPreset{"full", "fine, with eight points per joint", halves, 3, PlateDetail::each, 8, PulleyDetail::elastic, 1.0, 1.2, 2.1e-5,
                     1.6e-4},
    };
    return presets;
}

std::span<const std::string_view> dial_keys() noexcept {
    static constexpr std::array<std::string_view, 6> keys{"detail.pins",         "detail.order",   "detail.plates",
                                                          "detail.joint_points", "detail.pulleys", "detail.mass_scaling"};
    return keys;
}

std::span<const std::string_view> state_keys() noexcept {
    static constexpr std::array<std::string_view, 5> keys{"detail.pins", "detail.order", "detail.plates", "detail.pulleys", "chain.pins"};
    return keys;
}

std::string gone_detail(std::string_view name) {
    if (name != "coarse" && name != "whole") return "";
    return "; whole pins that roll by constraint are gone: \"rigid\" is more accurate and takes a twelfth of their time";
}

void apply_detail(Scene& scene, std::string_view preset) {
    const auto presets = detail_presets();
    const auto chosen = std::find_if(presets.begin(), presets.end(), [&](const DetailPreset& row) { return row.name == preset; });
    if (chosen == presets.end()) {
        std::vector<std::string> names;
        for (const auto& row : presets) names.emplace_back(row.name);
        const std::string gone = gone_detail(preset), near = engine::did_you_mean(engine::closest(preset, names));
        throw SceneError(fmt::format("detail {}: not one of {}{}", preset, fmt::join(names, ", "), gone.empty() ? near : gone));
    }
    auto& detail = scene.parameters.detail;
    detail.pins = chosen->pins;
    detail.order = chosen->order;
    detail.plates = chosen->plates;
    detail.joint_points = chosen->joint_points;
    detail.mass_scaling = chosen->mass_scaling;
    if (detail.pulleys != model::PulleyDetail::absent) detail.pulleys = chosen->pulleys;
}

}  // namespace cvtflow::tasks
