#pragma once
/// Ends an object that its owner gave up during a call with the last call.

#include <atomic>

namespace cvtflow::engine {

/// Counts the owner of an object and the calls under way. Who leaves last frees the object.
class LifeCount {
public:
    void enter() noexcept { ++users_; }
    /// @return whether that was the last one
    [[nodiscard]] bool leave() noexcept { return --users_ == 0; }
    /// By the owner, who leaves then. @return false if it was given up before
    [[nodiscard]] bool give_up() noexcept { return !given_up_.exchange(true); }
    [[nodiscard]] bool given_up() const noexcept { return given_up_; }

private:
    std::atomic<int> users_{1};
    std::atomic<bool> given_up_{false};
};

}  // namespace cvtflow::engine
