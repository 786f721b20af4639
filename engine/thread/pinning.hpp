#pragma once
/// Pins threads to processors, and releases them. Linux only; no effect elsewhere.

#include <sched.h>

#include <algorithm>

namespace cvtflow::engine {

/// Processors that the calling thread may use, when this was made.
class Processors {
public:
    Processors() noexcept : known_(sched_getaffinity(0, sizeof set_, &set_) == 0) {
        if (known_) count_ = std::max(1, CPU_COUNT(&set_));
    }
    /// Number of these processors, at least 1.
    [[nodiscard]] int count() const noexcept { return count_; }
    /// The set that holds only the (number modulo count)-th of them.
    [[nodiscard]] cpu_set_t only(int number) const noexcept {
        cpu_set_t result;
        CPU_ZERO(&result);
        int left = number % count_;
        for (int processor = 0; processor < CPU_SETSIZE; ++processor) {
            if (!CPU_ISSET(processor, &set_) || left-- > 0) continue;
            CPU_SET(processor, &result);
            break;
        }
        return result;
    }
    /// Whether the system reported them.
    [[nodiscard]] bool known() const noexcept { return known_; }

private:
    cpu_set_t set_{};
    bool known_;
    int count_ = 1;
};

/// Keeps the calling thread on one processor and restores its mask when destroyed, on the same thread.
class Pin {
public:
    /// @param requested false: no effect
    Pin(bool requested, const Processors& processors, int number) noexcept {
        if (!requested || !processors.known() || sched_getaffinity(0, sizeof before_, &before_) != 0) return;
        const cpu_set_t only = processors.only(number);
        pinned_ = sched_setaffinity(0, sizeof only, &only) == 0;
    }
    ~Pin() {
        if (pinned_) sched_setaffinity(0, sizeof before_, &before_);
    }
    Pin(const Pin&) = delete;
    Pin& operator=(const Pin&) = delete;

private:
    cpu_set_t before_{};
    bool pinned_ = false;
};

}  // namespace cvtflow::engine
