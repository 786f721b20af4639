#pragma once
/// Whether somebody is inside, and who: a door that lets one thread in and turns the next one away, without waiting.

#include <pthread.h>

#include <atomic>

namespace cvtflow::engine {

class ReentryGuard {
public:
    /// True if nobody was inside; then leave() must follow. What the last one did inside is seen.
    [[nodiscard]] bool enter() noexcept {
        unsigned long nobody = 0;
        return owner_.compare_exchange_strong(nobody, self(), std::memory_order_acquire);
    }
    void leave() noexcept { owner_.store(0, std::memory_order_release); }
    /// Whether the calling thread is the one inside: only it can have written its own name.
    [[nodiscard]] bool mine() const noexcept { return owner_.load(std::memory_order_relaxed) == self(); }

private:
    [[nodiscard]] static unsigned long self() noexcept { return pthread_self(); }  // the address of a control block: never 0

    std::atomic<unsigned long> owner_{0};
};

}  // namespace cvtflow::engine
