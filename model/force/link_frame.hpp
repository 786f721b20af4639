#pragma once
/// The direction of a link and how fast it turns. (model/EQUATIONS.md section 1)

#include <cmath>

#include "model/parameters/chain_layout.hpp"

namespace cvtflow::model {
namespace {

/// Offsets inside a link's coordinates for order P, as constants.
template <int P>
inline constexpr ChainLayout at{P};

/// Of one link (Real: double) or of several side by side (Real: Lanes).
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
    const Real dx = q[at<P>.x(b, 0)] - q[at<P>.x(a, 0)];
    const Real dy = q[at<P>.y(b, 0)] - q[at<P>.y(a, 0)];
    const Real inverse = 1.0 / sqrt(dx * dx + dy * dy);
    const Real tx = dx * inverse;
    const Real ty = dy * inverse;
    const Real vx = v[at<P>.x(b, 0)] - v[at<P>.x(a, 0)];
    const Real vy = v[at<P>.y(b, 0)] - v[at<P>.y(a, 0)];
    return {tx, ty, inverse, (tx * vy - ty * vx) * inverse};
}

/// Adds a moment about z on the link to the generalized forces f: a couple on the m = 0 coordinates of its halves.
template <int P, class Real>
inline void add_moment(const LinkFrameOf<Real>& frame, const Real& moment, Real* f) noexcept {
    const Real couple = moment * frame.inverse_length;
    f[at<P>.x(End::front, 0)] -= couple * frame.ty;
    f[at<P>.y(End::front, 0)] += couple * frame.tx;
    f[at<P>.x(End::rear, 0)] += couple * frame.ty;
    f[at<P>.y(End::rear, 0)] -= couple * frame.tx;
}

}  // namespace
}  // namespace cvtflow::model
