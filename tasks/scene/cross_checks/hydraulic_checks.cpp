#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "tasks/scene/cross_checks.hpp"

namespace cvtflow::tasks {
namespace {

using model::PulleyDetail;
using Violation = std::optional<std::string>;

Violation hydraulics_have_pulleys(const Scene& scene) {
    const auto& p = scene.parameters;
    if (p.hydraulics.mode == model::HydraulicMode::none || p.detail.pulleys != PulleyDetail::absent) return {};
    return "hydraulics.mode: cylinders need pulleys, but detail.pulleys is \"absent\"";
}

/// Oil as a spring against the sheave's mass, and its flow through a valve, are slow beside the steps of every method.
Violation oil_is_slow(const Scene& scene) {
    const auto& of = scene.parameters.hydraulics;
    if (of.mode == model::HydraulicMode::none) return {};
    constexpr double fastest = 1e5;  // [rad/s]: half a radian in a step of 5 us, the longest automatic one
    const double area = std::max(of.driving.area, of.driven.area), capacity = of.oil_volume / of.oil_modulus;
    const double frequency = area / std::sqrt(capacity * scene.parameters.pulley.sheave_mass), rate = of.valve_conductance / capacity;
    if (frequency > fastest)
        return fmt::format(
            "hydraulics.oil_volume: sheave and oil would vibrate at {:.3g} kHz, above {:.3g}: a larger oil_volume or a smaller oil_modulus",
            5e-4 * frequency / std::numbers::pi, 5e-4 * fastest / std::numbers::pi);
    if (rate > fastest)
        return fmt::format("hydraulics.valve_conductance: a cylinder would follow its valve within {:.3g} us, below {:.3g}: a smaller one",
                           1e6 / rate, 1e6 / fastest);
    return {};
}

Violation oil_is_behind_pistons(const Scene& scene) {
    const auto& of = scene.parameters.hydraulics;
    for (const auto& [name, cylinder] : {std::pair{"driving", &of.driving}, {"driven", &of.driven}}) {
        const double outer = std::sqrt(cylinder->inner * cylinder->inner + cylinder->area / std::numbers::pi);
        if (of.mode != model::HydraulicMode::none && of.feed_radius > outer)
            return fmt::format("hydraulics.feed_radius: {:.4g} mm is beyond the outer radius of hydraulics.{}_area, {:.4g} mm",
                               1e3 * of.feed_radius, name, 1e3 * outer);
    }
    return {};
}

Violation pump_turns(const Scene& scene) {
    const auto& of = scene.parameters.hydraulics;
    if (of.mode == model::HydraulicMode::none) return {};
    if (of.pump_displacement == 0.0) return "hydraulics.pump_displacement: 0 feeds no cylinder";
    if (of.pump_ratio > 0.0 || of.pump_speed.largest_magnitude() > 0.0) return {};
    return "hydraulics.pump_ratio: 0 and hydraulics.pump_speed = 0 leave the pump at rest";
}

}  // namespace

std::span<const CrossCheck> hydraulic_checks() {
    static const std::vector<CrossCheck> checks{
        {{"hydraulics.mode", "detail.pulleys"}, hydraulics_have_pulleys},
        {{"hydraulics.oil_volume", "hydraulics.oil_modulus", "hydraulics.valve_conductance", "hydraulics.driving_area",
          "hydraulics.driven_area", "pulley.sheave_mass"},
         oil_is_slow},
        {{"hydraulics.feed_radius", "hydraulics.driving_area", "hydraulics.driven_area", "hydraulics.driving_inner",
          "hydraulics.driven_inner"},
         oil_is_behind_pistons},
        {{"hydraulics.pump_ratio", "hydraulics.pump_speed", "hydraulics.pump_displacement"}, pump_turns},
    };
    return checks;
}

}  // namespace cvtflow::tasks
