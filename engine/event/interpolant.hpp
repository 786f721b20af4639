#pragma once
/// The solution inside a step.

namespace cvtflow::engine {

/// Cubic Hermite interpolant of a step from t to t + h: matches y and y' at both ends, error O(h⁴).
/// Refers to whole state vectors, which must outlive it.
/// Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, II.6 (6.7).
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

}  // namespace cvtflow::engine
