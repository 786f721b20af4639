#pragma once
/// Difference between the axes of two pin halves: all that plates and joints depend on.

#include "model/basis/lanes.hpp"
#include "model/force/link_frame.hpp"
#include "model/machine/coefficients.hpp"

namespace cvtflow::model {
namespace {

/// Coordinates (or velocities, or generalized forces) of one half minus those of another; of several links side by side if Real is Lanes.
template <int P, class Real = double>
struct Difference {
    Real x[P + 1], y[P + 1], z, e;

    Difference() noexcept : z(0.0), e(0.0) {
        for (int m = 0; m <= P; ++m) x[m] = y[m] = Real(0.0);
    }
    /// Half `plus_end` of the link at `plus` minus half `minus_end` of the link at `minus`.
    [[gnu::always_inline]] Difference(const Real* plus, End plus_end, const Real* minus, End minus_end) noexcept
        : z(plus[at<P>.z(plus_end)] - minus[at<P>.z(minus_end)]), e(plus[at<P>.e(plus_end)] - minus[at<P>.e(minus_end)]) {
        for (int m = 0; m <= P; ++m) {
            x[m] = plus[at<P>.x(plus_end, m)] - minus[at<P>.x(minus_end, m)];
            y[m] = plus[at<P>.y(plus_end, m)] - minus[at<P>.y(minus_end, m)];
        }
    }

    [[gnu::always_inline]] void add(const Real* total) noexcept {
        for (int m = 0; m <= P; ++m) {
            x[m] += total[m];
            y[m] += total[P + 1 + m];
        }
        z += total[2 * P + 2];
        e += total[2 * P + 3];
    }
    /// Adds this generalized force, times sign, to that of one half of a link. sign [1]
    [[gnu::always_inline]] void apply(double sign, Real* f, End end) const noexcept {
        for (int m = 0; m <= P; ++m) {
            f[at<P>.x(end, m)] += sign * x[m];
            f[at<P>.y(end, m)] += sign * y[m];
        }
        f[at<P>.z(end)] += sign * z;
        f[at<P>.e(end)] += sign * e;
    }
};

/// Points along ξ, loaded for one chunk of lanes.
template <int P, int W>
struct AxisPoints {
    Lanes<W> basis[P + 1];  ///< P_m(ξ), m ≥ 1
    Lanes<W> xi;

    template <int Most>
    AxisPoints(const PointLanes<Most>& points, int first) noexcept : xi(load<W>(&points.position[static_cast<std::size_t>(first)])) {
        for (int m = 1; m <= P; ++m) basis[m] = load<W>(&points.basis[static_cast<std::size_t>(m)][static_cast<std::size_t>(first)]);
    }
    /// Σ c_m P_m(ξ); c [coefficients of the axis]
    [[nodiscard]] Lanes<W> along(const double* c) const noexcept {
        Lanes<W> value(c[0]);
        for (int m = 1; m <= P; ++m) value += c[m] * basis[m];
        return value;
    }
    /// What point forces give on each coordinate, before they are summed over the points: in the order of Difference.
    /// @param terms [2P + 4]
    void spread(const Lanes<W>& fx, const Lanes<W>& fy, const Lanes<W>& fz, Lanes<W>* terms) const noexcept {
        terms[0] = fx;
        terms[P + 1] = fy;
        for (int m = 1; m <= P; ++m) {
            terms[m] = fx * basis[m];
            terms[P + 1 + m] = fy * basis[m];
        }
        terms[2 * P + 2] = fz;
        terms[2 * P + 3] = fz * xi;
    }
};

/// One of these points, for links side by side.
template <int P, int W>
struct AxisPoint {
    double basis[P + 1];  ///< P_m(ξ), m ≥ 1
    double xi;            ///< place along the pin [1]

    template <int Most>
    AxisPoint(const PointLanes<Most>& points, int point) noexcept : xi(points.position[static_cast<std::size_t>(point)]) {
        for (int m = 1; m <= P; ++m) basis[m] = points.basis[static_cast<std::size_t>(m)][static_cast<std::size_t>(point)];
    }
    [[nodiscard]] Lanes<W> along(const Lanes<W>* c) const noexcept {
        Lanes<W> value = c[0];
        for (int m = 1; m <= P; ++m) value += basis[m] * c[m];
        return value;
    }
    /// @param terms [2P + 4]
    void spread(const Lanes<W>& fx, const Lanes<W>& fy, const Lanes<W>& fz, Lanes<W>* terms) const noexcept {
        terms[0] = fx;
        terms[P + 1] = fy;
        for (int m = 1; m <= P; ++m) {
            terms[m] = fx * basis[m];
            terms[P + 1 + m] = fy * basis[m];
        }
        terms[2 * P + 2] = fz;
        terms[2 * P + 3] = fz * xi;
    }
};

}  // namespace
}  // namespace cvtflow::model
