#pragma once
/// The machine of a board of resident workers: atomics, waiting, and leaving the processor. Private to this folder.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <thread>

#include "engine/executor/tbb/contention_backoff.hpp"
#include "engine/thread/backoff.hpp"

namespace cvtflow::engine {

/// This machine.
struct BoardMachine {
    template <class Value>
    using Atomic = std::atomic<Value>;
    using Waiter = Backoff;
    static constexpr std::size_t numbers_together = apart / sizeof(std::uint64_t);  // on a line of their own
    static constexpr int patience = 50;  // polls of a worker's own tasks before it checks those of others, about 1 us

    /// Whether a worker is at work, or leaves its processor to others for a while.
    class Presence {
    public:
        explicit Presence(const ExecutorOptions& options) noexcept
            : contention_(ProcessorUse::now()), retreats_(options.wait != Wait::spin) {}

        /// Called between levels. Whether the worker should leave now.
        [[nodiscard]] bool due() noexcept { return retreats_ && round_++ % rounds_per_reading == 0 && contention_.due(); }
        /// Sleeps for the given time, or until over() is true.
        template <class Over>
        void away(const Over& over) noexcept {
            const auto until = std::chrono::steady_clock::now() + contention_.length();
            while (std::chrono::steady_clock::now() < until && !over()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        /// The worker is back at work.
        void returned() noexcept { contention_.returned(ProcessorUse::now()); }

    private:
        static constexpr int rounds_per_reading = 16;  // reading the clock costs 25 ns, a level takes at least 300

        ContentionBackoff contention_;
        const bool retreats_;  // not on a machine of one's own
        unsigned round_ = 0;
    };
};

}  // namespace cvtflow::engine
