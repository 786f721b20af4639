#pragma once
/// Progress of work that takes long, on stderr: a line that is redrawn on a terminal, plain lines elsewhere (logs, pipes), or nothing.

#include <chrono>
#include <string>

#include "tasks/run/run.hpp"

namespace cvtflow::tools {

/// A line on stderr: redrawn at most 10 times a second on a terminal that can redraw a line, printed at most every 10 s elsewhere.
class StatusLine {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr Clock::duration usual_wait = std::chrono::seconds(10);

    /// @param plain  also on a terminal as elsewhere   @param wait  between lines that stay
    explicit StatusLine(bool quiet, bool plain = false, Clock::duration wait = usual_wait);
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
    bool quiet_, redraws_, drawn_ = false;
    Clock::duration wait_;
    Clock::time_point shown_{};
};

/// Progress of a run.
class ProgressDisplay {
public:
    /// @param until end of the run that follows settling, for the time left [s]   @param wait  as of StatusLine
    ProgressDisplay(bool quiet, double until, StatusLine::Clock::duration wait = StatusLine::usual_wait)
        : line_(quiet, false, wait), until_(until) {
        line_.wait();
    }

    void show(const tasks::Progress& progress);
    /// Options of a run that shows its progress here and that Ctrl-C ends.
    [[nodiscard]] tasks::RunOptions options();

private:
    StatusLine line_;
    double until_;
    const char* phase_ = nullptr;
    double phase_wall_ = 0.0;  ///< wall time when the phase began [s]
};

}  // namespace cvtflow::tools
