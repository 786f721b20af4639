#pragma once
/// Chooses one of several schedules for a run. Bookkeeping only: it knows neither clock nor thread, so that it can be tested on invented
/// machines. The run itself is the measurement: results do not depend on the schedule. At the start each candidate has a turn, then the
/// fastest stays; all have a turn again when the pace has changed by a third, and now and then. Threads must pay: each candidate must be
/// faster than those with fewer threads by a margin.

#include <vector>

namespace cvtflow::tasks {

struct ChooserOptions {
    double window = 0.02;                              ///< length of a turn, and of work between two looks at its pace [s]
    double gain = 1.05;                                ///< speed-up that more threads must bring [1]
    double change = 1.3;                               ///< change of pace, two windows in a row, that calls for turns [1]
    double first_period = 1.0, longest_period = 30.0;  ///< time to the next turns, doubled as long as the choice stays [s]
};

/// Measured pace of a series of steps.
struct Pace {
    double seconds = 0.0;    ///< wall time, the arrival of threads included [s]
    double per_cycle = 0.0;  ///< wall time per cycle once threads have arrived [s]
};

class ScheduleChooser {
public:
    /// @param candidates their number; those with the fewest threads come first
    ScheduleChooser(int candidates, const ChooserOptions& options);

    /// Candidate to run now.
    [[nodiscard]] int candidate() const noexcept { return now_; }
    /// Time after which to call record() [s].
    [[nodiscard]] double window() const noexcept { return options_.window; }
    /// The candidate has run for about window(). Allocates nothing. @return whether another one runs now
    bool record(const Pace& pace) noexcept;

    [[nodiscard]] int chosen() const noexcept { return chosen_; }
    /// Number of rounds of turns that are complete, and of changes of the choice.
    [[nodiscard]] long checks() const noexcept { return checks_; }
    [[nodiscard]] long changes() const noexcept { return changes_; }
    /// Time per cycle in its last turn; 0: it has had none [s].
    [[nodiscard]] double per_cycle(int candidate) const noexcept { return paces_[static_cast<std::size_t>(candidate)]; }

private:
    void end_turns() noexcept;

    ChooserOptions options_;
    std::vector<double> paces_;  ///< [candidate] of its last turn [s]
    int now_ = 0, chosen_ = 0;
    bool trying_;           ///< candidates have turns
    int drifting_ = 0;      ///< windows in a row whose pace differs
    double since_ = 0.0;    ///< time since the last turns [s]
    double period_;         ///< time from one round of turns to the next [s]
    double soonest_ = 0.0;  ///< the same, whatever the pace: turns take a tenth of the time at most [s]
    long checks_ = 0, changes_ = 0;
};

}  // namespace cvtflow::tasks
