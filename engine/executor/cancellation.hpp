#pragma once
/// A request to end a run: set from any thread or from a signal handler, read by the controller between cycles.

#include <atomic>
#include <functional>

namespace cvtflow::engine {

class Cancellation {
public:
    Cancellation() = default;
    /// A request that calls `asked` on every check until it returns true. `asked` outlives it, throws nothing and takes next to no
    /// time: it is called between steps, by the checking thread.
    explicit Cancellation(const std::function<bool()>& asked) : asked_(asked ? &asked : nullptr) {}

    void request() noexcept { requested_.store(true, std::memory_order_relaxed); }
    /// Withdraws the request. @return whether there was one
    bool withdraw() noexcept { return requested_.exchange(false, std::memory_order_relaxed); }
    [[nodiscard]] bool requested() const noexcept {
        if (requested_.load(std::memory_order_relaxed)) return true;
        if (asked_ == nullptr || !(*asked_)()) return false;
        requested_.store(true, std::memory_order_relaxed);
        return true;
    }

private:
    mutable std::atomic<bool> requested_{false};
    const std::function<bool()>* asked_ = nullptr;
    static_assert(std::atomic<bool>::is_always_lock_free, "only lock-free atomics may be touched in a signal handler");
};

}  // namespace cvtflow::engine
