#pragma once
/// Waiting for another thread: pause, then yield, then sleep, bounded by the clock (a number of pauses is no measure of time: one pause
/// takes 5 ns on one processor and 50 ns on the next). Private to this folder.

#include <atomic>
#include <chrono>

#include "engine/thread/executor_options.hpp"

namespace cvtflow::engine {

/// Data of different writers stay this far apart: two cache lines, since processors fetch lines in pairs.
inline constexpr std::size_t apart = 128;

/// One thread's backoff; each has its own copy. It learns: a wait that outlasts the pauses halves them, a shorter one doubles them up
/// to the policy's. Two threads that the system has put on one processor would otherwise pause in each other's time (measured: 46 µs
/// per cycle, and 8 ms with OpenMP's barriers, which pause for milliseconds).
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
    std::chrono::nanoseconds yields_;  ///< after the pauses, before the first sleep
};

}  // namespace cvtflow::engine
