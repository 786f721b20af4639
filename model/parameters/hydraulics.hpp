#pragma once
/// Parameters of cylinders, valves and pump. (model/EQUATIONS.md section 8)

#include "model/parameters/table.hpp"

namespace cvtflow::model {

/// What makes the clamping forces: nothing in between; cylinders, from forces or from pressures that are requested.
enum class HydraulicMode { none, force, pressure };

/// Cylinder of a movable sheave: a ring-shaped piston that turns with its shaft.
struct Cylinder {
    double area = 0.01;         ///< A [m²]
    double inner = 20e-3;       ///< inner radius of the piston r_i [m]
    double compensation = 0.0;  ///< area of a chamber on the other side, whose oil only turns; from r_i on [m²]
    double spring = 0.0;        ///< force of a spring toward the chain where the flank's r_m is the running radius [N]
    double spring_rate = 0.0;   ///< by which it falls as the sheave moves toward the chain [N/m]
    TimeTable pressure{2e6};    ///< target, mode pressure [Pa]
    bool operator==(const Cylinder&) const = default;
};

/// Cylinders, their valves and the pump that feeds them. From t = 0 on; before, clamping forces act as they are requested.
struct Hydraulics {
    HydraulicMode mode = HydraulicMode::none;
    Cylinder driving{.area = 0.02, .pressure = TimeTable(1.3e6)}, driven;
    double feed_radius = 10e-3;        ///< r_0, where rotating oil has the pressure of its valve [m]
    double oil_density = 850.0;        ///< ρ [kg/m³]
    double oil_modulus = 1e9;          ///< K, bulk modulus with air and lines [Pa]
    double oil_volume = 3e-4;          ///< V of a cylinder with its line [m³]
    double leakage = 3e-12;            ///< L of a cylinder [m³/(s·Pa)]
    double valve_conductance = 1e-9;   ///< G of a valve fully open [m³/(s·Pa)]
    double valve_lag = 0.01;           ///< time constant [s]
    double valve_rate = 1e8;           ///< largest change of a set pressure [Pa/s]
    double pump_displacement = 12e-6;  ///< per turn [m³]
    double pump_ratio = 1.0;           ///< turns of the pump per turn of shaft 1
    TimeTable pump_speed{0.0};         ///< of the pump's own motor, added [rad/s]
    double pump_volumetric = 0.9;      ///< volumetric efficiency
    double pump_mechanical = 0.85;     ///< mechanical efficiency
    double line_margin = 3e5;          ///< line pressure above the higher set pressure [Pa]
    double line_minimum = 5e5;         ///< lowest line pressure [Pa]
    double relief_pressure = 6e6;      ///< highest line pressure [Pa]
    bool operator==(const Hydraulics&) const = default;
};

}  // namespace cvtflow::model
