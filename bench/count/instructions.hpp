#pragma once
/// Exact count of executed instructions of a piece of code, independent of other load on the machine.

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
/// Empty where this is impossible: not Linux on x86-64, or traps end the child.
/// @throws std::runtime_error if the body ends it by another signal
[[nodiscard]] std::optional<Counted> count(const std::function<void()>& body);
/// Counts the bodies one after the other in the same child process. Empty where this is impossible.
[[nodiscard]] std::vector<Counted> count_each(std::span<const std::function<void()>> bodies);

}  // namespace cvtflow::bench
