#include "tools/program/text/machine_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "model/start/belt.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

/// The instant of a run at which tables of clamping force and load leave the smallest safety factor.
struct LeastSafety {
    double limit = 0.0, load = 0.0;  ///< [N*m]
    double factor = INFINITY;        ///< [1]
};

/// 2 mu S_2 r_2/cos(beta), friction of all contacts along the circumference, over the load. @param radius of the driven pulley [m]
LeastSafety least_safety(const tasks::Scene& scene, double radius) {
    constexpr int instants = 200;
    const model::Parameters& p = scene.parameters;
    LeastSafety least;
    for (int k = 0; k <= instants; ++k) {
        const double time = scene.run.until * k / instants;
        const double limit = 2.0 * p.tip.friction.coefficient * p.clamping.driven.at(time) * radius / std::cos(p.tip.angle);
        const double load = std::abs(p.load.torque.at(time));
        if (load > 0.0 && limit / load < least.factor) least = {limit, load, limit / load};
    }
    return least;
}

/// Whether load and clamping force of the driven pulley are those of their tables.
[[nodiscard]] bool tables_act(const model::Parameters& p) {
    const bool driven_controlled =
        p.control.enabled && (p.control.quantity != model::ControlledQuantity::ratio || p.control.driven != model::DrivenControl::none);
    return p.load.mode == model::LoadMode::torque && p.clamping.safety == 0.0 && !driven_controlled &&
           p.hydraulics.mode == model::HydraulicMode::none;
}

}  // namespace

std::string machine_lines(const tasks::Scene& scene) {
    const model::Parameters& p = scene.parameters;
    if (p.detail.pulleys == model::PulleyDetail::absent || p.start.layout != model::StartLayout::belt) return "";
    const double length = model::chain_length(p.chain), distance = p.pulley.centre_distance;
    const auto radii = model::belt_radii(length, p.start.ratio, distance);
    if (!radii) return "";
    const double incline = std::asin((radii->driven - radii->driving) / distance), degree = 180.0 / std::numbers::pi;
    const double arcs[] = {std::numbers::pi - 2.0 * incline, std::numbers::pi + 2.0 * incline};
    std::string text =
        field("radii", fmt::format("{:.2f} mm driving, {:.2f} mm driven; arcs {:.0f} deg, {:.0f} deg at ratio {:.4g}", 1e3 * radii->driving,
                                   1e3 * radii->driven, degree * arcs[0], degree * arcs[1], p.start.ratio));
    if (p.drive.mode != model::DriveMode::torque)
        text += field("pins pass",
                      fmt::format("{:.4g} Hz at the start", std::abs(p.drive.speed.at(0.0)) * radii->driving * p.chain.pins / length));
    if (!tables_act(p)) return text;
    const LeastSafety least = least_safety(scene, radii->driven);
    if (!std::isfinite(least.factor)) return text;
    text +=
        field("torque limit", fmt::format("{:.4g} N*m on the driven pulley (2 mu S_2 r_2/cos(beta)); load {:.4g} N*m: safety factor {:.3g}",
                                          least.limit, least.load, least.factor));
    if (least.factor < 1.0) text += field("", "the load exceeds the limit: the chain slips; raise clamping.driven or lower load.torque");
    return text;
}

}  // namespace cvtflow::tools
