#pragma once
/// The direction of a link and how fast it turns. (model/EQUATIONS.md section 1)

#include <cmath>

#include "model/chain_layout.hpp"

namespace cvtflow::model {
namespace {

/// Offsets inside a link's coordinates for order P, as constants.
template <int P>
inline constexpr ChainLayout at{P};

struct LinkFrame {
    double tx, ty;           ///< t, unit vector from the rear to the front half; n = (-ty, tx), outward o = (ty, -tx)
    double inverse_length;   ///< 1/|d0| [1/m]
    double turning;          ///< θ' [rad/s]
};

/// Frame of the link with coordinates q and velocities v. The two halves must not coincide.
template <int P>
[[nodiscard]] inline LinkFrame link_frame(const double* q, const double* v) noexcept {
    constexpr auto a = End::rear;
    constexpr auto b = End::front;
    const double dx = q[at<P>.x(b, 0)] - q[at<P>.x(a, 0)];
    const double dy = q[at<P>.y(b, 0)] - q[at<P>.y(a, 0)];
    const double inverse = 1.0 / std::sqrt(dx * dx + dy * dy);
    const double tx = dx * inverse;
    const double ty = dy * inverse;
    const double vx = v[at<P>.x(b, 0)] - v[at<P>.x(a, 0)];
    const double vy = v[at<P>.y(b, 0)] - v[at<P>.y(a, 0)];
    return {tx, ty, inverse, (tx * vy - ty * vx) * inverse};
}

/// Adds a moment about z on the link to the generalized forces f: a couple on the m = 0 coordinates of its halves.
template <int P>
inline void add_moment(const LinkFrame& frame, double moment, double* f) noexcept {
    const double couple = moment * frame.inverse_length;
    f[at<P>.x(End::front, 0)] -= couple * frame.ty;
    f[at<P>.y(End::front, 0)] += couple * frame.tx;
    f[at<P>.x(End::rear, 0)] += couple * frame.ty;
    f[at<P>.y(End::rear, 0)] -= couple * frame.tx;
}

}  // namespace
}  // namespace cvtflow::model
