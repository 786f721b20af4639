#pragma once
/// Elasticity inside a link: extension and bending of its two halves, bending, shear and torsion of its plate pack.
/// (model/EQUATIONS.md section 3)

#include "model/account.hpp"
#include "model/basis/lanes.hpp"
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

/// The same for several elements side by side.
template <int W, bool Observe>
[[nodiscard]] inline Lanes<W> element_forces(const BendingLanes& springs, const Lanes<W>& u, const Lanes<W>& rate, Account* account) noexcept {
    const auto stiffness = load<W>(springs.stiffness.data()), damping = load<W>(springs.damping.data());
    if constexpr (Observe) {
        account->store(Energy::inner, 0.5 * sum<W>(stiffness * u * u));
        account->lose(Loss::inner, sum<W>(damping * rate * rate));
    }
    return stiffness * u + damping * rate;
}

/// Bending modes 2…P of both halves, split along travel and height; lanes: rear 2…P, front 2…P. Adds forces; returns the moment on the link.
template <int P, bool Observe>
[[nodiscard]] inline double bending(const Coefficients& c, const LinkFrame& frame, const double* q, const double* v, double* f, Account* account) noexcept {
    constexpr int modes = P - 1;
    constexpr int xa = at<P>.x(End::rear, 2), xb = at<P>.x(End::front, 2), ya = at<P>.y(End::rear, 2), yb = at<P>.y(End::front, 2);
    using V = Lanes<2 * modes>;
    const auto both = [](const double* from, int rear, int front) { return join<modes>(load<modes>(from + rear), load<modes>(from + front)); };
    const auto add = [f](int begin, const Lanes<modes>& force) { (load<modes>(f + begin) + force).copy_to(f + begin); };
    const V qx = both(q, xa, xb), qy = both(q, ya, yb), vx = both(v, xa, xb), vy = both(v, ya, yb);
    const V along = qx * frame.tx + qy * frame.ty, across = qy * frame.tx - qx * frame.ty;
    const V along_rate = vx * frame.tx + vy * frame.ty + frame.turning * across;
    const V across_rate = vy * frame.tx - vx * frame.ty - frame.turning * along;
    const V ft = element_forces<2 * modes, Observe>(c.travel, along, along_rate, account);
    const V fn = element_forces<2 * modes, Observe>(c.height, across, across_rate, account);
    const V fx = fn * frame.ty - ft * frame.tx, fy = -(ft * frame.ty + fn * frame.tx);
    add(xa, half<2 * modes>(fx, 0));
    add(xb, half<2 * modes>(fx, 1));
    add(ya, half<2 * modes>(fy, 0));
    add(yb, half<2 * modes>(fy, 1));
    return sum<2 * modes>(fn * along - ft * across);
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
    }
    if constexpr (P >= 2) moment += bending<P, Observe>(c, frame, q, v, f, account);
    return moment;
}

}  // namespace
}  // namespace cvtflow::model
