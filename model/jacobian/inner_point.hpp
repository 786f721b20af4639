#pragma once
/// Elasticity inside a link in any number type, for its derivatives: the formulas of model/force/inner.hpp.

#include "model/force/link_frame.hpp"
#include "model/jacobian/contact_points.hpp"

namespace cvtflow::model {
namespace {

template <class T>
struct FrameOf {
    T tx, ty, inverse_length, turning;
};

/// Frame of a link from the difference of its halves' m = 0 coordinates and its rate.
template <class T>
[[nodiscard]] inline FrameOf<T> frame_of_difference(const T& dx, const T& dy, const T& vx, const T& vy) noexcept {
    const T reciprocal = inverse(sqrt(dx * dx + dy * dy));
    const T tx = dx * reciprocal, ty = dy * reciprocal;
    return {tx, ty, reciprocal, (tx * vy - ty * vx) * reciprocal};
}

template <class T>
[[nodiscard]] inline T spring_force(const Spring& spring, const T& u, const T& rate) noexcept {
    return spring.stiffness * u + spring.damping * rate;
}

/// Bending mode m of one half. Adds forces; returns the moment on the link.
template <int P, int M, class T>
[[nodiscard]] inline T bending_force(const Coefficients& c, End end, const FrameOf<T>& frame, const T* q, const T* v, T* f) noexcept {
    constexpr std::size_t modes = P - 1;
    const std::size_t lane = static_cast<std::size_t>(end) * modes + M - 2;
    const Spring travel{c.travel.stiffness[lane], c.travel.damping[lane]}, height{c.height.stiffness[lane], c.height.damping[lane]};
    const int ix = at<P>.x(end, M), iy = at<P>.y(end, M);
    const T along = q[ix] * frame.tx + q[iy] * frame.ty, across = q[iy] * frame.tx - q[ix] * frame.ty;
    const T ft = spring_force(travel, along, v[ix] * frame.tx + v[iy] * frame.ty + frame.turning * across);
    const T fn = spring_force(height, across, v[iy] * frame.tx - v[ix] * frame.ty - frame.turning * along);
    f[ix] -= ft * frame.tx - fn * frame.ty;
    f[iy] -= ft * frame.ty + fn * frame.tx;
    return fn * along - ft * across;
}

/// Plate pack as a beam between the tilts of the two pins. Adds forces; returns the moment on the link.
template <int P, class T>
[[nodiscard]] inline T pack_force(const Coefficients& c, const LinkKind& kind, const FrameOf<T>& frame, const T* q, const T* v,
                                  T* f) noexcept {
    constexpr int za = at<P>.z(End::rear), zb = at<P>.z(End::front);
    const double lean = 2.0 * kind.inverse_length;
    const T rise = lean * (q[zb] - q[za]), rise_rate = lean * (v[zb] - v[za]);
    if constexpr (P == 0) {
        const T shear = spring_force(kind.shear, -rise, -rise_rate);
        f[zb] += lean * shear;
        f[za] -= lean * shear;
        return T(0.0);
    } else {
        constexpr int xa = at<P>.x(End::rear, 1), ya = at<P>.y(End::rear, 1), xb = at<P>.x(End::front, 1), yb = at<P>.y(End::front, 1);
        const T tx = c.slope_scale * frame.tx, ty = c.slope_scale * frame.ty;
        const T ta = q[xa] * tx + q[ya] * ty, tb = q[xb] * tx + q[yb] * ty, na = q[ya] * tx - q[xa] * ty, nb = q[yb] * tx - q[xb] * ty;
        const T& w = frame.turning;
        const T ta_rate = v[xa] * tx + v[ya] * ty + w * na, tb_rate = v[xb] * tx + v[yb] * ty + w * nb;
        const T na_rate = v[ya] * tx - v[xa] * ty - w * ta, nb_rate = v[yb] * tx - v[xb] * ty - w * tb;
        const T bend = spring_force(kind.bending, ta - tb, ta_rate - tb_rate);
        const T shear = spring_force(kind.shear, -ta - tb - rise, -ta_rate - tb_rate - rise_rate);
        const T twist = spring_force(kind.torsion, nb - na, nb_rate - na_rate);
        f[xa] -= (bend - shear) * tx + twist * ty;
        f[ya] -= (bend - shear) * ty - twist * tx;
        f[xb] += (bend + shear) * tx + twist * ty;
        f[yb] += (bend + shear) * ty - twist * tx;
        f[zb] += lean * shear;
        f[za] -= lean * shear;
        return shear * (na + nb) - bend * (na - nb) + twist * (tb - ta);
    }
}

/// All elasticity inside a link. Adds to its generalized forces f; returns the moment about z on the link.
template <int P, class T>
[[nodiscard]] inline T inner_force(const Coefficients& c, const LinkKind& kind, const T* q, const T* v, T* f) noexcept {
    constexpr int xa = at<P>.x(End::rear, 0), ya = at<P>.y(End::rear, 0), xb = at<P>.x(End::front, 0), yb = at<P>.y(End::front, 0);
    const FrameOf<T> frame = frame_of_difference<T>(q[xb] - q[xa], q[yb] - q[ya], v[xb] - v[xa], v[yb] - v[ya]);
    T moment = pack_force<P>(c, kind, frame, q, v, f);
    for (const End end : {End::rear, End::front}) {
        const int e = at<P>.e(end);
        f[e] -= spring_force(c.extension, q[e], v[e]);
        if constexpr (P >= 2) moment += bending_force<P, 2>(c, end, frame, q, v, f);
        if constexpr (P >= 3) moment += bending_force<P, 3>(c, end, frame, q, v, f);
    }
    return moment;
}

}  // namespace
}  // namespace cvtflow::model
