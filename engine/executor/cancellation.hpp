#pragma once
/// A wish that a run end: set from any thread or from a signal handler, seen by the controller between cycles.

#include <atomic>

namespace cvtflow::engine {

class Cancellation {
public:
    void request() noexcept { requested_.store(true, std::memory_order_relaxed); }
    /// Takes the wish back. @return whether there was one
    bool withdraw() noexcept { return requested_.exchange(false, std::memory_order_relaxed); }
    [[nodiscard]] bool requested() const noexcept { return requested_.load(std::memory_order_relaxed); }

private:
    std::atomic<bool> requested_{false};
    static_assert(std::atomic<bool>::is_always_lock_free, "only lock-free atomics may be touched in a signal handler");
};

}  // namespace cvtflow::engine
