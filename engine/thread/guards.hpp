#pragma once
/// Guards of objects that several threads reach: a lock, a try-lock that knows its owner, a count of the calls under way.

#include <atomic>
#include <mutex>

namespace cvtflow::engine {

/// Mutual exclusion.
class Mutex {
public:
    template <class Body>
    decltype(auto) guard(Body&& body) {
        const std::lock_guard hold(mutex_);
        return body();
    }

private:
    std::mutex mutex_;
};

/// Non-blocking try-lock that knows its owner.
class ReentryGuard {
public:
    /// True if the lock was free; then leave() must follow. Acquires the effects of the last owner.
    [[nodiscard]] bool enter() noexcept {
        const void* free = nullptr;
        return owner_.compare_exchange_strong(free, self(), std::memory_order_acquire);
    }
    void leave() noexcept { owner_.store(nullptr, std::memory_order_release); }
    /// Whether the calling thread is inside. No other thread can have written its address.
    [[nodiscard]] bool mine() const noexcept { return owner_.load(std::memory_order_relaxed) == self(); }

private:
    /// Address of a thread-local variable, which identifies the thread.
    [[nodiscard]] static const void* self() noexcept {
        thread_local const char mark = 0;
        return &mark;
    }

    std::atomic<const void*> owner_{nullptr};
};

/// Counts the owner of an object and the calls under way. The last one to leave frees the object, which its owner may have given up during
/// a call.
class LifeCount {
public:
    void enter() noexcept { ++users_; }
    /// @return whether that was the last one
    [[nodiscard]] bool leave() noexcept { return --users_ == 0; }
    /// Called by the owner, before leave(). @return false if it was given up before
    [[nodiscard]] bool give_up() noexcept { return !given_up_.exchange(true); }
    [[nodiscard]] bool given_up() const noexcept { return given_up_; }

private:
    std::atomic<int> users_{1};
    std::atomic<bool> given_up_{false};
};

}  // namespace cvtflow::engine
