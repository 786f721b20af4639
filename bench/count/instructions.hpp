#pragma once
/// What a piece of code executes, counted instruction by instruction: exact, whatever else the machine is doing.

#include <functional>
#include <optional>

namespace cvtflow::bench {

struct Counted {
    long instructions = 0;
    long flops = 0;  ///< additions, subtractions, multiplications, divisions and square roots, once per lane (padding lanes too)
};

/// Runs the body in a child process one instruction at a time (about 3 µs each), after one run at full speed.
/// Nothing where that cannot be done: not Linux on x86-64, or tracing forbidden.
[[nodiscard]] std::optional<Counted> count(const std::function<void()>& body);

}  // namespace cvtflow::bench
