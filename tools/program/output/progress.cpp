#include "tools/program/output/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "tools/program/guard.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

constexpr int widest_bar = 32;
constexpr int narrowest_bar = 8;

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

}  // namespace

ProgressStyle progress_style(bool quiet) {
    if (quiet) return ProgressStyle::silent;
    const char* terminal = std::getenv("TERM");
    const bool redraws = isatty(STDERR_FILENO) == 1 && terminal != nullptr && std::string_view(terminal) != "dumb";
    return redraws ? ProgressStyle::bar : ProgressStyle::lines;
}

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

std::string line_text(const ProgressNumbers& now) {
    std::string line = fmt::format("{}: {:.0f} %, {}", now.phase, 100.0 * now.share, when_text(now));
    append(line, ", ", rate_text(now.slowness, "s per simulated second"));
    append(line, ", ", left_text(now));
    return line;
}

ProgressNumbers ProgressDisplay::numbers(const tasks::Progress& progress) {
    const std::string phase = progress.settling() ? "settling" : "running";
    if (phase != phase_) {
        phase_ = phase;
        phase_wall_ = progress.wall;
        tenths_ = 0;
    }
    const double span = progress.until - progress.begin;
    const double done = progress.time - progress.begin;
    const double slowness = done > 0.0 ? (progress.wall - phase_wall_) / done : 0.0;
    const double to_come = progress.until - progress.time + (progress.settling() ? until_ : 0.0);
    return {phase, progress.time, progress.until, span > 0.0 ? std::clamp(done / span, 0.0, 1.0) : 1.0, slowness, slowness * to_come};
}

void ProgressDisplay::show(const tasks::Progress& progress) {
    if (style_ == ProgressStyle::silent) return;
    const ProgressNumbers now = numbers(progress);
    if (style_ == ProgressStyle::bar)
        draw(now);
    else
        print(now);
}

void ProgressDisplay::draw(const ProgressNumbers& now) {
    using namespace std::chrono_literals;
    const auto here = Clock::now();
    if (drawn_ && here - shown_ < 100ms) return;
    to_stderr(fmt::format("\r{}\x1b[K", bar_text(now, terminal_columns())));
    std::fflush(stderr);
    shown_ = here;
    drawn_ = true;
}

void ProgressDisplay::print(const ProgressNumbers& now) {
    using namespace std::chrono_literals;
    const auto here = Clock::now();
    const int tenths = static_cast<int>(10.0 * now.share + 1e-6);
    if (shown_ == Clock::time_point{}) shown_ = here;
    if (tenths <= tenths_ && here - shown_ < 10s) return;
    to_stderr(fmt::format("{}\n", line_text(now)));
    tenths_ = tenths;
    shown_ = here;
}

void ProgressDisplay::clear() {
    if (!drawn_) return;
    to_stderr("\r\x1b[K");
    std::fflush(stderr);
    drawn_ = false;
}

}  // namespace cvtflow::tools
