#include <fmt/format.h>
#include <algorithm>
#include <string>
#include <vector>

#include "tasks/scene/parameter_table.hpp"

namespace cvtflow::tasks {

namespace {

/// Keys that act under a condition only.
struct Condition {
    std::string_view keys;  ///< separated by spaces; "heat.": a section
    bool (*acts)(const Scene&);
    std::string_view otherwise;  ///< why they have no effect
};

bool is_lubricated(const Scene& s) { return s.parameters.tip.friction_law == model::TipFriction::lubricated; }

bool has_affected_sheave(const Scene& s) {
    const auto& of = s.parameters.imperfection;
    return of.runout != 0.0 || of.attachment != 1.0 || of.unbalance != 0.0;
}

using model::DriveMode;
using model::LoadMode;

constexpr Condition conditions[] = {
    {"oil.temperature", [](const Scene& s) { return is_lubricated(s) || s.parameters.heat.enabled; },
     "tip.friction_law is not \"lubricated\" and heat.enabled is false"},
    {"oil.viscosity_40 oil.viscosity_100 oil.pressure_viscosity tip.limiting_traction tip.roughness", is_lubricated,
     "tip.friction_law is not \"lubricated\""},
    {"tip.friction_table", [](const Scene& s) { return s.parameters.tip.friction_law == model::TipFriction::table; },
     "tip.friction_law is not \"table\""},
    {"tip.reference_pressure", [](const Scene& s) { return s.parameters.tip.pressure_sensitivity != 0.0; },
     "tip.pressure_sensitivity is 0"},
    {"detail.smoothing", [](const Scene& s) { return s.parameters.detail.friction == model::FrictionLaw::smoothed; },
     "detail.friction is not \"smoothed\""},
    {"heat.", [](const Scene& s) { return s.parameters.heat.enabled; }, "heat.enabled is false"},
    {"hydraulics.", [](const Scene& s) { return s.parameters.hydraulics.mode != model::HydraulicMode::none; },
     "hydraulics.mode is \"none\""},
    {"guide.", [](const Scene& s) { return s.parameters.guide.present(); }, "guide.stiffness is 0"},
    {"vehicle.", [](const Scene& s) { return s.vehicle.present(); }, "vehicle.mass is 0"},
    {"cycle.", [](const Scene& s) { return s.cycle.present(); }, "cycle.speed is 0"},
    {"drive.torque", [](const Scene& s) { return s.parameters.drive.mode == DriveMode::torque; }, "drive.mode is not \"torque\""},
    {"drive.coupling_stiffness drive.coupling_damping", [](const Scene& s) { return s.parameters.drive.mode == DriveMode::coupling; },
     "drive.mode is not \"coupling\""},
    {"load.speed", [](const Scene& s) { return s.parameters.load.mode != LoadMode::torque; }, "load.mode is \"torque\""},
    {"load.governor_frequency", [](const Scene& s) { return s.parameters.load.mode == LoadMode::speed; }, "load.mode is not \"speed\""},
    {"load.coupling_stiffness load.coupling_damping", [](const Scene& s) { return s.parameters.load.mode == LoadMode::coupling; },
     "load.mode is not \"coupling\""},
    {"drag.bearing_diameter", [](const Scene& s) { return s.parameters.drag.bearing_friction != 0.0; }, "drag.bearing_friction is 0"},
    {"imperfection.sheave", has_affected_sheave, "the sheave has no runout, unbalance or other attachment"},
    {"imperfection.pin_length_seed", [](const Scene& s) { return s.parameters.imperfection.pin_length_spread != 0.0; },
     "imperfection.pin_length_spread is 0"},
    {"control.ratio control.slip control.safety control.proportional control.integral control.authority control.quantity",
     [](const Scene& s) { return s.parameters.control.enabled; }, "control.enabled is false"},
    {"control.driven_proportional control.driven_integral control.driven_authority",
     [](const Scene& s) { return s.parameters.control.driven != model::DrivenControl::none; }, "control.driven is \"none\""},
    {"start.ring_speed", [](const Scene& s) { return s.parameters.start.layout == model::StartLayout::ring; },
     "start.layout is not \"ring\""},
    {"run.state_interval", [](const Scene& s) { return s.run.state_interval >= s.run.output_interval; },
     "run.output_interval is longer: states are recorded at outputs"},
    {"run.steady run.steady_limit", [](const Scene& s) { return s.run.until.automatic(); }, "run.until is not \"steady\""},
    {"run.tolerance", [](const Scene& s) { return s.run.step_control == StepControl::error; }, "run.step_control is not \"error\""},
};

/// Whether the list names the key or its section.
bool names(std::string_view list, std::string_view key) {
    while (!list.empty()) {
        const std::string_view word = list.substr(0, list.find(' '));
        if (word == key || (word.ends_with('.') && key.starts_with(word))) return true;
        list.remove_prefix(std::min(list.size(), word.size() + 1));
    }
    return false;
}

}  // namespace

std::vector<std::string> idle_keys(const Scene& scene) {
    const Scene defaults;
    std::vector<std::string> lines;
    for (const Condition& row : conditions) {
        if (row.acts(scene)) continue;
        std::vector<std::string_view> idle;
        for (const Parameter& key : parameter_table()) {
            if (names(row.keys, key.key) && value_text(key, scene) != value_text(key, defaults)) idle.push_back(key.key);
        }
        if (!idle.empty()) lines.push_back(fmt::format("{}: no effect, since {}", fmt::join(idle, ", "), row.otherwise));
    }
    return lines;
}

}  // namespace cvtflow::tasks
