#pragma once
/// Elasticity inside a link: extension and bending of its two halves, bending, shear and torsion of its plate pack.
/// (model/EQUATIONS.md section 3)

#include "model/account.hpp"
#include "model/coefficients.hpp"
#include "model/force/link_frame.hpp"

namespace cvtflow::model {
namespace {

/// Force k u + c u' of an element with deflection u and rate u'.
template <bool Observe>
[[nodiscard]] inline double element_force(const Spring& spring, double u, double rate, Energy kind, Account* account) noexcept {
    if constexpr (Observe) {
        account->store(kind, 0.5 * spring.stiffness * u * u);
        account->lose(Loss::inner, spring.damping * rate * rate);
    }
    return spring.stiffness * u + spring.damping * rate;
}

/// Bending mode m of one half, split along travel and height. Adds forces; returns the moment on the link.
template <int P, int M, bool Observe>
[[nodiscard]] inline double bending(End end, const Spring& travel, const Spring& height, const LinkFrame& frame, const double* q, const double* v,
                                    double* f, Account* account) noexcept {
    const int ix = at<P>.x(end, M);
    const int iy = at<P>.y(end, M);
    const double along = q[ix] * frame.tx + q[iy] * frame.ty;
    const double across = q[iy] * frame.tx - q[ix] * frame.ty;
    const double along_rate = v[ix] * frame.tx + v[iy] * frame.ty + frame.turning * across;
    const double across_rate = v[iy] * frame.tx - v[ix] * frame.ty - frame.turning * along;
    const double ft = element_force<Observe>(travel, along, along_rate, Energy::inner, account);
    const double fn = element_force<Observe>(height, across, across_rate, Energy::inner, account);
    f[ix] -= ft * frame.tx - fn * frame.ty;
    f[iy] -= ft * frame.ty + fn * frame.tx;
    return fn * along - ft * across;
}

/// Plate pack as a beam between the tilts of the two pins. Adds forces; returns the moment on the link.
template <int P, bool Observe>
[[nodiscard]] inline double plate_pack(const Coefficients& c, const LinkKind& kind, const LinkFrame& frame, const double* q, const double* v, double* f,
                                       Account* account) noexcept {
    constexpr int za = at<P>.z(End::rear);
    constexpr int zb = at<P>.z(End::front);
    const double lean = 2.0 * kind.inverse_length;
    const double rise = lean * (q[zb] - q[za]);
    const double rise_rate = lean * (v[zb] - v[za]);
    if constexpr (P == 0) {
        const double shear = element_force<Observe>(kind.shear, -rise, -rise_rate, Energy::pack, account);
        f[zb] += lean * shear;
        f[za] -= lean * shear;
        return 0.0;
    } else {
        constexpr int xa = at<P>.x(End::rear, 1), ya = at<P>.y(End::rear, 1), xb = at<P>.x(End::front, 1), yb = at<P>.y(End::front, 1);
        const double s = c.slope_scale;
        const double tx = s * frame.tx, ty = s * frame.ty;
        const double ta = q[xa] * tx + q[ya] * ty, tb = q[xb] * tx + q[yb] * ty;   // slopes along t …
        const double na = q[ya] * tx - q[xa] * ty, nb = q[yb] * tx - q[xb] * ty;   // … and along n
        const double w = frame.turning;
        const double ta_rate = v[xa] * tx + v[ya] * ty + w * na, tb_rate = v[xb] * tx + v[yb] * ty + w * nb;
        const double na_rate = v[ya] * tx - v[xa] * ty - w * ta, nb_rate = v[yb] * tx - v[xb] * ty - w * tb;
        const double bend = element_force<Observe>(kind.bending, ta - tb, ta_rate - tb_rate, Energy::pack, account);
        const double shear = element_force<Observe>(kind.shear, -ta - tb - rise, -ta_rate - tb_rate - rise_rate, Energy::pack, account);
        const double twist = element_force<Observe>(kind.torsion, nb - na, nb_rate - na_rate, Energy::pack, account);
        f[xa] -= (bend - shear) * tx + twist * ty;
        f[ya] -= (bend - shear) * ty - twist * tx;
        f[xb] += (bend + shear) * tx + twist * ty;
        f[yb] += (bend + shear) * ty - twist * tx;
        f[zb] += lean * shear;
        f[za] -= lean * shear;
        return -bend * (na - nb) + shear * (na + nb) + twist * (tb - ta);
    }
}

/// All elasticity inside a link. Adds to the generalized forces f of the link; returns the moment about z on the link [N·m].
template <int P, bool Observe>
[[nodiscard]] inline double inner_elasticity(const Coefficients& c, const LinkKind& kind, const LinkFrame& frame, const double* q, const double* v, double* f,
                                             Account* account) noexcept {
    double moment = plate_pack<P, Observe>(c, kind, frame, q, v, f, account);
    for (const End end : {End::rear, End::front}) {
        const int e = at<P>.e(end);
        f[e] -= element_force<Observe>(c.extension, q[e], v[e], Energy::inner, account);
        if constexpr (P >= 2) moment += bending<P, 2, Observe>(end, c.bending2_travel, c.bending2_height, frame, q, v, f, account);
        if constexpr (P >= 3) moment += bending<P, 3, Observe>(end, c.bending3_travel, c.bending3_height, frame, q, v, f, account);
    }
    return moment;
}

}  // namespace
}  // namespace cvtflow::model
