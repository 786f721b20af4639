#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "tasks/scene/cross_checks.hpp"
#include "tasks/scene/toml/units.hpp"

namespace cvtflow::tasks {
namespace {

using model::PulleyDetail;
using Violation = std::optional<std::string>;

/// The largest friction of a tip is known everywhere as tip.friction_coefficient: clamping by torque, safety factors, stability.
Violation tip_law_has_its_largest(const Scene& scene) {
    const model::Tip& tip = scene.parameters.tip;
    const double coefficient = tip.friction.coefficient;
    if (tip.friction_law == model::TipFriction::lubricated && tip.limiting_traction > coefficient)
        return fmt::format("tip.limiting_traction: {} is above tip.friction_coefficient = {}", number_text(tip.limiting_traction),
                           number_text(coefficient));
    if (tip.friction_law != model::TipFriction::table) return {};
    if (tip.friction_table.speed.size() < 2)
        return "tip.friction_table: tip.friction_law = \"table\" takes its friction from at least two points [speed, coefficient]";
    const double largest = *std::ranges::max_element(tip.friction_table.value);
    if (std::abs(largest - coefficient) <= 1e-9 * coefficient) return {};
    return fmt::format("tip.friction_table: its largest value is {}, but tip.friction_coefficient is {}; they must be equal",
                       number_text(largest), number_text(coefficient));
}

Violation tip_law_has_piecewise_corner(const Scene& scene) {
    const auto& p = scene.parameters;
    if (p.tip.friction_law == model::TipFriction::constant || p.detail.pins != model::PinDetail::rigid) return {};
    if (p.detail.friction == model::FrictionLaw::piecewise) return {};
    return "tip.friction_law: detail.pins = \"rigid\" takes it with detail.friction = \"piecewise\" only";
}

Violation imperfections_have_pulleys(const Scene& scene) {
    const auto& [detail, i] = std::tie(scene.parameters.detail, scene.parameters.imperfection);
    const bool some = i.misalignment != 0.0 || i.runout != 0.0 || i.attachment != 1.0;
    if (some && detail.pulleys == PulleyDetail::absent) return "imperfection.misalignment: imperfections are of pulleys, which are absent";
    if (i.attachment == 1.0 || detail.pulleys == PulleyDetail::elastic) return {};
    return "imperfection.attachment: an attachment yields with detail.pulleys = \"elastic\" only";
}

}  // namespace

std::span<const CrossCheck> tip_checks() {
    static const std::vector<CrossCheck> checks{
        {{"tip.friction_table", "tip.limiting_traction", "tip.friction_law", "tip.friction_coefficient"}, tip_law_has_its_largest},
        {{"tip.friction_law", "detail.pins", "detail.friction"}, tip_law_has_piecewise_corner},
        {{"imperfection.attachment", "imperfection.runout", "imperfection.misalignment", "detail.pulleys"}, imperfections_have_pulleys},
    };
    return checks;
}

}  // namespace cvtflow::tasks
