#pragma once
/// A clock that costs less than what it measures: the processor's time stamp counter. Reading it takes 9 ns where steady_clock takes
/// 20 ns (EPYC, KVM). Processors since 2008 count at a constant rate, alike on all cores; elsewhere steady_clock is used.

#include <chrono>
#include <cstdint>

namespace cvtflow::engine {

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

}  // namespace cvtflow::engine
