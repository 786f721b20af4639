#pragma once
/// Waiting for another thread, and leaving a processor that other threads need. Private to this part.

#include <atomic>
#include <chrono>
#include <cstdint>

#include "engine/thread/executor_options.hpp"

namespace cvtflow::engine {

/// Data of different writers stay this far apart: two cache lines, since processors fetch lines in pairs.
inline constexpr std::size_t apart = 128;

/// Backoff of one thread, each with a copy: pause, then yield, then sleep, bounded by the clock (a number of pauses is no measure of
/// time: one pause takes 5 ns on one processor and 50 ns on the next). It learns: a wait that outlasts the pauses halves them, a shorter
/// one doubles them up to the policy's. Two threads that the system has put on one processor would otherwise pause in each other's time
/// (measured: 46 µs per cycle, and 8 ms with OpenMP's barriers, which pause for milliseconds).
class Backoff {
public:
    /// No pauses if there are more threads than processors: the one waited for may need ours.
    explicit Backoff(const ExecutorOptions& options);

    /// Returns the word's value once it differs from `old`; acquires what was written before it was stored.
    template <class Word>
    [[nodiscard]] Word change(const std::atomic<Word>& word, Word old) noexcept {
        Word now = old;
        until([&]() noexcept { return (now = word.load(std::memory_order_acquire)) != old; });
        return now;
    }

    /// Returns once ready() is true.
    template <class Ready>
    void until(const Ready& ready) noexcept {
        for (int poll = 0; poll < first_polls; ++poll) {
            if (ready()) return;
            pause();
        }
        const auto begin = std::chrono::steady_clock::now();
        for (;;) {
            const auto waited = std::chrono::steady_clock::now() - begin;
            if (ready()) return learn(waited);
            rest(waited);
        }
    }

private:
    static constexpr int first_polls = 50;  // about 1 µs: most waits end here, without reading the clock

    static void pause() noexcept {
#if defined(__x86_64__)
        __builtin_ia32_pause();
#elif defined(__aarch64__)
        asm volatile("yield");
#endif
    }
    /// @param waited how long so far
    void rest(std::chrono::nanoseconds waited) const noexcept;
    void learn(std::chrono::nanoseconds waited) noexcept;

    std::chrono::nanoseconds max_pauses_;
    std::chrono::nanoseconds pauses_ = max_pauses_;
    std::chrono::nanoseconds yields_;  ///< time of yields, after the pauses and before the first sleep
};

/// Times of the calling thread so far, and how often it lost its processor.
struct ProcessorUse {
    std::chrono::nanoseconds wall{};       ///< time since any fixed moment
    std::chrono::nanoseconds processor{};  ///< processor time of the thread
    std::int64_t taken_away = 0;           ///< number of times that the thread lost the processor while runnable

    /// Zeros if the system does not report them; such a worker never retreats. Costs about 1 µs.
    [[nodiscard]] static ProcessorUse now() noexcept;
};

/// Decides when a resident worker leaves a contended processor; not shared. The system takes the processor away for a slice of
/// milliseconds, nearly always in the middle of a task, and every worker waits for that task. A worker that notices leaves between two
/// tasks instead: the others do all of the work meanwhile, at full speed. It comes back after a while, and stays away for longer each time
/// that it finds the processor contended again.
class ContentionBackoff {
public:
    using Milliseconds = std::chrono::milliseconds;
    static constexpr Milliseconds window{2};     ///< shorter than a slice, so that one loss stands out
    static constexpr Milliseconds shortest{8};   ///< two slices
    static constexpr Milliseconds longest{256};  ///< maximum; a return costs all workers up to one slice: below 2 %

    explicit ContentionBackoff(const ProcessorUse& begin) noexcept : begin_(begin) {}

    /// Called between tasks. Whether the worker should leave for length(): since the last window it was kept off the processor, against
    /// its will, for more than a quarter of the time. Reads the clock, and the rest only when a window is over.
    [[nodiscard]] bool due() noexcept;
    [[nodiscard]] bool due(const ProcessorUse& now) noexcept;

    /// Time to stay away.
    [[nodiscard]] Milliseconds length() const noexcept { return length_; }
    /// The worker has been away and begins a new window.
    void returned(const ProcessorUse& now) noexcept;

private:
    ProcessorUse begin_;                      ///< use at the begin of the window
    std::chrono::nanoseconds undisturbed_{};  ///< time since the last return
    Milliseconds length_ = shortest;
};

}  // namespace cvtflow::engine
