#pragma once
/// Choice of a schedule by measurement.

#include <string>
#include <vector>

#include "tasks/schedule.hpp"

namespace cvtflow::tasks {

/// What was measured for one candidate.
struct Candidate {
    Schedule schedule;
    double seconds_per_step = 0.0;   ///< median over alternating runs [s]
};

struct Choice {
    Schedule schedule;
    std::vector<Candidate> candidates;   ///< serial first; empty if there was nothing to choose
    std::string reason;                  ///< one line for the summary
};

/// Measures serial and parallel schedules side by side on the scene's own start state, some tenths of a second, and takes the fastest;
/// a parallel one only if it beats serial by 5 %, so that noise does not cost the user a processor. Fixed segments, threads, assembly and partition of the
/// scene are respected. One usable processor: serial, unmeasured.
[[nodiscard]] Choice choose_schedule(const Scene& scene);

/// The scene's own schedule, or the chosen one if run.schedule is "auto".
[[nodiscard]] Schedule schedule_for(const Scene& scene);

}  // namespace cvtflow::tasks
