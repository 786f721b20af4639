#pragma once
/// Limits of a reader's time on a false file: its processor time, so that a busy machine gives no false alarm, and a generous time on the
/// clock, which also ends a reader that sleeps for ever.

#include <sys/time.h>

#include <csignal>

namespace cvtflow::engine {

struct TimeLimits {
    long processor;  ///< [s]
    long clock;      ///< [s]
};
inline constexpr TimeLimits reader_limits{5, 60};

/// Ends this process by SIGPROF or SIGALRM once a limit has passed; counted from every call.
inline void end_after(const TimeLimits& limits) noexcept {
    const itimerval processor{{0, 0}, {limits.processor, 0}}, clock{{0, 0}, {limits.clock, 0}};
    setitimer(ITIMER_PROF, &processor, nullptr);
    setitimer(ITIMER_REAL, &clock, nullptr);
}

/// Whether a process used up its processor time, from its status (128 + signal).
[[nodiscard]] inline bool took_its_processor_time(int status) noexcept { return status == 128 + SIGPROF; }
[[nodiscard]] inline bool took_its_clock_time(int status) noexcept { return status == 128 + SIGALRM; }

}  // namespace cvtflow::engine
