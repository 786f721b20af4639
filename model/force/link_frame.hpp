#pragma once
/// Geometry of a link: its direction and how fast it turns, and the difference between the axes of two pin halves, which is all that plates
/// and joints depend on. (model/EQUATIONS.md sections 1 and 4)

#include <cmath>

#include "model/basis/lanes.hpp"
#include "model/machine/coefficients.hpp"
#include "model/parameters/chain_layout.hpp"

namespace cvtflow::model {
namespace {

/// Offsets inside a link's coordinates for order P, as constants.
template <int P>
inline constexpr ChainLayout link_layout{P};

/// Frame of one link (Real: double) or of several side by side (Real: Lanes).
template <class Real>
struct LinkFrameOf {
    Real tx, ty;          ///< t, unit vector from the rear to the front half; n = (-ty, tx), outward o = (ty, -tx)
    Real inverse_length;  ///< 1/|d0| [1/m]
    Real turning;         ///< θ' [rad/s]
};
using LinkFrame = LinkFrameOf<double>;

/// Frame of the link with coordinates q and velocities v. The two halves must not coincide.
template <int P, class Real>
[[nodiscard]] inline LinkFrameOf<Real> link_frame(const Real* q, const Real* v) noexcept {
    using std::sqrt;
    constexpr auto a = End::rear;
    constexpr auto b = End::front;
    const Real dx = q[link_layout<P>.x(b, 0)] - q[link_layout<P>.x(a, 0)];
    const Real dy = q[link_layout<P>.y(b, 0)] - q[link_layout<P>.y(a, 0)];
    const Real inverse = 1.0 / sqrt(dx * dx + dy * dy);
    const Real tx = dx * inverse;
    const Real ty = dy * inverse;
    const Real vx = v[link_layout<P>.x(b, 0)] - v[link_layout<P>.x(a, 0)];
    const Real vy = v[link_layout<P>.y(b, 0)] - v[link_layout<P>.y(a, 0)];
    return {tx, ty, inverse, (tx * vy - ty * vx) * inverse};
}

/// Adds a moment about z on the link to the generalized forces f: a couple on the m = 0 coordinates of its halves.
template <int P, class Real>
inline void add_moment(const LinkFrameOf<Real>& frame, const Real& moment, Real* f) noexcept {
    const Real couple = moment * frame.inverse_length;
    f[link_layout<P>.x(End::front, 0)] -= couple * frame.ty;
    f[link_layout<P>.y(End::front, 0)] += couple * frame.tx;
    f[link_layout<P>.x(End::rear, 0)] += couple * frame.ty;
    f[link_layout<P>.y(End::rear, 0)] -= couple * frame.tx;
}

/// Coordinates (or velocities, or generalized forces) of one half minus those of another; of several links side by side if Real is Lanes.
template <int P, class Real = double>
struct Difference {
    Real x[P + 1], y[P + 1], z, e;

    Difference() noexcept : z(0.0), e(0.0) {
        for (int m = 0; m <= P; ++m) x[m] = y[m] = Real(0.0);
    }
    /// Half `plus_end` of the link at `plus` minus half `minus_end` of the link at `minus`.
    [[gnu::always_inline]] Difference(const Real* plus, End plus_end, const Real* minus, End minus_end) noexcept
        : z(plus[link_layout<P>.z(plus_end)] - minus[link_layout<P>.z(minus_end)]),
          e(plus[link_layout<P>.e(plus_end)] - minus[link_layout<P>.e(minus_end)]) {
        for (int m = 0; m <= P; ++m) {
            x[m] = plus[link_layout<P>.x(plus_end, m)] - minus[link_layout<P>.x(minus_end, m)];
            y[m] = plus[link_layout<P>.y(plus_end, m)] - minus[link_layout<P>.y(minus_end, m)];
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
            f[link_layout<P>.x(end, m)] += sign * x[m];
            f[link_layout<P>.y(end, m)] += sign * y[m];
        }
        f[link_layout<P>.z(end)] += sign * z;
        f[link_layout<P>.e(end)] += sign * e;
    }
};

/// A point along ξ.
template <int P, int W>
struct AxisPoint {
    double basis[P + 1];  ///< P_m(ξ), m ≥ 1
    double xi;            ///< place along the pin [1]

    template <int Most>
    AxisPoint(const PointLanes<Most>& points, int point) noexcept : xi(points.position[static_cast<std::size_t>(point)]) {
        for (int m = 1; m <= P; ++m) basis[m] = points.basis[static_cast<std::size_t>(m)][static_cast<std::size_t>(point)];
    }
    /// Σ c_m P_m(ξ). @param c [coefficients of the axis]
    [[nodiscard]] Lanes<W> along(const Lanes<W>* c) const noexcept {
        Lanes<W> value = c[0];
        for (int m = 1; m <= P; ++m) value += basis[m] * c[m];
        return value;
    }
    /// Contributions of a force at the point to each coordinate, in the order of Difference. @param terms [2P + 4]
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
