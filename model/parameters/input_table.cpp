#include "model/parameters/input_table.hpp"

namespace cvtflow::model {

namespace {

using P = Parameters;

bool by_force(const P& p) { return p.hydraulics.mode != HydraulicMode::pressure; }
bool by_pressure(const P& p) { return p.hydraulics.mode == HydraulicMode::pressure; }
bool driven_by_torque(const P& p) { return p.drive.mode == DriveMode::torque; }
bool driven_by_speed(const P& p) { return p.drive.mode != DriveMode::torque; }
bool loaded_by_torque(const P& p) { return p.load.mode == LoadMode::torque; }
bool loaded_by_speed(const P& p) { return p.load.mode != LoadMode::torque; }
bool holds(const P& p, ControlledQuantity first) { return p.control.enabled && p.control.quantity == first; }

constexpr const char *forces = "clamping forces, not hydraulics.mode = \"pressure\"", *pressures = "hydraulics.mode = \"pressure\"",
                     *ratio = "control.enabled = true and control.quantity = \"ratio\"";

}  // namespace

// clang-format off
const std::array<InputRow, input_count> input_table{{
    {"clamping_driving", "clamping.driving", [](const P& p) { return &p.clamping.driving; }, by_force, forces},
    {"clamping_driven", "clamping.driven", [](const P& p) { return &p.clamping.driven; }, by_force, forces},
    {"load_torque", "load.torque", [](const P& p) { return &p.load.torque; }, loaded_by_torque, "load.mode = \"torque\""},
    {"drive_torque", "drive.torque", [](const P& p) { return &p.drive.torque; }, driven_by_torque, "drive.mode = \"torque\""},
    {"drive_speed", "drive.speed", [](const P& p) { return &p.drive.speed; }, driven_by_speed, "drive.mode = \"speed\" or \"coupling\"", 0},
    {"ratio", "control.ratio", [](const P& p) { return &p.control.ratio; },
     [](const P& p) { return holds(p, ControlledQuantity::ratio); }, ratio},
    {"load_speed", "load.speed", [](const P& p) { return &p.load.speed; }, loaded_by_speed, "load.mode = \"speed\" or \"coupling\"", 1},
    {"load_angle", "load_angle", nullptr, [](const P& p) { return p.load.mode == LoadMode::coupling; }, "load.mode = \"coupling\"", 1},
    {"drive_angle", "drive_angle", nullptr, [](const P& p) { return p.drive.mode == DriveMode::coupling; }, "drive.mode = \"coupling\"", 0},
    {"pressure_driving", "hydraulics.driving_pressure", [](const P& p) { return &p.hydraulics.driving.pressure; }, by_pressure, pressures},
    {"pressure_driven", "hydraulics.driven_pressure", [](const P& p) { return &p.hydraulics.driven.pressure; }, by_pressure, pressures},
    {"slip", "control.slip", [](const P& p) { return &p.control.slip; }, [](const P& p) { return p.control.enabled; }, ""},
    {"safety", "control.safety", [](const P& p) { return &p.control.safety; }, [](const P& p) { return p.control.enabled; }, ""},
    {"pump_speed", "hydraulics.pump_speed", [](const P& p) { return &p.hydraulics.pump_speed; },
     [](const P& p) { return p.hydraulics.mode != HydraulicMode::none; }, ""},
}};
// clang-format on

}  // namespace cvtflow::model
