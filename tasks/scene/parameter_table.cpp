#include "tasks/scene/parameter_table.hpp"

#include <algorithm>
#include <array>

#include "tasks/scene/spelling.hpp"

namespace cvtflow::tasks {
namespace {

// Ranges are wide on purpose: stiffnesses and masses may be a thousandth to a thousandfold of the default (so that limits of
// stability can be studied); what makes no sense at all is refused. Defaults are those of the structs.
// key, unit, min, max, choices / meaning / source, member
const std::vector<Parameter>& rows() {
    static const std::vector<Parameter> table{
    // clang-format off
    {"scene.name", "", 0, 0, {},
     "Name of the scene; the file's stem if absent.",
     "model choice", [](Scene& s) -> Slot { return &s.name; }},
    {"scene.description", "", 0, 0, {},
     "What the scene is for, in a sentence or two.",
     "model choice", [](Scene& s) -> Slot { return &s.description; }},

    {"detail.order", "1", 0, 3, {},
     "Legendre order of the axis curve of a pin half: 0 rigid, 1 slope, 2 and 3 bending.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.detail.order; }},
    {"detail.plates", "", 0, 0, {"each", "lumped"},
     "Every plate, or per link a pack of one or two plates with the same stiffness, mass and moments.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.detail.plates; }},
    {"detail.joint_points", "1", 1, 16, {},
     "Gauss-Legendre points along the rolling line of a joint.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.detail.joint_points; }},
    {"detail.pulleys", "", 0, 0, {"elastic", "rigid", "absent"},
     "Elastic shafts and sheaves, rigid ones, or none (a free ring).",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.detail.pulleys; }},
    {"detail.friction", "", 0, 0, {"piecewise", "smoothed"},
     "Friction law: linear up to saturation and constant beyond, or with the corner smoothed.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.detail.friction; }},
    {"detail.smoothing", "1", 1e-6, 1, {},
     "Half-width of the smoothed corner of the friction law, in units of the saturation speed.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.detail.smoothing; }},
    {"detail.stick_slip", "", 0, 0, {},
     "Tips also have the phases stick and slip, with transitions located in time.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.detail.stick_slip; }},

    {"chain.pins", "1", 3, 10000, {},
     "Number of pins, and of links.",
     "published chain variators", [](Scene& s) -> Slot { return &s.parameters.chain.pins; }},
    {"chain.pitch", "m", 1e-3, 5e-2, {},
     "Distance from pin to pin along a link. A list is repeated cyclically over the links.",
     "published chain variators", [](Scene& s) -> Slot { return &s.parameters.chain.pitch; }},
    {"chain.damping_ratio", "1", 0, 10, {},
     "Damping ratio of every spring and contact of the chain.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.chain.damping_ratio; }},
    {"chain.young_modulus", "Pa", 2e8, 3e14, {},
     "Young's modulus of the pins.",
     "steel", [](Scene& s) -> Slot { return &s.parameters.chain.young_modulus; }},

    {"half.length", "m", 1e-3, 1, {},
     "Length of a pin.",
     "published chain variators", [](Scene& s) -> Slot { return &s.parameters.half.length; }},
    {"half.width", "m", 1e-4, 4e-2, {},
     "Thickness of a pin half in the direction of travel.",
     "published chain variators", [](Scene& s) -> Slot { return &s.parameters.half.width; }},
    {"half.mass", "kg", 4e-6, 5, {},
     "Mass of a pin half.",
     "steel of the pin's size", [](Scene& s) -> Slot { return &s.parameters.half.mass; }},
    {"half.area", "m^2", 1e-8, 2e-2, {},
     "Cross-section of a pin half; sets its stiffness in length.",
     "published chain variators", [](Scene& s) -> Slot { return &s.parameters.half.area; }},
    {"half.bending_travel", "N*m^2", 1e-3, 2e3, {},
     "Bending stiffness (EI) of a pin half against bending along the direction of travel.",
     "steel and the half's cross-section", [](Scene& s) -> Slot { return &s.parameters.half.bending_travel; }},
    {"half.bending_height", "N*m^2", 1e-2, 2e4, {},
     "Bending stiffness (EI) of a pin half against bending along its height.",
     "steel and the half's cross-section", [](Scene& s) -> Slot { return &s.parameters.half.bending_height; }},

    {"plate.count", "1", 1, 64, {},
     "Plates per link.",
     "published chain variators", [](Scene& s) -> Slot { return &s.parameters.plate.count; }},
    {"plate.mass", "kg", 5e-7, 1, {},
     "Mass of one plate.",
     "steel of the plate's size", [](Scene& s) -> Slot { return &s.parameters.plate.mass; }},
    {"plate.stiffness", "N/m", 5e4, 1e11, {},
     "Stiffness of one plate in tension.",
     "sized from the plate's cross-section", [](Scene& s) -> Slot { return &s.parameters.plate.stiffness; }},
    {"plate.span", "m", 0, 0.5, {},
     "Distance of the outermost plates of a link from the middle of the pin.",
     "published chain variators", [](Scene& s) -> Slot { return &s.parameters.plate.span; }},
    {"plate.bending_stiffness", "N*m^2", 1e-4, 200, {},
     "Bending stiffness (EI) of one plate out of its plane.",
     "sized from the plate's cross-section", [](Scene& s) -> Slot { return &s.parameters.plate.bending_stiffness; }},
    {"plate.torsion_stiffness", "N*m/rad", 1e-2, 2e4, {},
     "Stiffness of one plate against twisting the pins at its ends.",
     "sized from the plate's cross-section", [](Scene& s) -> Slot { return &s.parameters.plate.torsion_stiffness; }},
    {"plate.friction_coefficient", "1", 0, 2, {},
     "Coefficient of friction between neighbouring plates.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.plate.friction.coefficient; }},
    {"plate.saturation_speed", "m/s", 1e-6, 10, {},
     "Sliding speed at which plate friction saturates.",
     "calibrated to the published spectrum", [](Scene& s) -> Slot { return &s.parameters.plate.friction.saturation_speed; }},

    {"joint.radius", "m", 1e-3, 1, {},
     "Radius of the rolling profile of a pin half.",
     "published chain variators", [](Scene& s) -> Slot { return &s.parameters.joint.radius; }},
    {"joint.stiffness", "N/m", 1e6, 1e12, {},
     "Contact stiffness of the whole rolling line of a joint.",
     "sized from Hertz' line contact", [](Scene& s) -> Slot { return &s.parameters.joint.stiffness; }},
    {"joint.law", "", 0, 0, {"linear", "palmgren"},
     "Contact law of a joint: linear, or Palmgren's power 10/9.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.joint.law; }},
    {"joint.reference_depth", "m", 1e-9, 1e-3, {},
     "Penetration at which the damping ratio and Palmgren's law are anchored.",
     "depth under the baseline's strand force", [](Scene& s) -> Slot { return &s.parameters.joint.reference_depth; }},
    {"joint.clearance", "m", 1e-7, 1e-3, {},
     "Play of the pin halves in the opening of the plates.",
     "published chain variators", [](Scene& s) -> Slot { return &s.parameters.joint.clearance; }},
    {"joint.clearance_stiffness", "N/m", 1e5, 1e11, {},
     "Stiffness of the opening beyond the play.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.joint.clearance_stiffness; }},
    {"joint.friction_coefficient", "1", 0, 2, {},
     "Coefficient of friction in the rolling contact.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.joint.friction.coefficient; }},
    {"joint.saturation_speed", "m/s", 1e-6, 10, {},
     "Sliding speed at which joint friction saturates.",
     "calibrated to the published spectrum", [](Scene& s) -> Slot { return &s.parameters.joint.friction.saturation_speed; }},

    {"tip.angle", "rad", 1e-2, 0.8, {},
     "Lean of the sheave's flank, half the wedge angle.",
     "published chain variators", [](Scene& s) -> Slot { return &s.parameters.tip.angle; }},
    {"tip.radius", "m", 1e-3, 10, {},
     "Radius of the end faces of a pin.",
     "published chain variators", [](Scene& s) -> Slot { return &s.parameters.tip.radius; }},
    {"tip.hertz", "N/m^1.5", 2.5e7, 2.5e13, {},
     "Hertz stiffness of a tip on the sheave.",
     "sized from Hertz and tip radius", [](Scene& s) -> Slot { return &s.parameters.tip.hertz; }},
    {"tip.reference_depth", "m", 1e-9, 1e-3, {},
     "Penetration at which the damping ratio is anchored.",
     "depth under the baseline's clamping force", [](Scene& s) -> Slot { return &s.parameters.tip.reference_depth; }},
    {"tip.deepest", "m", 1e-6, 1e-2, {},
     "A deeper penetration of a tip stops the run with a fault.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.tip.deepest; }},
    {"tip.friction_coefficient", "1", 0, 2, {},
     "Coefficient of friction between tip and sheave.",
     "published chain variators", [](Scene& s) -> Slot { return &s.parameters.tip.friction.coefficient; }},
    {"tip.saturation_speed", "m/s", 1e-6, 10, {},
     "Sliding speed at which tip friction saturates.",
     "calibrated to the published spectrum", [](Scene& s) -> Slot { return &s.parameters.tip.friction.saturation_speed; }},

    {"pulley.centre_distance", "m", 1e-2, 10, {},
     "Distance of the shafts.",
     "published chain variators", [](Scene& s) -> Slot { return &s.parameters.pulley.centre_distance; }},
    {"pulley.arc_radius", "m", 1e-2, 1e3, {},
     "Radius of the sheave's crowned flank in an axial section.",
     "published chain variators", [](Scene& s) -> Slot { return &s.parameters.pulley.arc_radius; }},
    {"pulley.arc_position", "m", 1e-3, 1, {},
     "Radius on the sheave where the flank leans by tip.angle.",
     "running radius of the baseline", [](Scene& s) -> Slot { return &s.parameters.pulley.arc_position; }},
    {"pulley.innermost", "m", 1e-3, 1, {},
     "A touching pin on a smaller radius has left the sheave: fault.",
     "published chain variators", [](Scene& s) -> Slot { return &s.parameters.pulley.innermost; }},
    {"pulley.outermost", "m", 1e-3, 1, {},
     "A touching pin on a larger radius has left the sheave: fault.",
     "published chain variators", [](Scene& s) -> Slot { return &s.parameters.pulley.outermost; }},
    {"pulley.sheave_mass", "kg", 3e-3, 3e3, {},
     "Mass of a sheave.",
     "typical size of a passenger-car variator", [](Scene& s) -> Slot { return &s.parameters.pulley.sheave_mass; }},
    {"pulley.sheave_polar_inertia", "kg*m^2", 8e-6, 8, {},
     "Moment of inertia of a sheave about the shaft.",
     "typical size of a passenger-car variator", [](Scene& s) -> Slot { return &s.parameters.pulley.sheave_polar_inertia; }},
    {"pulley.sheave_tilt_inertia", "kg*m^2", 4e-6, 5, {},
     "Moment of inertia of a sheave about a diameter.",
     "typical size of a passenger-car variator", [](Scene& s) -> Slot { return &s.parameters.pulley.sheave_tilt_inertia; }},
    {"pulley.shaft_mass", "kg", 7e-3, 7e3, {},
     "Mass of a shaft.",
     "typical size of a passenger-car variator", [](Scene& s) -> Slot { return &s.parameters.pulley.shaft_mass; }},
    {"pulley.shaft_polar_inertia", "kg*m^2", 2e-5, 20, {},
     "Moment of inertia of a shaft about its axis.",
     "typical size of a passenger-car variator", [](Scene& s) -> Slot { return &s.parameters.pulley.shaft_polar_inertia; }},
    {"pulley.shaft_tilt_inertia", "kg*m^2", 2e-5, 20, {},
     "Moment of inertia of a shaft about a diameter.",
     "typical size of a passenger-car variator", [](Scene& s) -> Slot { return &s.parameters.pulley.shaft_tilt_inertia; }},
    {"pulley.bearing_radial", "N/m", 5e5, 5e11, {},
     "Radial stiffness of the bearings of a shaft.",
     "typical size of a passenger-car variator", [](Scene& s) -> Slot { return &s.parameters.pulley.bearing_radial; }},
    {"pulley.bearing_axial", "N/m", 5e5, 5e11, {},
     "Axial stiffness of the bearings of a shaft.",
     "typical size of a passenger-car variator", [](Scene& s) -> Slot { return &s.parameters.pulley.bearing_axial; }},
    {"pulley.bearing_tilt", "N*m/rad", 2e3, 2e9, {},
     "Tilting stiffness of the bearings of a shaft.",
     "typical size of a passenger-car variator", [](Scene& s) -> Slot { return &s.parameters.pulley.bearing_tilt; }},
    {"pulley.attachment_radial", "N/m", 1e6, 1e12, {},
     "Radial stiffness between sheave and shaft.",
     "typical size of a passenger-car variator", [](Scene& s) -> Slot { return &s.parameters.pulley.attachment_radial; }},
    {"pulley.attachment_axial", "N/m", 1e6, 1e12, {},
     "Axial stiffness between fixed sheave and shaft.",
     "typical size of a passenger-car variator", [](Scene& s) -> Slot { return &s.parameters.pulley.attachment_axial; }},
    {"pulley.attachment_tilt", "N*m/rad", 1e3, 2e9, {},
     "Tilting stiffness between sheave and shaft; sets how far the wedge opens.",
     "typical size of a passenger-car variator", [](Scene& s) -> Slot { return &s.parameters.pulley.attachment_tilt; }},
    {"pulley.attachment_torsion", "N*m/rad", 5e2, 5e8, {},
     "Torsional stiffness between sheave and shaft.",
     "typical size of a passenger-car variator", [](Scene& s) -> Slot { return &s.parameters.pulley.attachment_torsion; }},
    {"pulley.cylinder_damping", "N*s/m", 0, 2e8, {},
     "Damping of a movable sheave against its shaft by the cylinder.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.pulley.cylinder_damping; }},
    {"pulley.damping_ratio", "1", 0, 10, {},
     "Damping ratio of bearings and attachments.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.pulley.damping_ratio; }},

    {"drive.mode", "", 0, 0, {"speed", "torque"},
     "Shaft 1 is held at a speed by a governor, or driven by a torque.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.drive.mode; }},
    {"drive.speed", "rad/s", -2000, 2000, {},
     "Speed of shaft 1 over time, in mode speed.",
     "baseline operating point", [](Scene& s) -> Slot { return &s.parameters.drive.speed; }},
    {"drive.torque", "N*m", -1e5, 1e5, {},
     "Torque on shaft 1 over time, in mode torque.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.drive.torque; }},
    {"drive.governor_frequency", "Hz", 1e-1, 1e5, {},
     "Corner frequency of the governor of mode speed.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.drive.governor_frequency; }},
    {"drive.inertia", "kg*m^2", 0, 1e3, {},
     "Moment of inertia added to shaft 1.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.drive.inertia; }},

    {"load.torque", "N*m", -1e5, 1e5, {},
     "Torque against the travel of shaft 2 over time.",
     "baseline operating point", [](Scene& s) -> Slot { return &s.parameters.load.torque; }},
    {"load.inertia", "kg*m^2", 0, 1e3, {},
     "Moment of inertia added to shaft 2.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.load.inertia; }},

    {"clamping.driving", "N", 0, 1e7, {},
     "Clamping force of the movable sheave of shaft 1 over time.",
     "baseline operating point", [](Scene& s) -> Slot { return &s.parameters.clamping.driving; }},
    {"clamping.driven", "N", 0, 1e7, {},
     "Clamping force of the movable sheave of shaft 2 over time.",
     "baseline operating point", [](Scene& s) -> Slot { return &s.parameters.clamping.driven; }},

    {"control.enabled", "", 0, 0, {},
     "The speed ratio is controlled by the clamping force of shaft 1.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.control.enabled; }},
    {"control.ratio", "1", 0.05, 20, {},
     "Wanted speed ratio (shaft 1 over shaft 2) over time.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.control.ratio; }},
    {"control.proportional", "N", 0, 1e9, {},
     "Proportional gain: clamping force per relative error of speed.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.control.proportional; }},
    {"control.integral", "N/s", 0, 1e12, {},
     "Integral gain: rate of clamping force per relative error of speed.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.control.integral; }},
    {"control.authority", "N", 0, 1e6, {},
     "Largest correction of the clamping force of shaft 1, either way.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.control.authority; }},
    {"control.reference_speed", "rad/s", 1e-3, 2000, {},
     "Speed that scales the error in drive.mode torque.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.control.reference_speed; }},

    {"start.layout", "", 0, 0, {"belt", "ring"},
     "The chain begins around the pulleys, or as a free ring.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.start.layout; }},
    {"start.ratio", "1", 0.05, 20, {},
     "Speed ratio of the geometric start: running radius on shaft 2 over that on shaft 1.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.start.ratio; }},
    {"start.ring_speed", "rad/s", -2000, 2000, {},
     "Speed of rotation of the free ring.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.start.ring_speed; }},
    {"start.settling_time", "s", 0, 10, {},
     "A geometric start runs for this long before time zero.",
     "vibrations of the start have died out", [](Scene& s) -> Slot { return &s.parameters.start.settling_time; }},
    {"start.ramp_time", "s", 1e-9, 10, {},
     "Clamping and load are raised over this time at the beginning of settling.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.start.ramp_time; }},
    {"start.state", "", 0, 0, {},
     "File of a recorded state to start from, relative to the scene file; empty: geometric start.",
     "model choice", [](Scene& s) -> Slot { return &s.state_file; }},

    {"run.method", "", 0, 0, {},
     "Integration method, a name from the catalogue of methods.",
     "model choice", [](Scene& s) -> Slot { return &s.run.method; }},
    {"run.step", "s", 1e-12, 1e-2, {},
     "Time step.",
     "model choice", [](Scene& s) -> Slot { return &s.run.step; }},
    {"run.until", "s", 1e-9, 1e4, {},
     "The run ends at this time.",
     "model choice", [](Scene& s) -> Slot { return &s.run.until; }},
    {"run.output_interval", "s", 1e-12, 1e4, {},
     "Time between records of the channels.",
     "model choice", [](Scene& s) -> Slot { return &s.run.output_interval; }},
    {"run.state_interval", "s", 1e-12, 1e4, {},
     "Time between records of the full state.",
     "model choice", [](Scene& s) -> Slot { return &s.run.state_interval; }},
    {"run.max_steps", "1", 0, 9007199254740992, {},
     "The run stops after this many steps; 0: no limit.",
     "model choice", [](Scene& s) -> Slot { return &s.run.max_steps; }},
    {"run.max_wall", "s", 0, 1e9, {},
     "The run stops after this much wall-clock time; 0: no limit.",
     "model choice", [](Scene& s) -> Slot { return &s.run.max_wall; }},
    {"run.followed_pin", "1", 0, 9999, {},
     "Pin whose own channels are recorded, counted from 0.",
     "model choice", [](Scene& s) -> Slot { return &s.run.followed_pin; }},
    {"run.segments", "1", 1, 10000, {},
     "Parts into which the chain is cut for parallel work; does not change results.",
     "model choice", [](Scene& s) -> Slot { return &s.run.segments; }},
    {"run.threads", "1", 1, 1024, {},
     "Threads; does not change results.",
     "model choice", [](Scene& s) -> Slot { return &s.run.threads; }},
    {"run.seed", "1", 0, 9007199254740992, {},
     "Seed of whatever is drawn by chance.",
     "model choice", [](Scene& s) -> Slot { return &s.run.seed; }},

    {"record.ledger", "", 0, 0, {},
     "Losses and works by kind are integrated along with the state.",
     "model choice", [](Scene& s) -> Slot { return &s.parameters.ledger; }},
    // clang-format on
    };
    return table;
}

}  // namespace

Kind Parameter::kind() const {
    static constexpr std::array kinds{Kind::number,  Kind::integer, Kind::integer,     Kind::integer,    Kind::boolean,
                                      Kind::text,    Kind::number_list, Kind::time_table, Kind::choice,  Kind::choice,
                                      Kind::choice,  Kind::choice,  Kind::choice,      Kind::choice};
    static_assert(kinds.size() == std::variant_size_v<Slot>);
    Scene scene;
    return kinds[member(scene).index()];
}

std::span<const Parameter> parameter_table() { return rows(); }

const Parameter* find_parameter(std::string_view key) {
    const auto row = std::find_if(rows().begin(), rows().end(), [&](const Parameter& parameter) { return parameter.key == key; });
    return row == rows().end() ? nullptr : &*row;
}

std::string nearest_key(std::string_view key) {
    const std::string_view name = key.substr(key.find('.') + 1);
    std::vector<std::string> keys;
    for (const Parameter& parameter : rows()) keys.emplace_back(parameter.key);
    if (std::string near = closest(key, keys); !near.empty() && edit_distance(key, near) <= 2) return near;
    for (const Parameter& parameter : rows())
        if (name.size() > 2 && parameter.key.starts_with(key)) return std::string(parameter.key);
    for (const Parameter& parameter : rows())
        if (parameter.name() == name) return std::string(parameter.key);
    return closest(key, keys);
}

std::vector<std::string> section_names() {
    std::vector<std::string> names;
    for (const Parameter& parameter : rows())
        if (names.empty() || names.back() != parameter.section()) names.emplace_back(parameter.section());
    return names;
}

}  // namespace cvtflow::tasks
