#pragma once
/// Names of the notes on unusual results of a run, with their meanings: for lists, documents and hosts.

#include <string_view>

namespace cvtflow::tasks {

struct NoteKind {
    std::string_view name, meaning;
};

inline constexpr NoteKind note_kinds[] = {
    {"gross_slip", "mean slip above 3 % in a fiftieth of the run, of at least four pin periods, or in all of it"},
    {"control_limit",
     "a controller was at the limit of its authority in more than 5 % of the last fifth; where the target changes, of the run"},
    {"target_missed",
     "the mean of what the first controller holds is off its target by more than 1 % in the last fifth; where the target changes, in any; "
     "where control.when_steady = \"hold\", by more than 0.3 %"},
    {"control_swing",
     "a clamping force that a controller makes swings: its standard deviation is above 5 % of its mean in each of the last four times 64 "
     "pin periods, or in each quarter of the last fifth if that is shorter"},
    {"slack_strand", "a strand carried no tension in more than 5 % of the last fifth"},
    {"clamping_limit", "a clamping force was above wear.clamping_limit at the slip speed at some time"},
    {"clamping_floor",
     "clamping.driven, or hydraulics.driven_pressure, decided the clamping force of shaft 2 in more than 5 % of the time, and not "
     "clamping.safety"},
    {"efficiency", "more is lost than comes in, in the whole run or in its last fifth: there is no efficiency"},
    {"unsteady",
     "the state changes: a mean of thrust ratio, tensions, slips or losses certainly moves by more than 1 % of it (slips below 0.3 %: of "
     "0.3 %) from begin to end, of the ratio by more than 0.1 %; the stored energy changes by more than 2 % of the input; or it was seen "
     "for less than a pin period"},
    {"uncertain",
     "means are not known to 1 %: an error of those means, by trend and scatter, is above these limits, or there are fewer than four pin "
     "periods, which do not show it"},
    {"standstill", "the shafts turn by less than 0.1 rad/s: slip is noise"},
    {"no_load", "drive and load transfer less power than the machine loses: slip and efficiency are those of idling"},
    {"cycle_missed", "speed or work of shaft 2 are off what the cycle needs by more than 2 % of the run's; the status of the run as well"},
    {"unresolved", "losses below the resolution of the energy balance: it would not show an error of 5 % in them"},
};

}  // namespace cvtflow::tasks
