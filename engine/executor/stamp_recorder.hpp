#pragma once
/// Time stamps of tasks: one ring per thread, written without locks or allocation while an executor runs. The laboratory reads them
/// afterwards (bench/executor/span_recorder.hpp).

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
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

/// Meaning of a span that is not a task; tasks are ≥ 0.
enum SpanCode : int {
    span_wait = -1,        ///< time between two other spans of the same thread and run
    span_controller = -2,  ///< Controller::next()
    span_enter = -3,       ///< time from the beginning of run() to the thread's first task
    span_exit = -4,        ///< time from the thread's last task to the end of run()
};

class StampRecorder {
public:
    /// @param capacity stamps kept per thread, the latest ones; 24 bytes each, allocated here
    /// @throws std::invalid_argument unless both are positive
    StampRecorder(int threads, int capacity) {
        if (threads < 1 || capacity < 1) throw std::invalid_argument("stamp recorder: needs a thread and a place for a stamp");
        tracks_.resize(static_cast<std::size_t>(threads));
        for (Track& track : tracks_) track.ring.resize(static_cast<std::size_t>(capacity));
    }

    [[nodiscard]] int threads() const noexcept { return static_cast<int>(tracks_.size()); }

    /// A span of this thread is over. One caller per thread number at a time.
    void add(int thread, int what, std::int64_t begin_ticks, std::int64_t end_ticks) noexcept {
        Track& track = tracks_[static_cast<std::size_t>(thread)];
        track.ring[track.count++ % track.ring.size()] = {what, begin_ticks, end_ticks};
    }
    /// A run begins (span_enter) or has ended (span_exit). No thread is adding.
    void mark_all(SpanCode code) noexcept {
        const std::int64_t now = ticks();
        for (int thread = 0; thread < threads(); ++thread) add(thread, code, now, now);
    }

protected:
    struct Stamp {
        int what;
        std::int64_t begin, end;  // [ticks]
    };
    struct alignas(128) Track {
        std::vector<Stamp> ring;
        std::size_t count = 0;  // ever written
    };
    std::vector<Track> tracks_;
};

}  // namespace cvtflow::engine
