#pragma once
/// Elasticity inside a link: extension and bending of its two halves, bending, shear and torsion of its plate pack.
/// Parts of both chains, sections of model/EQUATIONS.md; rigid pins are in model/rigid/:
///
///                pin halves (section 3)  rigid pins (section 11)          energy         loss
///     pack       plate_pack()            rigid_links.hpp: link_force()    Energy::pack   Loss::inner
///     bow        none: single plates     link_force(), between bent pins  Energy::pack   Loss::inner
///     bending    bending()               bend_pin(), one shape            Energy::inner  Loss::inner
///     extension  element_force() of e    none: in series with the tips    Energy::inner  Loss::inner
///     length     add_lengths()           tip_motion.hpp: read_half()       Energy::inner
///
/// Each is a spring k with damper c of a deflection u: E = k u²/2 [J], F = k u + c u' [N, N·m], loss c u'² [W].

#include <array>

#include "model/basis/lanes.hpp"
#include "model/force/account.hpp"
#include "model/force/further_element.hpp"
#include "model/force/guide.hpp"
#include "model/force/link_frame.hpp"
#include "model/machine/coefficients.hpp"

namespace cvtflow::model {
namespace {

/// Force k u + c u' of an element with deflection u and rate u'.
/// @param account where observed
template <bool Observe, class Springs, class Real>
[[nodiscard]] inline Real element_force(const Springs& spring, const Real& u, const Real& rate, Energy kind,
                                        [[maybe_unused]] Account* account) noexcept {
    if constexpr (Observe) {
        account->store(kind, 0.5 * spring.stiffness * u * u);
        account->lose(Loss::inner, spring.damping * rate * rate);
    }
    return spring.stiffness * u + spring.damping * rate;
}

/// The elastic force for several elements side by side.
template <int W, bool Observe>
[[nodiscard]] inline Lanes<W> element_forces(const BendingLanes& springs, const Lanes<W>& u, const Lanes<W>& rate,
                                             Account* account) noexcept {
    const auto stiffness = load<W>(springs.stiffness.data()), damping = load<W>(springs.damping.data());
    if constexpr (Observe) {
        account->store(Energy::inner, 0.5 * sum<W>(stiffness * u * u));
        account->lose(Loss::inner, sum<W>(damping * rate * rate));
    }
    return stiffness * u + damping * rate;
}

/// Bending modes 2…P of both halves, split along travel and height; lanes: rear 2…P, front 2…P. Adds forces; returns the moment on the
/// link. q [coordinates of the link], v [m/s, rad/s], f [N, N·m]
template <int P, bool Observe>
[[nodiscard]] inline double bending(const Coefficients& c, const LinkFrame& frame, const double* q, const double* v, double* f,
                                    Account* account) noexcept {
    constexpr int modes = P - 1;
    constexpr int xa = link_layout<P>.x(End::rear, 2), xb = link_layout<P>.x(End::front, 2), ya = link_layout<P>.y(End::rear, 2),
                  yb = link_layout<P>.y(End::front, 2);
    using V = Lanes<2 * modes>;
    const auto both = [](const double* from, int rear, int front) {
        return join<modes>(load<modes>(from + rear), load<modes>(from + front));
    };
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

/// Sum over modes of the rear half, then of the front half, as sum() adds them up.
template <int W, std::size_t count>
[[nodiscard]] inline Lanes<W> over_modes(const std::array<Lanes<W>, count>& terms) noexcept {
    if constexpr (count == 2)
        return terms[0] + terms[1];
    else
        return (terms[0] + terms[2]) + (terms[1] + terms[3]);
}

/// element_forces() of links side by side, mode by mode.
template <int W, std::size_t count>
[[nodiscard]] inline std::array<Lanes<W>, count> mode_forces(const BendingLanes& springs, const std::array<Lanes<W>, count>& u,
                                                             const std::array<Lanes<W>, count>& rate) noexcept {
    std::array<Lanes<W>, count> force;
    for (std::size_t k = 0; k < count; ++k) force[k] = springs.stiffness[k] * u[k] + springs.damping[k] * rate[k];
    return force;
}

/// Bending of links side by side, mode by mode: equal sums in the same order.
template <int P, bool Observe, int W>
[[nodiscard]] inline Lanes<W> bending(const Coefficients& c, const LinkFrameOf<Lanes<W>>& frame, const Lanes<W>* q, const Lanes<W>* v,
                                      Lanes<W>* f, Account*) noexcept {
    static_assert(!Observe, "links side by side are not observed");
    using V = Lanes<W>;
    constexpr std::size_t modes = P - 1;
    using Modes = std::array<V, 2 * modes>;
    Modes along, across, along_rate, across_rate, moment;
    const auto x_of = [](std::size_t k) { return link_layout<P>.x(k < modes ? End::rear : End::front, 2) + static_cast<int>(k % modes); };
    const auto y_of = [](std::size_t k) { return link_layout<P>.y(k < modes ? End::rear : End::front, 2) + static_cast<int>(k % modes); };
    for (std::size_t k = 0; k < 2 * modes; ++k) {
        const int x = x_of(k), y = y_of(k);
        along[k] = q[x] * frame.tx + q[y] * frame.ty;
        across[k] = q[y] * frame.tx - q[x] * frame.ty;
        along_rate[k] = v[x] * frame.tx + v[y] * frame.ty + frame.turning * across[k];
        across_rate[k] = v[y] * frame.tx - v[x] * frame.ty - frame.turning * along[k];
    }
    const Modes ft = mode_forces<W>(c.travel, along, along_rate);
    const Modes fn = mode_forces<W>(c.height, across, across_rate);
    for (std::size_t k = 0; k < 2 * modes; ++k) {
        f[x_of(k)] += fn[k] * frame.ty - ft[k] * frame.tx;
        f[y_of(k)] += -(ft[k] * frame.ty + fn[k] * frame.tx);
        moment[k] = fn[k] * along[k] - ft[k] * across[k];
    }
    return over_modes<W>(moment);
}

/// Plate pack as a beam between the tilts of the two pins. Adds forces; returns the moment on the link.
template <int P, bool Observe, class Kind, class Real>
[[nodiscard]] inline Real plate_pack(const Coefficients& c, const Kind& kind, const LinkFrameOf<Real>& frame, const Real* q, const Real* v,
                                     Real* f, Account* account) noexcept {
    constexpr int za = link_layout<P>.z(End::rear);
    constexpr int zb = link_layout<P>.z(End::front);
    const auto inverse_half = 2.0 * kind.inverse_length;
    const Real rise = inverse_half * (q[zb] - q[za]);
    const Real rise_rate = inverse_half * (v[zb] - v[za]);
    if constexpr (P == 0) {
        const Real shear = element_force<Observe>(kind.shear, Real(-rise), Real(-rise_rate), Energy::pack, account);
        f[zb] += inverse_half * shear;
        f[za] -= inverse_half * shear;
        return Real(0.0);
    } else {
        constexpr int xa = link_layout<P>.x(End::rear, 1), ya = link_layout<P>.y(End::rear, 1), xb = link_layout<P>.x(End::front, 1),
                      yb = link_layout<P>.y(End::front, 1);
        const double s = c.slope_scale;
        const Real tx = s * frame.tx, ty = s * frame.ty;
        const Real ta = q[xa] * tx + q[ya] * ty, tb = q[xb] * tx + q[yb] * ty;  // slopes along t …
        const Real na = q[ya] * tx - q[xa] * ty, nb = q[yb] * tx - q[xb] * ty;  // … and along n
        const Real w = frame.turning;
        const Real ta_rate = v[xa] * tx + v[ya] * ty + w * na, tb_rate = v[xb] * tx + v[yb] * ty + w * nb;
        const Real na_rate = v[ya] * tx - v[xa] * ty - w * ta, nb_rate = v[yb] * tx - v[xb] * ty - w * tb;
        const Real bend = element_force<Observe>(kind.bending, Real(ta - tb), Real(ta_rate - tb_rate), Energy::pack, account);
        const Real shear =
            element_force<Observe>(kind.shear, Real(-ta - tb - rise), Real(-ta_rate - tb_rate - rise_rate), Energy::pack, account);
        const Real twist = element_force<Observe>(kind.torsion, Real(nb - na), Real(nb_rate - na_rate), Energy::pack, account);
        f[xa] -= (bend - shear) * tx + twist * ty;
        f[ya] -= (bend - shear) * ty - twist * tx;
        f[xb] += (bend + shear) * tx + twist * ty;
        f[yb] += (bend + shear) * ty - twist * tx;
        f[zb] += inverse_half * shear;
        f[za] -= inverse_half * shear;
        return -bend * (na - nb) + shear * (na + nb) + twist * (tb - ta);
    }
}

/// λ of the pins behind and in front of a link. @param c with lengths
[[nodiscard]] inline std::array<double, 2> lengths_at(const Coefficients& c, int link) noexcept {
    return {c.longer[static_cast<std::size_t>(link)], c.longer[static_cast<std::size_t>(c.layout.next(link))]};
}

/// The extension of pins of unequal length is e - λ: what that adds to the forces of e.
/// @param longer λ of the link's rear and of its front pin [m]
template <int P, bool Observe, class Real>
inline void add_lengths(const Coefficients& c, const std::array<Real, 2>& longer, const Real* q, Real* f,
                        [[maybe_unused]] Account* account) noexcept {
    for (const End end : {End::rear, End::front}) {
        const int e = link_layout<P>.e(end);
        const Real& by = longer[static_cast<std::size_t>(end)];
        f[e] += c.extension.stiffness * by;
        if constexpr (Observe) account->store(Energy::inner, c.extension.stiffness * by * (0.5 * by - q[e]));
    }
}

/// All elasticity inside a link, and the forces of guides on it. Adds to the generalized forces f of the link; returns the moment about z
/// on the link [N·m].
template <int P, bool Observe, class Kind, class Real>
[[nodiscard]] inline Real inner_elasticity(const Coefficients& c, const Kind& kind, const LinkFrameOf<Real>& frame, const Real* q,
                                           const Real* v, Real* f, Account* account) noexcept {
    Real moment = plate_pack<P, Observe>(c, kind, frame, q, v, f, account);
    for (const End end : {End::rear, End::front}) {
        const int e = link_layout<P>.e(end);
        f[e] -= element_force<Observe>(c.extension, q[e], v[e], Energy::inner, account);
    }
    if constexpr (P >= 2) moment += bending<P, Observe>(c, frame, q, v, f, account);
    FurtherElement::of_halves<P, Observe>(frame, v, f, moment, account);
    if (c.guide.present) guide_force<P, Observe>(c.guide, q, v, f, account);
    return moment;
}

}  // namespace
}  // namespace cvtflow::model
