#pragma once
/// Threads kept on processors, and let go again. Linux; elsewhere nothing happens.

#include <sched.h>

namespace cvtflow::engine {

/// Processors that the calling thread may use, when this was made.
class Processors {
public:
    Processors() noexcept;
    /// At least 1.
    [[nodiscard]] int count() const noexcept { return count_; }
    /// The set that holds only the (number modulo count)-th of them.
    [[nodiscard]] cpu_set_t only(int number) const noexcept;
    /// Whether the system reported it.
    [[nodiscard]] bool known() const noexcept { return known_; }

private:
    cpu_set_t set_;
    bool known_;
    int count_ = 1;
};

/// Keeps the calling thread on one processor and restores its mask when destroyed, on the same thread.
class Pin {
public:
    /// @param requested false: no effect
    Pin(bool requested, const Processors& processors, int number) noexcept;
    ~Pin();
    Pin(const Pin&) = delete;
    Pin& operator=(const Pin&) = delete;

private:
    cpu_set_t before_;
    bool pinned_;
};

}  // namespace cvtflow::engine
