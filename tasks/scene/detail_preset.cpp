#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "engine/base/spelling.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

std::span<const DetailPreset> detail_presets() noexcept {
    using enum model::PinDetail;
    using model::PlateDetail;
    using model::PulleyDetail;
    static constexpr std::array presets{
        DetailPreset{"coarse", "straight pin halves, lumped plates, one point per joint, rigid pulleys", halves, 0, PlateDetail::lumped, 1,
                     PulleyDetail::rigid},
        DetailPreset{"medium", "halves with slope, lumped plates, elastic pulleys", halves, 1, PlateDetail::lumped, 3,
                     PulleyDetail::elastic},
        DetailPreset{"fine", "bending halves, every plate, elastic pulleys", halves, 3, PlateDetail::each, 3, PulleyDetail::elastic},
        DetailPreset{"full", "fine, with eight points per joint", halves, 3, PlateDetail::each, 8, PulleyDetail::elastic},
    };
    return presets;
}

void apply_detail(Scene& scene, std::string_view preset) {
    const auto presets = detail_presets();
    const auto chosen = std::find_if(presets.begin(), presets.end(), [&](const DetailPreset& row) { return row.name == preset; });
    if (chosen == presets.end()) {
        std::vector<std::string> names;
        for (const auto& row : presets) names.emplace_back(row.name);
        throw SceneError(fmt::format("detail {}: not one of {}{}", preset, fmt::join(names, ", "),
                                     engine::did_you_mean(engine::closest(preset, names))));
    }
    auto& detail = scene.parameters.detail;
    detail.pins = chosen->pins;
    detail.order = chosen->order;
    detail.plates = chosen->plates;
    detail.joint_points = chosen->joint_points;
    if (detail.pulleys != model::PulleyDetail::absent) detail.pulleys = chosen->pulleys;
}

}  // namespace cvtflow::tasks
