#pragma once
/// Chooses one of several schedules for a run. Bookkeeping only: from the measured speed it determines what to run next and for how long;
/// it knows neither clock nor thread, so that its promise can be tested on invented machines.
///
/// The run itself is the measurement: schedules take turns on its steps (results do not depend on the schedule), so a trial costs only
/// the time by which the schedule on trial is slower than the one in use. These losses are counted, and a turn is taken only while their
/// sum, assuming that this turn is wasted, stays below `max_trial_share` of the time so far. One turn is taken sooner: that of the fewest
/// threads beyond the first candidate's, once the owner answers that as many threads meet fast. A run too short for a trial stays with the
/// first candidate. Threads must pay: of candidates that are about equally fast the one with the fewest is chosen.
///
///     a turn of work, then windows ── asks(): threads meet fast ──► an early turn, and one more of work ──► the faster of both
///          │ they have not until trials are affordable                                                           │
///          ▼                                                                                                      ▼
///     work (windows) ── due and affordable ──► check: rounds of turns of all candidates ──► medians ──► work
///          ▲ not affordable: back to work for a window, the check continues afterwards ─┘

#include <optional>
#include <span>
#include <vector>

namespace cvtflow::tasks {

struct ChooserOptions {
    double window = 0.05;           ///< work between two checks of the clock [s]
    double turn = 0.004;            ///< length of a turn of a candidate on trial [s]
    int rounds = 5;                 ///< turns of each candidate in a check
    double max_trial_share = 0.01;  ///< largest cost of trials as a share of the time
    double meeting = 0.25e-6;       ///< time in which threads meet that are tried early [s] (DECISIONS 19)
    double gain = 1.05;             ///< speed-up that threads which are not in use yet must bring [1]
    double min_lead = 1.02;         ///< speed-up with which one replaces another, and which that must keep over fewer threads [1]
    double abandon_factor = 1.5;    ///< a turn slower than work by this factor ends a candidate's part in a check [1]
    double drift = 1.12;            ///< change of pace, two windows in a row, that calls for a check [1]
    double changed_links = 0.1;     ///< relative change in the number of touching links that calls for a check
    double first_period = 1.0;      ///< longest time to the next check … [s]
    double longest_period = 30.0;   ///< … doubled up to here as long as the choice stays [s]
};

/// Measured pace of a series of steps.
struct Pace {
    double seconds = 0.0;    ///< wall time, the arrival of threads included [s]
    double per_cycle = 0.0;  ///< wall time per cycle once threads have arrived [s]
    int touching = 0;        ///< links that touch now
};

/// Time of a run, and the part of it that trials have cost.
struct TrialBudget {
    double elapsed = 0.0, lost = 0.0;  ///< [s]

    /// Whether all that trials have cost and, at worst, one more turn is within the allowed share.
    [[nodiscard]] bool affords(const ChooserOptions& options) const noexcept {
        return lost + options.turn <= options.max_trial_share * elapsed;
    }
    /// Whether a question may be asked: within half that share, so that a turn becomes affordable.
    [[nodiscard]] bool affords_question(const ChooserOptions& options) const noexcept {
        return lost <= 0.5 * options.max_trial_share * elapsed;
    }
    /// A turn on trial. @param work time per cycle without it [s]
    void tried(const Pace& pace, double work) noexcept;
};

/// Notices that the run has changed since the last check: its pace, or the number of links that touch.
class PaceWatch {
public:
    [[nodiscard]] bool changed(const Pace& pace, const ChooserOptions& options) noexcept;
    /// The pace is another one from here on.
    void restart() noexcept;
    /// A check begins, with as many links that touch.
    void checks_at(int touching) noexcept { touching_ = touching; }

private:
    double reference_ = 0.0;       ///< time per cycle of the first window; 0: not known [s]
    int drifting_ = 0;             ///< windows in a row whose pace differs
    std::optional<int> touching_;  ///< links that touched at the last check
};

class ScheduleChooser {
public:
    /// @param threads of each candidate, at least one; the first is the reference and has the fewest
    ScheduleChooser(std::span<const int> threads, const ChooserOptions& options);

    /// Candidate to run now.
    [[nodiscard]] int candidate() const noexcept { return now_; }
    /// Time after which to call record() [s].
    [[nodiscard]] double window() const noexcept { return trying_ || work_ == 0.0 ? options_.turn : options_.window; }
    /// The candidate has run for about window(). Allocates nothing. @return whether another one runs now, or it asks()
    bool record(const Pace& pace) noexcept;

    /// Number of threads whose meeting is to be timed before the next step, so that an early turn is taken only where it is likely to gain;
    /// 0: none. Before the first check, after a window of work, while the answers take no more than half of `max_trial_share` of the time.
    [[nodiscard]] int asks() const noexcept { return asks_ ? candidates_[static_cast<std::size_t>(by_threads_[1])].threads : 0; }
    /// @param meeting time in which they meet; infinite: they do not [s]   @param seconds that it took to find out
    void answer(double meeting, double seconds) noexcept;
    /// The run ends, perhaps within a turn: the next one begins with work.
    void interrupt() noexcept;

    [[nodiscard]] int chosen() const noexcept { return chosen_; }
    [[nodiscard]] long checks() const noexcept { return checks_; }
    [[nodiscard]] long changes() const noexcept { return changes_; }
    /// Median time per cycle in the last check in which it had a turn; before the first check that of the early turn, or of the work beside
    /// it; 0: none [s].
    [[nodiscard]] double per_cycle(int candidate) const noexcept { return candidates_[static_cast<std::size_t>(candidate)].median; }
    /// Time that all trials have cost [s].
    [[nodiscard]] double lost() const noexcept { return budget_.lost; }

private:
    struct Candidate {
        int threads = 1;
        std::vector<double> turns;  ///< times per cycle in the present check; room for all rounds [s]
        double median = 0.0;        ///< [s]
        bool out = false;           ///< takes no further turn in the present check
    };

    void worked(const Pace& pace) noexcept;
    void tried_early(const Pace& pace) noexcept;
    void tried(const Pace& pace) noexcept;
    void begin_check() noexcept;
    void next_turn() noexcept;
    void end_check() noexcept;
    void choose(int candidate) noexcept;
    [[nodiscard]] int fastest() const noexcept;
    [[nodiscard]] double lead(int candidate, int other) const noexcept;

    ChooserOptions options_;
    std::vector<Candidate> candidates_;
    std::vector<int> by_threads_;  ///< candidates, those with the fewest threads first
    int now_ = 0, chosen_ = 0;
    bool trying_ = false;       ///< candidate() is on trial
    bool checking_ = false;     ///< a check has begun and not ended
    bool asks_ = false;         ///< asks() waits for its answer
    bool tried_early_ = false;  ///< the early turn is over
    int next_ = 0, round_ = 0;  ///< candidate and round of the next turn in the check
    double work_ = 0.0;         ///< time per cycle of the last window of work; 0: there was none [s]
    TrialBudget budget_;
    PaceWatch watch_;
    double since_check_ = 0.0, period_;  ///< [s]
    long checks_ = 0, changes_ = 0;
};

}  // namespace cvtflow::tasks
