#pragma once
/// Decides when a resident worker leaves a processor that other threads need. Private to this folder.
///
/// The system takes a contended processor away for a slice of milliseconds, nearly always in the middle of a task, and everybody waits
/// for that task. A worker that notices leaves between two tasks instead: the others do all of the work meanwhile, at their own speed.
/// It comes back after a while, and stays away for longer each time that it finds the processor contended again.

#include <chrono>
#include <cstdint>

namespace cvtflow::engine {

/// What the system has given the calling thread so far.
struct ProcessorUse {
    std::chrono::nanoseconds wall{};       ///< since any fixed moment
    std::chrono::nanoseconds processor{};  ///< of this thread
    std::int64_t taken_away = 0;           ///< number of times that the thread lost the processor while runnable

    /// Zeros if the system does not report them; such a worker never retreats. Costs about 1 µs.
    [[nodiscard]] static ProcessorUse now() noexcept;
};

/// One worker's view; not shared.
class ContentionBackoff {
public:
    using Milliseconds = std::chrono::milliseconds;
    static constexpr Milliseconds window{2};     ///< shorter than a slice, so that one loss stands out
    static constexpr Milliseconds shortest{8};   ///< two slices
    static constexpr Milliseconds longest{256};  ///< a return costs up to one slice of everybody's time: below 2 %

    explicit ContentionBackoff(const ProcessorUse& begin) noexcept : begin_(begin) {}

    /// Called between tasks. Whether the worker should leave for length(): since the last window it was kept off the processor, against
    /// its will, for more than a quarter of the time. Reads the clock, and the rest only when a window is over.
    [[nodiscard]] bool due() noexcept;
    [[nodiscard]] bool due(const ProcessorUse& now) noexcept;

    /// How long to stay away.
    [[nodiscard]] Milliseconds length() const noexcept { return length_; }
    /// The worker has been away and begins a new window.
    void returned(const ProcessorUse& now) noexcept;

private:
    ProcessorUse begin_;                      ///< of the window
    std::chrono::nanoseconds undisturbed_{};  ///< since the last return
    Milliseconds length_ = shortest;
};

}  // namespace cvtflow::engine
