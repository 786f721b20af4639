#include "tasks/scene/parameter_table.hpp"

namespace cvtflow::tasks {
namespace {

std::vector<std::string_view> level_choices() {
    std::vector<std::string_view> names{"given"};
    for (const DetailPreset& preset : detail_presets()) names.push_back(preset.name);
    return names;
}

// Ranges are wide on purpose: stiffnesses and masses may be a thousandth to a thousandfold of the default (so that limits of
// stability can be studied); what makes no sense at all is refused. Defaults are those of the structs.
// key, unit, min, max, choices, member / meaning, source
constexpr std::string_view published = "published chain variators";

std::vector<Parameter> parameters_of_machine() {
    using namespace model;
    return {
        // clang-format off
    {"scene.name", "", 0, 0, {}, of<&Scene::name>, "Name of the scene; the file's stem if absent."},
    {"scene.description", "", 0, 0, {}, of<&Scene::description>, "Purpose of the scene, in one or two sentences."},

    {"detail.level", "", 0, 0, level_choices(), of<&Scene::level>,
     "Level of detail (cvtflow list detail): sets detail.pins, order, plates, joint_points, pulleys and mass_scaling. Those keys beside it "
     "take precedence, and --detail replaces all of them. \"given\": no level, these keys alone."},
    {"detail.pins", "", 0, 0, {model::pin_detail_names.begin(), model::pin_detail_names.end()}, of<&Detail::pins>,
     "Pins of two halves that roll on each other in contact; or of one body whose halves roll by constraint and slide along it, and which "
     "bends in one shape (order 2, lumped plates, one thread)."},
    {"detail.order", "1", 0, 3, {}, of<&Detail::order>,
     "Legendre order of the axis curve of a pin half: 0 rigid, 1 slope, 2 and 3 bending."},
    {"detail.plates", "", 0, 0, {"each", "lumped"}, of<&Detail::plates>,
     "Every plate separately, or one or two equivalent plates per link with the same stiffness, mass and moments."},
    {"detail.joint_points", "1", 1, 16, {}, of<&Detail::joint_points>, "Gauss-Legendre points along the rolling line of a joint."},
    {"detail.mass_scaling", "1", 1, 1000, {}, of<&Detail::mass_scaling>,
     "Factor on the inertia of motions that tilt or deform a pin. Above 1 they are slower, so longer steps are stable; weight, momentum "
     "and statics are unchanged."},
    {"detail.pulleys", "", 0, 0, {"elastic", "rigid", "absent"}, of<&Detail::pulleys>,
     "Elastic shafts and sheaves, rigid ones, or none (a free ring)."},
    {"detail.friction", "", 0, 0, {model::friction_law_names.begin(), model::friction_law_names.end()}, of<&Detail::friction>,
     "Friction law: linear up to saturation and constant beyond, or with the corner smoothed."},
    {"detail.smoothing", "1", 1e-6, 1, {}, of<&Detail::smoothing>,
     "Half-width of the smoothed corner of the friction law, in units of the saturation speed."},
    {"detail.stick_slip", "", 0, 0, {}, of<&Detail::stick_slip>,
     "Tips have the additional phases stick and slip, with transitions located in time."},

    {"chain.pins", "1", 3, 10000, {}, of<&Chain::pins>, "Number of pins, and of links.", published},
    {"chain.pitch", "m", 1e-3, 5e-2, {}, of<&Chain::pitch>,
     "Distance from pin to pin along a link. A list is repeated cyclically over the links.", published},
    {"chain.damping_ratio", "1", 0, 10, {}, of<&Chain::damping_ratio>, "Damping ratio of every spring and contact of the chain."},
    {"chain.young_modulus", "Pa", 2e8, 3e14, {}, of<&Chain::young_modulus>, "Young's modulus of the pins.", "steel"},

    {"half.length", "m", 1e-3, 1, {}, of<&Half::length>, "Length of a pin.", published},
    {"half.width", "m", 1e-4, 4e-2, {}, of<&Half::width>, "Thickness of a pin half in the direction of travel.", published},
    {"half.mass", "kg", 4e-6, 5, {}, of<&Half::mass>, "Mass of a pin half.", "steel of the pin's size"},
    {"half.area", "m^2", 1e-8, 2e-2, {}, of<&Half::area>, "Cross-section of a pin half; sets its stiffness in length.", published},
    {"half.bending_travel", "N*m^2", 1e-3, 2e3, {}, of<&Half::bending_travel>,
     "Bending stiffness (EI) of a pin half against bending along the direction of travel.", "steel and the half's cross-section"},
    {"half.bending_height", "N*m^2", 1e-2, 2e4, {}, of<&Half::bending_height>,
     "Bending stiffness (EI) of a pin half against bending along its height.", "steel and the half's cross-section"},

    {"plate.count", "1", 1, 64, {}, of<&Plate::count>, "Plates per link.", published},
    {"plate.mass", "kg", 5e-7, 1, {}, of<&Plate::mass>, "Mass of one plate.", "steel of the plate's size"},
    {"plate.stiffness", "N/m", 5e4, 1e11, {}, of<&Plate::stiffness>,
     "Stiffness of one plate in tension.", "sized from the plate's cross-section"},
    {"plate.span", "m", 0, 0.5, {}, of<&Plate::span>, "Distance of the outermost plates of a link from the middle of the pin.", published},
    {"plate.bending_stiffness", "N*m^2", 1e-4, 200, {}, of<&Plate::bending_stiffness>,
     "Bending stiffness (EI) of one plate out of its plane.", "sized from the plate's cross-section"},
    {"plate.torsion_stiffness", "N*m/rad", 1e-2, 2e4, {}, of<&Plate::torsion_stiffness>,
     "Stiffness of one plate against twisting the pins at its ends.", "sized from the plate's cross-section"},
    {"plate.friction_coefficient", "1", 0, 2, {}, of<&Plate::friction, &Friction::coefficient>,
     "Coefficient of friction between neighbouring plates."},
    {"plate.saturation_speed", "m/s", 1e-6, 10, {}, of<&Plate::friction, &Friction::saturation_speed>,
     "Sliding speed at which plate friction saturates.", "calibrated to the published spectrum"},

    {"joint.radius", "m", 1e-3, 1, {}, of<&Joint::radius>, "Radius of the rolling profile of a pin half.", published},
    {"joint.stiffness", "N/m", 1e6, 1e12, {}, of<&Joint::stiffness>,
     "Contact stiffness of the whole rolling line of a joint.", "sized from Hertz' line contact"},
    {"joint.law", "", 0, 0, {"linear", "palmgren"}, of<&Joint::law>, "Contact law of a joint: linear, or Palmgren's power 10/9."},
    {"joint.reference_depth", "m", 1e-9, 1e-3, {}, of<&Joint::reference_depth>,
     "Penetration at which the damping ratio and Palmgren's law apply exactly.", "depth under the baseline's strand force"},
    {"joint.clearance", "m", 1e-7, 1e-3, {}, of<&Joint::clearance>, "Play of the pin halves in the opening of the plates.", published},
    {"joint.clearance_stiffness", "N/m", 1e5, 1e11, {}, of<&Joint::clearance_stiffness>, "Stiffness of the opening beyond the play."},
    {"joint.friction_coefficient", "1", 0, 2, {}, of<&Joint::friction, &Friction::coefficient>,
     "Coefficient of friction in the rolling contact."},
    {"joint.saturation_speed", "m/s", 1e-6, 10, {}, of<&Joint::friction, &Friction::saturation_speed>,
     "Sliding speed at which joint friction saturates.", "calibrated to the published spectrum"},

    {"tip.angle", "rad", 1e-2, 0.8, {}, of<&Tip::angle>, "Angle of the sheave's flank: half the wedge angle.", published},
    {"tip.radius", "m", 1e-3, 10, {}, of<&Tip::radius>, "Radius of the end faces of a pin.", published},
    {"tip.hertz", "N/m^1.5", 2.5e7, 2.5e13, {}, of<&Tip::hertz>,
     "Hertz stiffness of a tip on the sheave.", "sized from Hertz and tip radius"},
    {"tip.reference_depth", "m", 1e-9, 1e-3, {}, of<&Tip::reference_depth>,
     "Penetration at which the damping ratio applies exactly.", "depth under the baseline's clamping force"},
    {"tip.deepest", "m", 1e-6, 1e-2, {}, of<&Tip::deepest>, "A deeper penetration of a tip stops the run with a fault."},
    {"tip.friction_coefficient", "1", 0, 2, {}, of<&Tip::friction, &Friction::coefficient>,
     "Coefficient of friction between tip and sheave.", published},
    {"tip.saturation_speed", "m/s", 1e-6, 10, {}, of<&Tip::friction, &Friction::saturation_speed>,
     "Sliding speed at which tip friction saturates.", "calibrated to the published spectrum"},
    {"tip.friction_law", "", 0, 0, {"constant", "table", "lubricated"}, of<&Tip::friction_law>,
     "Friction of tips beyond the saturation speed: tip.friction_coefficient at every speed; tip.friction_table; or boundary, mixed and "
     "full-film lubrication by an oil (section oil), from tip.friction_coefficient at rest to tip.limiting_traction."},
    {"tip.friction_table", "1", 0, 2, {}, of<&Tip::friction_table>,
     "Coefficient of friction over the sliding speed, with law table: monotone between points, constant outside them. Its largest value is "
     "tip.friction_coefficient.", "measured by the user"},
    {"tip.friction_memory", "m", 0, 1e-2, {}, of<&Tip::friction_memory>,
     "Sliding distance over which friction of tips follows a change of the sliding speed, with a law that depends on it; 0: at once. Rigid "
     "pins only.", "model choice; Dieterich 1979, Ruina 1983"},
    {"tip.limiting_traction", "1", 0, 2, {}, of<&Tip::limiting_traction>,
     "Coefficient of friction of a full film, with law lubricated: the limiting shear stress over the "
     "pressure.", "traction of CVT fluids, Narita and Priest 2007"},
    {"tip.roughness", "m", 1e-9, 1e-4, {}, of<&Tip::roughness>,
     "Root mean square roughness of tip and sheave together, with law lubricated.", "ground steel"},
    {"tip.pressure_sensitivity", "1", -1, 1, {}, of<&Tip::pressure_sensitivity>,
     "Relative change of the friction coefficient of tips per relative change of Hertz' pressure from "
     "tip.reference_pressure.", "no influence"},
    {"tip.reference_pressure", "Pa", 1e6, 1e12, {}, of<&Tip::reference_pressure>,
     "Largest Hertz pressure at which tips have the coefficient of their friction law.", "pressure under the baseline's clamping force"},

    {"oil.temperature", "K", 233.15, 523.15, {}, of<&Oil::temperature>,
     "Temperature of the oil between tips and sheaves, with tip.friction_law lubricated.", "80 degrees Celsius, a warm transmission"},
    {"oil.viscosity_40", "Pa*s", 1e-5, 10, {}, of<&Oil::viscosity_40>,
     "Dynamic viscosity of the oil at 40 degrees Celsius (313.15 K); in between and beyond, Vogel's "
     "equation.", "data sheets of CVT fluids"},
    {"oil.viscosity_100", "Pa*s", 1e-5, 10, {}, of<&Oil::viscosity_100>,
     "Dynamic viscosity of the oil at 100 degrees Celsius (373.15 K).", "data sheets of CVT fluids"},
    {"oil.pressure_viscosity", "1/Pa", 1e-9, 1e-7, {}, of<&Oil::pressure_viscosity>,
     "Pressure-viscosity coefficient of the oil (Barus' law), for its film "
     "thickness.", "mineral and synthetic oils, Hamrock and Dowson 1977"},

    {"heat.enabled", "", 0, 0, {}, of<&Heat::enabled>,
     "Temperatures of pulleys with chain and of the oil follow the losses from t = 0, and the viscosity of tip.friction_law lubricated "
     "follows their mean. They begin at oil.temperature."},
    {"heat.ambient", "K", 233.15, 523.15, {}, of<&Heat::ambient>,
     "Temperature of what cools the oil.", "80 degrees Celsius, a warm transmission"},
    {"heat.pulley_capacity", "J/K", 1e-3, 1e7, {}, of<&Heat::pulley_capacity>,
     "Heat capacity of pulleys and chain. Losses of tips heat them.", "26 kg of steel"},
    {"heat.oil_capacity", "J/K", 1e-3, 1e7, {}, of<&Heat::oil_capacity>,
     "Heat capacity of the oil around them. All other losses heat it.", "1 kg of oil"},
    {"heat.pulley_conductance", "W/K", 0, 1e6, {}, of<&Heat::pulley_conductance>,
     "Heat flow from pulleys and chain to the oil per difference of temperature.", "jet-cooled steel: 500 W/(m^2*K) on 0.2 m^2"},
    {"heat.ambient_conductance", "W/K", 0, 1e6, {}, of<&Heat::ambient_conductance>,
     "Heat flow from the oil to heat.ambient per difference of temperature.", "oil flow of 3 l/min"},

    {"wear.coefficient", "1/Pa", 0, 1e-9, {}, of<&Wear::coefficient>,
     "Archard's coefficient: worn volume per normal force and sliding distance, for cvtflow plot "
     "--wear.", "boundary-lubricated hardened steel, Rabinowicz 1995"},
    {"wear.clamping_limit", "N", 0, 1e7, {}, of<&Wear::clamping_limit>,
     "Largest clamping force that tips bear over their slip speed on a pulley, monotone between points; a run that exceeds it has the note "
     "clamping_limit. 0: no limit.", "measured by the user, as van der Laan 2004"},

    {"pulley.centre_distance", "m", 1e-2, 10, {}, of<&Pulley::centre_distance>, "Distance of the shafts.", published},
    {"pulley.arc_radius", "m", 1e-2, 1e3, {}, of<&Pulley::arc_radius>,
     "Radius of the sheave's crowned flank in an axial section.", published},
    {"pulley.arc_position", "m", 1e-3, 1, {}, of<&Pulley::arc_position>,
     "Radius on the sheave at which the flank angle is tip.angle.", "running radius of the baseline"},
    {"pulley.innermost", "m", 1e-3, 1, {}, of<&Pulley::innermost>,
     "A touching pin on a smaller radius has left the sheave: fault.", published},
    {"pulley.outermost", "m", 1e-3, 1, {}, of<&Pulley::outermost>,
     "A touching pin on a larger radius has left the sheave: fault.", published},
    {"pulley.sheave_mass", "kg", 3e-3, 3e3, {}, of<&Pulley::sheave_mass>, "Mass of a sheave.", typical_size},
    {"pulley.sheave_polar_inertia", "kg*m^2", 8e-6, 8, {}, of<&Pulley::sheave_polar_inertia>,
     "Moment of inertia of a sheave about the shaft.", typical_size},
    {"pulley.sheave_tilt_inertia", "kg*m^2", 4e-6, 5, {}, of<&Pulley::sheave_tilt_inertia>,
     "Moment of inertia of a sheave about a diameter.", typical_size},
    {"pulley.shaft_mass", "kg", 7e-3, 7e3, {}, of<&Pulley::shaft_mass>, "Mass of a shaft.", typical_size},
    {"pulley.shaft_polar_inertia", "kg*m^2", 2e-5, 20, {}, of<&Pulley::shaft_polar_inertia>,
     "Moment of inertia of a shaft about its axis.", typical_size},
    {"pulley.shaft_tilt_inertia", "kg*m^2", 2e-5, 20, {}, of<&Pulley::shaft_tilt_inertia>,
     "Moment of inertia of a shaft about a diameter.", typical_size},
    {"pulley.bearing_radial", "N/m", 5e5, 5e11, {}, of<&Pulley::bearing_radial>,
     "Radial stiffness of the bearings of a shaft.", typical_size},
    {"pulley.bearing_axial", "N/m", 5e5, 5e11, {}, of<&Pulley::bearing_axial>, "Axial stiffness of the bearings of a shaft.", typical_size},
    {"pulley.bearing_tilt", "N*m/rad", 2e3, 2e9, {}, of<&Pulley::bearing_tilt>,
     "Tilting stiffness of the bearings of a shaft.", typical_size},
    {"pulley.attachment_radial", "N/m", 1e6, 1e12, {}, of<&Pulley::attachment_radial>,
     "Radial stiffness between sheave and shaft.", typical_size},
    {"pulley.attachment_axial", "N/m", 1e6, 1e12, {}, of<&Pulley::attachment_axial>,
     "Axial stiffness between fixed sheave and shaft.", typical_size},
    {"pulley.attachment_tilt", "N*m/rad", 1e3, 2e9, {}, of<&Pulley::attachment_tilt>,
     "Tilting stiffness between sheave and shaft; determines the opening of the wedge.", typical_size},
    {"pulley.attachment_torsion", "N*m/rad", 5e2, 5e8, {}, of<&Pulley::attachment_torsion>,
     "Torsional stiffness between sheave and shaft.", typical_size},
    {"pulley.cylinder_damping", "N*s/m", 0, 2e8, {}, of<&Pulley::cylinder_damping>,
     "Damping of a movable sheave against its shaft by the cylinder."},
    {"pulley.damping_ratio", "1", 0, 10, {}, of<&Pulley::damping_ratio>, "Damping ratio of bearings and attachments."},

    {"imperfection.misalignment", "m", -5e-3, 5e-3, {}, of<&Imperfection::misalignment>,
     "Axial displacement of pulley 2 from where its groove is opposite that of pulley 1.", "a perfect machine"},
    {"imperfection.sheave", "", 0, 0, {"1-", "1+", "2-", "2+"}, of<&Imperfection::sheave>,
     "Sheave that imperfection.runout, attachment and unbalance are about: shaft and side; 1+ and 2- are movable."},
    {"imperfection.runout", "m", 0, 1e-3, {}, of<&Imperfection::runout>,
     "Radial run-out of the sheave's flank: distance of its axis from the shaft's, about which it turns. Without its "
     "unbalance.", "a perfect machine"},
    {"imperfection.attachment", "1", 1e-2, 100, {}, of<&Imperfection::attachment>,
     "Stiffness of the sheave's attachment against tilt over pulley.attachment_tilt; pulleys must be elastic.", "a perfect machine"},
    {"imperfection.unbalance", "kg*m", 0, 1e-2, {}, of<&Imperfection::unbalance>,
     "Unbalance of the sheave: its mass times the distance of its centre of mass from its axis; pulleys must be "
     "elastic.", "a perfect machine"},
    {"imperfection.pin_length_spread", "m", 0, 5e-5, {}, of<&Imperfection::pin_length_spread>,
     "Standard deviation of the lengths of pins from half.length: normal distribution, cut at three times as much.", "a perfect machine"},
    {"imperfection.pin_length_seed", "1", 0, 9007199254740992, {}, of<&Imperfection::pin_length_seed>,
     "Seed by which lengths of pins are drawn."},
        // clang-format on
    };
}

std::vector<Parameter> parameters_of_run() {
    using namespace model;
    return {
        // clang-format off
    {"start.layout", "", 0, 0, {"belt", "ring"}, of<&Start::layout>, "Initial shape of the chain: around the pulleys, or a free ring."},
    {"start.ratio", "1", 0.05, 20, {}, of<&Start::ratio>,
     "Speed ratio of the geometric start: running radius on shaft 2 over that on shaft 1."},
    {"start.ring_speed", "rad/s", -3000, 3000, {}, of<&Start::ring_speed>, "Speed of rotation of the free ring."},
    {"start.settling_time", "s", 0, 10, {}, of<&Start::settling_time>,
     "Time for which a geometric start settles before time zero.", "vibrations of the start have died out"},
    {"start.ramp_time", "s", 1e-9, 10, {}, of<&Start::ramp_time>,
     "Clamping and load are raised over this time at the beginning of settling."},
    {"start.state", "", 0, 0, {}, of<&Scene::state_file>,
     "File of a recorded state to start from, relative to the scene file; empty: geometric start. A state that does not fit this machine "
     "(its elastic energy differs by more than 1 %) is not used: the run settles anew."},

    {"run.method", "", 0, 0, {}, of<&RunSettings::method>,
     "Integration method, a name from the catalogue; auto: by detail and friction law, leapfrog-rigid for rigid pins, leapfrog-sweep for "
     "pin halves with the piecewise law, otherwise leapfrog-chebyshev (cvtflow list methods)."},
    {"run.step", "s", 1e-12, 1e-2, {"auto"}, of<&RunSettings::step>,
     "Time step; with run.step_control = \"error\" the longest one. auto: 0.85 of the stability limit, evaluated every ms (cvtflow "
     "check)."},
    {"run.step_control", "", 0, 0, {"fixed", "report", "error"}, of<&RunSettings::step_control>,
     "fixed: steps of run.step; report: the same, with their local error; error: steps as long as run.tolerance allows, up to run.step."},
    {"run.tolerance", "1", 1e-12, 1e3, {}, of<&RunSettings::tolerance>,
     "Largest local error of a step: of any link, root mean square of errors in units of 1 um and of the saturation speed of tips."},
    {"run.until", "s", 1e-9, 1e4, {"steady"}, of<&RunSettings::until>,
     "The run ends at this time; steady: once its means over the last half of its time are steady (run.steady)."},
    {"run.steady", "1", 0.005, 0.2, {}, of<&RunSettings::steady>,
     "Largest error of means for run.until = \"steady\", relative to each; of the efficiency relative to the losses, or a fiftieth of it."},
    {"run.steady_limit", "1", 1, 200, {}, of<&RunSettings::steady_limit>,
     "Longest run with run.until = \"steady\", in revolutions of the chain; a run that is not steady then ends as not_steady."},
    {"run.output_interval", "s", 1e-12, 1e4, {}, of<&RunSettings::output_interval>, "Time between records of the channels."},
    {"run.state_interval", "s", 1e-12, 1e4, {}, of<&RunSettings::state_interval>,
     "Time between records of the full state; at outputs, so at each where it is shorter than run.output_interval."},
    {"run.max_steps", "1", 0, 9007199254740992, {}, of<&RunSettings::max_steps>, "The run stops after this many steps; 0: no limit."},
    {"run.max_wall", "s", 0, 1e9, {}, of<&RunSettings::max_wall>, "The run stops after this much wall-clock time; 0: no limit."},
    {"run.followed_pin", "1", 0, 9999, {}, of<&RunSettings::followed_pin>,
     "Pin with additional channels (followed_pin/…), counted from 0."},
    {"run.schedule", "", 0, 0, {}, of<&RunSettings::schedule>,
     "Executor of the step's task graph, a name from the catalogue, or auto: the fastest by trials during the run; does not change "
     "results."},
    {"run.assembly", "", 0, 0, {"fused", "staged"}, of<&RunSettings::assembly>,
     "Tasks of a step: one per segment, or one per stage and segment as published (cvtflow-lab); does not change results."},
    {"run.partition", "", 0, 0, {"equal", "balanced"}, of<&RunSettings::partition>,
     "Segments of equal numbers of links, or of about equal cost; does not change results."},
    {"run.segments", "1", 0, 10000, {}, of<&RunSettings::segments>,
     "Number of segments of the chain for parallel work, 0: as many as threads; does not change results."},
    {"run.threads", "1", 0, 1024, {}, of<&RunSettings::threads>,
     "Number of threads, at most with schedule auto; 0: all processors of this process. Does not change results."},
    {"run.seed", "1", 0, 9007199254740992, {}, of<&RunSettings::seed>, "Seed of random numbers."},

    {"record.ledger", "", 0, 0, {}, of<&Parameters::ledger>, "Losses and works by kind are integrated along with the state."},
    {"record.channels", "", 0, 0, {}, of<&RunSettings::channels>,
     "Channels recorded in addition to the usual ones, or groups such as tips/*; cvtflow list channels shows all."},
    {"record.means", "", 0, 0, {}, of<&RunSettings::means>,
     "An output is the mean over the time since the output before, by ten samples per pin period at least, and not the value of its "
     "instant. Sums so far, angles and places stay those of the instant."},
        // clang-format on
    };
}

}  // namespace

std::span<const Parameter> parameter_table() {
    static const std::vector<Parameter> table = [] {
        std::vector<Parameter> rows = parameters_of_machine();
        for (auto& more : {parameters_of_drive(), parameters_of_run()}) rows.insert(rows.end(), more.begin(), more.end());
        return rows;
    }();
    return table;
}

}  // namespace cvtflow::tasks
