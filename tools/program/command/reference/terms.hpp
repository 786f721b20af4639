#pragma once
/// Words of the field and of this program that are no keys: for cvtflow explain and cvtflow list terms.

#include <string_view>

namespace cvtflow::tools {

struct Term {
    std::string_view word, meaning;
};

inline constexpr Term terms[] = {
    {"variator", "Two pulleys and a chain, whose ratio changes without steps."},
    {"shaft", "Shaft 1 drives, shaft 2 is driven; each carries a pulley."},
    {"pulley", "Two sheaves on a shaft, with the chain between them."},
    {"sheave", "A cone of a pulley. One of the two is fixed, the other one moves along the shaft."},
    {"clamping force", "Force that presses the movable sheave toward the chain: S_1 on shaft 1, S_2 on shaft 2."},
    {"thrust ratio", "S_1/S_2, which holds a ratio under a load (KpKs in papers)."},
    {"ratio",
     "Speed of shaft 1 over that of shaft 2; above 1 the variator slows down (low, underdrive), below 1 it speeds up (overdrive)."},
    {"running radius", "Radius of the chain on a pulley, as the position of the movable sheave gives it."},
    {"wrap", "Angle of a pulley along which the chain touches it."},
    {"pin", "Rocker pin between two links: two halves that roll on each other."},
    {"half", "Half of a pin. Its two ends are tips."},
    {"tip", "End of a half, which touches a sheave; friction of the tips carries the torque."},
    {"link", "What joins two pins: plates side by side."},
    {"plate", "Strip of steel around the halves of two neighbouring pins, which carries tension."},
    {"joint", "Rolling contact of the two halves of a pin."},
    {"pitch", "Distance from pin to pin along a link; unequal pitches make less tone."},
    {"strand", "Free part of the chain between the pulleys: the tight one pulls more than the slack one."},
    {"guide", "Slide rails on both sides of a strand, which bound its vibrations."},
    {"slip", "1 - ratio of speeds over ratio of radii by the pins: creep of a chain that holds, or sliding (gross or macro slip)."},
    {"creep", "Sliding of tips that a chain which holds needs to carry its torque: some per mille."},
    {"creep loss", "Power that tips lose by sliding along the circumference, over the power that is transmitted."},
    {"slip by friction", "Slip that friction makes: the part of it that is zero without torque (friction_slip)."},
    {"safety factor", "Largest torque that friction carries over the load's; below 1 the chain slides."},
    {"torque limit", "2 mu S_2 r_2/cos(beta): the load of safety factor 1."},
    {"pin period", "Time in which a pin takes the place of the next one; means are over whole pin periods."},
    {"settle", "Run from the geometric start until its vibrations have decayed (start.settling_time), before time zero."},
    {"steady", "Of a run with run.until = \"steady\": means over the last half of its time have errors below run.steady."},
    {"not_steady", "Status of such a run that was not steady within run.steady_limit revolutions of the chain."},
    {"cycle_missed", "Status of a run whose shaft 2 is off what its cycle needs by more than 2 %, in speed or work of the whole run."},
    {"efficiency", "1 - losses/input: a quotient of energies over whole pin periods; undefined where none flows. tiny has below 90 %."},
    {"archard", "Law of wear: worn volume is wear.coefficient times normal force times sliding distance (cvtflow plot --wear)."},
    {"rainflow", "Counting of load cycles by ASTM E1049 (cvtflow table --rainflow)."},
    {"scene", "File of a machine, its inputs and a run (TOML)."},
    {"level of detail", "How much of pins, plates and pulleys is modelled: rigid, fine, full."},
    {"sweep", "File that varies keys of a scene; each variant is a case, and each case a row of a table."},
    {"record", "File of a run: channels over time, states, the scene (HDF5)."},
    {"channel", "A recorded quantity: cvtflow list channels."},
    {"state", "File of positions and velocities from which runs start (start.state)."},
    {"checkpoint", "File from which an interrupted run continues bit for bit."},
    {"transition", "Change of a tip's phase: it touches, leaves, sticks or slides; one that just changed is suppressed for a step."},
    {"schedule", "Executor of the tasks of a step; auto chooses the fastest by trials during the run (run.schedule)."},
    {"unreliable", "Status of a run whose energy balance does not close: its step was too long, or its model is ill-posed."},
    {"kernels", "The compiled arithmetic of the step for one instruction set; all give the same bits."},
};

}  // namespace cvtflow::tools
