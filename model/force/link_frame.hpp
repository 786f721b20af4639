#pragma once
/// Geometry of a link: its direction and how fast it turns, and the difference between the axes of two pin halves, which is all that plates
/// and joints depend on. (model/EQUATIONS.md sections 1 and 4)

#include <cmath>

#include "model/basis/lanes.hpp"
#include "model/machine/coefficients.hpp"
#include "model/parameters/chain_layout.hpp"

namespace cvtflow::model {
namespace {

/// Offsets inside a link's coordinates, as constants.
inline constexpr ChainLayout link_layout;

/// Frame of one link (Real: double) or of several side by side (Real: Lanes).
template <class Real>
struct LinkFrameOf {
    Real tx, ty;          ///< t, unit vector from the rear to the front half; n = (-ty, tx), outward o = (ty, -tx)
    Real inverse_length;  ///< 1/|d0| [1/m]
    Real turning;         ///< θ' [rad/s]
};
using LinkFrame = LinkFrameOf<double>;

/// Frame of the link with coordinates q and velocities v. The two halves must not coincide.
template <class Real>
[[nodiscard]] inline LinkFrameOf<Real> link_frame(const Real* q, const Real* v) noexcept {
    using std::sqrt;
    constexpr auto a = End::rear;
    constexpr auto b = End::front;
    const Real dx = q[link_layout.x(b, 0)] - q[link_layout.x(a, 0)];
    const Real dy = q[link_layout.y(b, 0)] - q[link_layout.y(a, 0)];
    const Real inverse = 1.0 / sqrt(dx * dx + dy * dy);
    const Real tx = dx * inverse;
    const Real ty = dy * inverse;
    const Real vx = v[link_layout.x(b, 0)] - v[link_layout.x(a, 0)];
    const Real vy = v[link_layout.y(b, 0)] - v[link_layout.y(a, 0)];
    return {tx, ty, inverse, (tx * vy - ty * vx) * inverse};
}

/// Adds a moment about z on the link to the generalized forces f: a couple on the m = 0 coordinates of its halves.
template <class Real>
inline void add_moment(const LinkFrameOf<Real>& frame, const Real& moment, Real* f) noexcept {
    const Real couple = moment * frame.inverse_length;
    f[link_layout.x(End::front, 0)] -= couple * frame.ty;
    f[link_layout.y(End::front, 0)] += couple * frame.tx;
    f[link_layout.x(End::rear, 0)] += couple * frame.ty;
    f[link_layout.y(End::rear, 0)] -= couple * frame.tx;
}

/// Coordinates (or velocities, or generalized forces) of one half minus those of another; of several links side by side if Real is Lanes.
template <class Real = double>
struct Difference {
    Real x[axis_terms], y[axis_terms], z, e;

    Difference() noexcept : z(0.0), e(0.0) {
        for (int m = 0; m < axis_terms; ++m) x[m] = y[m] = Real(0.0);
    }
    /// Half `plus_end` of the link at `plus` minus half `minus_end` of the link at `minus`.
    [[gnu::always_inline]] Difference(const Real* plus, End plus_end, const Real* minus, End minus_end) noexcept
        : z(plus[link_layout.z(plus_end)] - minus[link_layout.z(minus_end)]),
          e(plus[link_layout.e(plus_end)] - minus[link_layout.e(minus_end)]) {
        for (int m = 0; m < axis_terms; ++m) {
            x[m] = plus[link_layout.x(plus_end, m)] - minus[link_layout.x(minus_end, m)];
            y[m] = plus[link_layout.y(plus_end, m)] - minus[link_layout.y(minus_end, m)];
        }
    }

    [[gnu::always_inline]] void add(const Real* total) noexcept {
        for (int m = 0; m < axis_terms; ++m) {
            x[m] += total[m];
            y[m] += total[axis_terms + m];
        }
        z += total[2 * axis_terms];
        e += total[2 * axis_terms + 1];
    }
    /// Adds this generalized force, times sign, to that of one half of a link. sign [1]
    [[gnu::always_inline]] void apply(double sign, Real* f, End end) const noexcept {
        for (int m = 0; m < axis_terms; ++m) {
            f[link_layout.x(end, m)] += sign * x[m];
            f[link_layout.y(end, m)] += sign * y[m];
        }
        f[link_layout.z(end)] += sign * z;
        f[link_layout.e(end)] += sign * e;
    }
};

/// A point along ξ.
template <int W>
struct AxisPoint {
    NumberOf<W> basis[axis_terms];  ///< P_m(ξ), m ≥ 1
    NumberOf<W> xi;                 ///< place along the pin [1]

    template <int Most>
    AxisPoint(const PointLanes<Most, NumberOf<W>>& points, int point) noexcept : xi(points.position[static_cast<std::size_t>(point)]) {
        for (int m = 1; m < axis_terms; ++m) basis[m] = points.basis[static_cast<std::size_t>(m)][static_cast<std::size_t>(point)];
    }
    /// Σ c_m P_m(ξ). @param c [coefficients of the axis]
    [[nodiscard]] Lanes<W> along(const Lanes<W>* c) const noexcept {
        Lanes<W> value = c[0];
        for (int m = 1; m < axis_terms; ++m) value += basis[m] * c[m];
        return value;
    }
    /// Contributions of a force at the point to each coordinate, in the order of Difference. @param terms [2 axis_terms + 2]
    void spread(const Lanes<W>& fx, const Lanes<W>& fy, const Lanes<W>& fz, Lanes<W>* terms) const noexcept {
        terms[0] = fx;
        terms[axis_terms] = fy;
        for (int m = 1; m < axis_terms; ++m) {
            terms[m] = fx * basis[m];
            terms[axis_terms + m] = fy * basis[m];
        }
        terms[2 * axis_terms] = fz;
        terms[2 * axis_terms + 1] = fz * xi;
    }
};

}  // namespace
}  // namespace cvtflow::model
