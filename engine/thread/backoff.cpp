#include "engine/thread/backoff.hpp"

#include <algorithm>
#include <cstdint>
#include <thread>

#include "engine/thread/pinning.hpp"

namespace cvtflow::engine {

namespace {

using std::chrono::nanoseconds;

nanoseconds pauses(const ExecutorOptions& options) {
    if (options.threads > Processors().count()) return nanoseconds(0);
    if (options.spin >= 0.0) return nanoseconds(static_cast<std::int64_t>(1e3 * options.spin));
    switch (options.wait) {
        case Wait::spin: return std::chrono::milliseconds(2);
        case Wait::balanced: return std::chrono::microseconds(20);
        case Wait::passive: return std::chrono::microseconds(5);
    }
    return nanoseconds(0);
}

}  // namespace

Backoff::Backoff(const ExecutorOptions& options)
    : max_pauses_(pauses(options)),
      yields_(options.wait == Wait::passive ? nanoseconds(std::chrono::microseconds(100)) : nanoseconds::max()) {}

void Backoff::rest(nanoseconds waited) const noexcept {
    if (waited < pauses_) {
        for (int i = 0; i < 4; ++i) pause();
    } else if (waited - pauses_ < yields_) {
        std::this_thread::yield();
    } else {
        std::this_thread::sleep_for(std::chrono::microseconds(50));
    }
}

void Backoff::learn(nanoseconds waited) noexcept {
    const nanoseconds min_growth = std::chrono::microseconds(1);
    pauses_ = waited > pauses_ ? pauses_ / 2 : std::min(max_pauses_, 2 * pauses_ + min_growth);
}

}  // namespace cvtflow::engine
