#pragma once
/// Who ran what when: one ring of time stamps per thread, written without locks or allocation while an executor runs, read afterwards.
/// Tasks and the controller are stamped; waiting, arriving and leaving are what lies between and follow from them when they are read.
///
///     run()   |enter|task 3|wait|controller|task 3|task 4|  wait  |task 3|exit|

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace cvtflow::engine {

/// A clock that costs less than what it measures: the processor's time stamp counter. Reading it takes 9 ns where steady_clock takes
/// 20 ns (EPYC, KVM). Processors since 2008 count at a constant rate, alike on all cores; elsewhere steady_clock is used.
[[nodiscard]] inline std::int64_t ticks() noexcept {
#if defined(__x86_64__)
    return static_cast<std::int64_t>(__builtin_ia32_rdtsc());
#else
    return std::chrono::steady_clock::now().time_since_epoch().count();
#endif
}

/// Turns ticks into nanoseconds: the rate is what passed on both clocks since this was made, so that nothing waits for a calibration.
class TickScale {
public:
    /// Rate up to now [ns per tick]. Good to 1e-4 once a millisecond has passed.
    [[nodiscard]] double nanoseconds_per_tick() const noexcept {
        const std::chrono::duration<double, std::nano> passed = std::chrono::steady_clock::now() - steady_;
        return passed.count() / static_cast<double>(ticks() - ticks_);
    }
    [[nodiscard]] std::int64_t begin() const noexcept { return ticks_; }

private:
    std::chrono::steady_clock::time_point steady_ = std::chrono::steady_clock::now();
    std::int64_t ticks_ = ticks();
};

/// Meaning of a span that is not a task; tasks are ≥ 0.
enum SpanCode : int {
    span_wait = -1,        ///< between two others of the same thread and run
    span_controller = -2,  ///< Controller::next()
    span_enter = -3,       ///< from the beginning of run() to the thread's first task
    span_exit = -4,        ///< from the thread's last task to the end of run()
};

struct Span {
    int what;            ///< task number or SpanCode
    std::int64_t begin;  ///< since the recorder was made [ns]
    std::int64_t end;    ///< [ns]
};

class StampRecorder {
public:
    /// @param capacity stamps kept per thread, the latest ones; 24 bytes each, allocated here
    /// @throws std::invalid_argument unless both are positive
    StampRecorder(int threads, int capacity);

    [[nodiscard]] int threads() const noexcept { return static_cast<int>(tracks_.size()); }

    /// For executors: a span of this thread is over. One caller per thread number at a time.
    void add(int thread, int what, std::int64_t begin_ticks, std::int64_t end_ticks) noexcept {
        Track& track = tracks_[static_cast<std::size_t>(thread)];
        track.ring[track.count++ % track.ring.size()] = {what, begin_ticks, end_ticks};
    }
    /// For executors: a run begins or has ended. No thread is adding.
    void begin_run() noexcept;
    void end_run() noexcept;

    /// All spans of a thread that are still kept, ascending, without gaps within a run. Not while an executor runs.
    [[nodiscard]] std::vector<Span> spans(int thread) const;
    /// Stamps of a thread that newer ones have overwritten.
    [[nodiscard]] long lost(int thread) const noexcept;
    /// Forgets everything.
    void clear() noexcept;

private:
    struct Stamp {
        int what;
        std::int64_t begin, end;  // [ticks]
    };
    struct alignas(128) Track {
        std::vector<Stamp> ring;
        std::size_t count = 0;  // ever written
    };
    void mark_all(SpanCode code) noexcept;

    TickScale scale_;
    std::vector<Track> tracks_;
};

}  // namespace cvtflow::engine
