#pragma once
/// Progress of a run, on stderr: a bar on a terminal, plain lines elsewhere (logs, pipes), or nothing.

#include <chrono>
#include <string>

#include "tasks/run/run.hpp"

namespace cvtflow::tools {

enum class ProgressStyle { silent, lines, bar };

/// Bar on a terminal that can redraw a line, lines elsewhere.
[[nodiscard]] ProgressStyle progress_style(bool quiet);

/// Contents of the display.
struct ProgressNumbers {
    std::string phase;   ///< "settling" or "running"
    double time, until;  ///< simulated [s]
    double share;        ///< of this phase, 0 … 1
    double slowness;     ///< wall seconds per simulated second; 0: not known yet
    double left;         ///< wall time until the whole run is done [s]
};

/// `running  [=====>    ]  52 %  t = 2.6 ms of 5 ms  412 s/s (0.00243 x real time)  1:10 left`, at most `columns` long: the bar shrinks,
/// then the rate goes, then the line is cut.
[[nodiscard]] std::string bar_text(const ProgressNumbers& numbers, int columns);
/// `running: 52 %, t = 2.6 ms of 5 ms, 412 s per simulated second (0.00243 x real time), 1:10 left`
[[nodiscard]] std::string line_text(const ProgressNumbers& numbers);

/// Draws at most 10 times a second on a terminal; elsewhere a line per 10 % of a phase, or per 10 s if that is sooner.
class ProgressDisplay {
public:
    /// @param until end of the run that follows settling, for the time left [s]
    ProgressDisplay(ProgressStyle style, double until) : style_(style), until_(until) {}
    ~ProgressDisplay() { clear(); }
    ProgressDisplay(const ProgressDisplay&) = delete;
    ProgressDisplay& operator=(const ProgressDisplay&) = delete;

    void show(const tasks::Progress& progress);
    /// Takes the bar off the screen.
    void clear();

private:
    [[nodiscard]] ProgressNumbers numbers(const tasks::Progress& progress);
    void draw(const ProgressNumbers& now);
    void print(const ProgressNumbers& now);

    using Clock = std::chrono::steady_clock;

    ProgressStyle style_;
    double until_;
    std::string phase_;
    double phase_wall_ = 0.0;  ///< wall time when the phase began [s]
    int tenths_ = 0;           ///< of the phase, as last printed
    Clock::time_point shown_{};
    bool drawn_ = false;
};

}  // namespace cvtflow::tools
