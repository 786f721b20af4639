#pragma once
/// The solution inside a step, and where a function of it changes its sign.

#include <algorithm>
#include <cmath>
#include <limits>

namespace cvtflow::engine {

/// Cubic Hermite interpolant of a step from t to t + h: matches y and y' at both ends, error O(h⁴). Refers to whole state vectors, which
/// must outlive it. Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, II.6 (6.7).
struct Interpolant {
    const double* start;        ///< y(t) [unknowns]
    const double* start_slope;  ///< y'(t) [unknowns], per second
    const double* end;          ///< y(t + h) [unknowns]
    const double* end_slope;    ///< y'(t + h) [unknowns], per second
    double h;                   ///< [s]

    /// out[i - from] = y_i(t + theta h) for i in [from, to); bitwise y(t) at theta = 0, y(t + h) at 1, and independent of
    /// how a range is split.
    /// @param theta in [0, 1]; outside it extrapolates   @param out to - from numbers, no overlap with the vectors
    void evaluate(double theta, int from, int to, double* out) const noexcept;
};

struct Crossing {
    double theta;     ///< place in the step, 0 to 1, with the new sign; the old one is at most the tolerance before it
    int evaluations;  ///< evaluations of the gap function
};

/// Smallest n with 2^n ≥ x ≥ 1, without a logarithm, which near a power of two is not the same on every processor. x [1]
[[nodiscard]] inline int doublings(double x) noexcept {
    int exponent = 0;
    return std::frexp(x, &exponent) > 0.5 ? exponent : exponent - 1;
}

/// Finds a sign change of gap(theta) in [lo, hi]: the first point of the final bracket on which the NEW sign (that of gap_hi) holds, so
/// that an event is never left pending by rounding. Zero and NaN do not count as the new sign. Several crossings: one of them.
/// At most ceil(log2((hi - lo) / tolerance)) + 2 evaluations, whatever the function does; near a simple root under ten.
/// @param gap θ ↦ double, never throws
/// @param gap_lo, gap_hi values at the ends; unless gap_hi has a sign and gap_lo has the other one or is zero, the answer is hi
/// @param tolerance on theta; less than a few units in the last place counts as these
/// Source: Oliveira, Takahashi, ACM Trans. Math. Softw. 47 (2021) 5 (ITP method, κ1 = 0.2/(hi - lo), κ2 = 2, n0 = 1).
template <class Gap>
[[nodiscard]] Crossing locate(Gap&& gap, double lo, double hi, double gap_lo, double gap_hi, double tolerance) noexcept {
    const double sign = gap_hi > 0.0 ? 1.0 : -1.0;
    double old_value = sign * gap_lo;  // ≤ 0
    double new_value = sign * gap_hi;  // > 0
    if (!(old_value <= 0.0 && new_value > 0.0)) return {hi, 0};
    const double finest = 4.0 * std::numeric_limits<double>::epsilon() * std::max(std::abs(lo), std::abs(hi));
    const double width = hi - lo;
    const double target = std::max(tolerance, finest);
    // Half of the bracket that plain bisection with one spare evaluation would have; ITP never falls behind it.
    double allowed = 0.5 * target * std::ldexp(1.0, doublings(std::max(width / target, 1.0)) + 1);
    int evaluations = 0;
    while (hi - lo > target) {
        const double middle = lo + 0.5 * (hi - lo);
        const double secant = (hi * old_value - lo * new_value) / (old_value - new_value);
        const double towards_middle = secant < middle ? 1.0 : -1.0;
        const double truncation = 0.2 / width * (hi - lo) * (hi - lo);
        const double truncated = truncation <= std::abs(middle - secant) ? secant + towards_middle * truncation : middle;
        const double radius = std::max(0.0, allowed - 0.5 * (hi - lo));
        const double projected = std::abs(truncated - middle) <= radius ? truncated : middle - towards_middle * radius;
        const double theta = projected > lo && projected < hi ? projected : middle;
        if (!(theta > lo && theta < hi)) break;  // nothing lies between two neighbouring numbers
        const double value = sign * gap(theta);
        ++evaluations;
        allowed *= 0.5;
        (value > 0.0 ? hi : lo) = theta;
        (value > 0.0 ? new_value : old_value) = value;
    }
    return {hi, evaluations};
}

}  // namespace cvtflow::engine
