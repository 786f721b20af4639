#pragma once
/// Count of executed instructions of a piece of code: exact, whatever else the machine is doing.

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace cvtflow::bench {

struct Counted {
    long instructions = 0;
    long flops = 0;  ///< additions, subtractions, multiplications, divisions and square roots, once per lane (padding lanes too)
};

/// Runs the body in a child process with a trap after every instruction (1 to 20 µs each), after one run at full speed.
/// Nothing where that cannot be done: not Linux on x86-64, or traps end the child.
/// @throws std::runtime_error if the body ends it by another signal
[[nodiscard]] std::optional<Counted> count(const std::function<void()>& body);
/// Each of the bodies so, one after the other in the same child process. Empty where that cannot be done.
[[nodiscard]] std::vector<Counted> count_each(std::span<const std::function<void()>> bodies);

}  // namespace cvtflow::bench
