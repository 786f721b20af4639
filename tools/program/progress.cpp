#include "tools/program/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "tools/program/guard.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

constexpr int widest_bar = 32;
constexpr int narrowest_bar = 8;
constexpr const char *settling = "settling", *running = "running";

/// Contents of the line.
struct ProgressNumbers {
    const char* phase;
    double time, until;  ///< simulated [s]
    double share;        ///< completed share of this phase, 0 … 1
    double slowness;     ///< wall seconds per simulated second; 0: not known yet
    double left;         ///< wall time until the whole run is done [s]
};

int terminal_columns() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string bar(double share, int width) {
    const int full = std::clamp(static_cast<int>(share * width), 0, width);
    std::string text = fmt::format("{:=<{}}", "", full);
    if (full < width) text += '>';
    return fmt::format("[{:<{}}]", text, width);
}

std::string rate_text(double slowness, std::string_view per) {
    return slowness > 0.0 ? fmt::format("{:.4g} {} ({:.3g} x real time)", slowness, per, 1.0 / slowness) : "";
}

std::string left_text(const ProgressNumbers& now) { return now.slowness > 0.0 ? clock_text(now.left) + " left" : ""; }

/// "t = 2.6 ms of 5 ms"; without the end while settling, which ends at 0.
std::string when_text(const ProgressNumbers& now) {
    const std::string when = "t = " + time_text(now.time);
    return now.until > 0.0 ? when + " of " + time_text(now.until) : when;
}

/// Appends text that is not empty.
void append(std::string& line, const std::string& separator, const std::string& part) {
    if (!part.empty()) line += separator + part;
}

/// `running  [=====>    ]  52 %  t = 2.6 ms of 5 ms  412 s/s (0.00243 x real time)  1:10 left`, at most `columns` long: the bar shrinks,
/// then the rate goes, then the line is cut.
std::string bar_text(const ProgressNumbers& now, int columns) {
    const std::string head = fmt::format("{:<8} ", now.phase);
    std::string tail = fmt::format(" {:3.0f} %  {}", 100.0 * now.share, when_text(now));
    std::string with_rate = tail;
    append(with_rate, "  ", rate_text(now.slowness, "s/s"));
    append(tail, "  ", left_text(now));
    append(with_rate, "  ", left_text(now));
    const auto room = [&](const std::string& rest) { return columns - 3 - static_cast<int>(head.size() + rest.size()); };
    if (room(with_rate) >= narrowest_bar) tail = with_rate;
    const int width = std::min(room(tail), widest_bar);
    const std::string line = width >= narrowest_bar ? head + bar(now.share, width) + tail : head + tail.substr(1);
    return line.substr(0, static_cast<std::size_t>(std::max(0, columns - 1)));
}

/// `running: 52 %, t = 2.6 ms of 5 ms, 412 s per simulated second (0.00243 x real time), 1:10 left`
std::string line_text(const ProgressNumbers& now) {
    std::string line = fmt::format("{}: {:.0f} %, {}", now.phase, 100.0 * now.share, when_text(now));
    append(line, ", ", rate_text(now.slowness, "s per simulated second"));
    append(line, ", ", left_text(now));
    return line;
}

}  // namespace

StatusLine::StatusLine(bool quiet, bool plain, Clock::duration wait) : quiet_(quiet), redraws_(false), wait_(wait) {
    const char* terminal = std::getenv("TERM");
    redraws_ = !plain && isatty(STDERR_FILENO) == 1 && terminal != nullptr && std::string_view(terminal) != "dumb";
}

bool StatusLine::due() const {
    using namespace std::chrono_literals;
    return !quiet_ && ((redraws_ && !drawn_) || Clock::now() - shown_ >= (redraws_ ? Clock::duration(100ms) : wait_));
}

void StatusLine::show(const std::string& line) {
    if (quiet_) return;
    to_stderr(redraws_ ? fmt::format("\r{}\x1b[K", line) : line + "\n");
    drawn_ = redraws_;
    wait();
}

void StatusLine::say(const std::string& what) {
    clear();
    tools::say(quiet_, what);
}

void StatusLine::clear() {
    if (std::exchange(drawn_, false)) to_stderr("\r\x1b[K");
}

void ProgressDisplay::show(const tasks::Progress& p) {
    const char* phase = p.settling() ? settling : running;
    if (std::exchange(phase_, phase) != phase) phase_wall_ = p.wall;
    if (!line_.due()) return;
    const double span = p.until - p.begin, done = p.time - p.begin;
    const double share = span > 0.0 ? std::clamp(done / span, 0.0, 1.0) : 1.0;
    const double slowness = done > 0.0 ? (p.wall - phase_wall_) / done : 0.0, to_come = p.until - p.time + (p.settling() ? until_ : 0.0);
    const ProgressNumbers now{phase, p.time, p.until, share, slowness, slowness * to_come};
    line_.show(line_.redraws() ? bar_text(now, terminal_columns()) : line_text(now));
}

tasks::RunOptions ProgressDisplay::options() {
    tasks::RunOptions options;
    options.cancel = &catch_interrupts();
    if (!line_.quiet()) options.progress = [this](const tasks::Progress& progress) { show(progress); };
    return options;
}

}  // namespace cvtflow::tools
