#pragma once
/// Progress of work that takes long, on stderr: a line that is redrawn on a terminal, plain lines elsewhere (logs, pipes), or nothing.

#include <chrono>
#include <string>

#include "tasks/run/run.hpp"

namespace cvtflow::tools {

/// A line on stderr: redrawn at most 10 times a second on a terminal that can redraw a line, printed at most every 10 s elsewhere.
class StatusLine {
public:
    /// @param plain  also on a terminal as elsewhere
    explicit StatusLine(bool quiet, bool plain = false);
    ~StatusLine() { clear(); }
    StatusLine(const StatusLine&) = delete;
    StatusLine& operator=(const StatusLine&) = delete;

    [[nodiscard]] bool quiet() const noexcept { return quiet_; }
    [[nodiscard]] bool redraws() const noexcept { return redraws_; }
    /// Whether the time for another line has come; never if quiet.
    [[nodiscard]] bool due() const;
    void show(const std::string& line);
    /// Counts the time until the next line from now.
    void wait() { shown_ = Clock::now(); }
    /// A message that stays, unless quiet.
    void say(const std::string& what);
    /// Takes the line off the terminal.
    void clear();

private:
    using Clock = std::chrono::steady_clock;

    bool quiet_, redraws_, drawn_ = false;
    Clock::time_point shown_{};
};

/// Progress of a run: elsewhere than on a terminal also a line per 10 % of a phase.
class ProgressDisplay {
public:
    /// @param until end of the run that follows settling, for the time left [s]
    ProgressDisplay(bool quiet, double until) : line_(quiet), until_(until) { line_.wait(); }

    void show(const tasks::Progress& progress);
    /// Options of a run that shows its progress here and that Ctrl-C ends.
    [[nodiscard]] tasks::RunOptions options();

private:
    StatusLine line_;
    double until_;
    const char* phase_ = nullptr;
    double phase_wall_ = 0.0;  ///< wall time when the phase began [s]
    int tenths_ = 0;           ///< completed tenths of the phase, as last printed
};

}  // namespace cvtflow::tools
