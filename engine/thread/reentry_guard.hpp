#pragma once
/// Non-blocking try-lock that knows its owner.

#include <atomic>

namespace cvtflow::engine {

class ReentryGuard {
public:
    /// True if the lock was free; then leave() must follow. Acquires the effects of the last owner.
    [[nodiscard]] bool enter() noexcept {
        const void* nobody = nullptr;
        return owner_.compare_exchange_strong(nobody, self(), std::memory_order_acquire);
    }
    void leave() noexcept { owner_.store(nullptr, std::memory_order_release); }
    /// Whether the calling thread is the one inside: only it can have written its own name.
    [[nodiscard]] bool mine() const noexcept { return owner_.load(std::memory_order_relaxed) == self(); }

private:
    /// The address of a variable that every thread has of its own.
    [[nodiscard]] static const void* self() noexcept {
        thread_local const char mark = 0;
        return &mark;
    }

    std::atomic<const void*> owner_{nullptr};
};

}  // namespace cvtflow::engine
