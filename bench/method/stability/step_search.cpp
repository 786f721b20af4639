#include "bench/method/stability/step_search.hpp"

#include <cmath>

namespace cvtflow::bench {

namespace {

constexpr double longer = 1.12, precision = 1.003;  ///< of steps tried next; between the longest stable one and the shortest that is not
constexpr double first_try = 0.85;                  ///< of what is expected
constexpr double shortest_tried = 1e-9, longest_of_all = 1e-2;  ///< of methods with a limit [s]

}  // namespace

Bracket bracketed(double expected, const std::function<bool(double)>& stable) {
    const bool limited = std::isfinite(expected) && expected > 0.0;
    const double factor = limited ? longer : 2.0, longest = limited ? longest_of_all : longest_tried;
    Bracket bracket;
    double h = limited ? first_try * expected : without_expectation;
    while (!stable(h)) {
        bracket.unstable = h;
        h /= longer * longer;
        if (h < shortest_tried) return bracket;
    }
    bracket.stable = h;
    while (std::isinf(bracket.unstable) && bracket.stable < longest) {
        h = factor * bracket.stable;
        (stable(h) ? bracket.stable : bracket.unstable) = h;
    }
    if (std::isinf(bracket.unstable)) return bracket;
    while (bracket.unstable > precision * bracket.stable) {
        const double middle = std::sqrt(bracket.stable * bracket.unstable);
        (stable(middle) ? bracket.stable : bracket.unstable) = middle;
    }
    return bracket;
}

}  // namespace cvtflow::bench
