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
template <class Springs, class Real, class Books>
[[nodiscard]] inline Real element_force(const Springs& spring, const Real& u, const Real& rate, Energy kind, Books& books) noexcept {
    books.store(kind, 0.5 * spring.stiffness * u * u);
    books.lose(Loss::inner, spring.damping * rate * rate);
    return spring.stiffness * u + spring.damping * rate;
}

/// Numbers of modes 2 and 3 of the rear half, then of the front half.
template <int W>
using ModeLanes = std::array<Lanes<W>, 4>;

/// Sum over modes of the rear half and of the front half, in the tree of sum().
template <int W>
[[nodiscard]] inline Lanes<W> over_modes(const ModeLanes<W>& terms) noexcept {
    return (terms[0] + terms[2]) + (terms[1] + terms[3]);
}

/// Forces of all modes, each k u + c u'.
template <int W, class Books>
[[nodiscard]] inline ModeLanes<W> mode_forces(const BendingLanes& springs, const ModeLanes<W>& u, const ModeLanes<W>& rate,
                                              Books& books) noexcept {
    ModeLanes<W> force, energy, power;
    for (std::size_t k = 0; k < force.size(); ++k) {
        force[k] = springs.stiffness[k] * u[k] + springs.damping[k] * rate[k];
        energy[k] = springs.stiffness[k] * u[k] * u[k], power[k] = springs.damping[k] * rate[k] * rate[k];
    }
    books.store(Energy::inner, over_modes<W>(energy), 0.5);
    books.lose(Loss::inner, over_modes<W>(power));
    return force;
}

/// Bending modes 2 and 3 of both halves, split along travel and height. Adds forces; returns the moment on the link.
template <int W, class Books>
[[nodiscard]] inline Lanes<W> bending(const Coefficients& c, const LinkFrameOf<Lanes<W>>& frame, const Lanes<W>* q, const Lanes<W>* v,
                                      Lanes<W>* f, Books& books) noexcept {
    constexpr std::size_t modes = axis_order - 1;
    ModeLanes<W> along, across, along_rate, across_rate, moment;
    const auto x_of = [](std::size_t k) { return link_layout.x(k < modes ? End::rear : End::front, 2) + static_cast<int>(k % modes); };
    const auto y_of = [](std::size_t k) { return link_layout.y(k < modes ? End::rear : End::front, 2) + static_cast<int>(k % modes); };
    for (std::size_t k = 0; k < 2 * modes; ++k) {
        const int x = x_of(k), y = y_of(k);
        along[k] = q[x] * frame.tx + q[y] * frame.ty;
        across[k] = q[y] * frame.tx - q[x] * frame.ty;
        along_rate[k] = v[x] * frame.tx + v[y] * frame.ty + frame.turning * across[k];
        across_rate[k] = v[y] * frame.tx - v[x] * frame.ty - frame.turning * along[k];
    }
    const ModeLanes<W> ft = mode_forces<W>(c.travel, along, along_rate, books);
    const ModeLanes<W> fn = mode_forces<W>(c.height, across, across_rate, books);
    for (std::size_t k = 0; k < 2 * modes; ++k) {
        f[x_of(k)] += fn[k] * frame.ty - ft[k] * frame.tx;
        f[y_of(k)] += -(ft[k] * frame.ty + fn[k] * frame.tx);
        moment[k] = fn[k] * along[k] - ft[k] * across[k];
    }
    return over_modes<W>(moment);
}

/// Plate pack as a beam between the tilts of the two pins. Adds forces; returns the moment on the link.
template <class Kind, class Real, class Books>
[[nodiscard]] inline Real plate_pack(const Coefficients& c, const Kind& kind, const LinkFrameOf<Real>& frame, const Real* q, const Real* v,
                                     Real* f, Books& books) noexcept {
    constexpr int za = link_layout.z(End::rear);
    constexpr int zb = link_layout.z(End::front);
    const auto inverse_half = 2.0 * kind.inverse_length;
    const Real rise = inverse_half * (q[zb] - q[za]);
    const Real rise_rate = inverse_half * (v[zb] - v[za]);
    constexpr int xa = link_layout.x(End::rear, 1), ya = link_layout.y(End::rear, 1), xb = link_layout.x(End::front, 1),
                  yb = link_layout.y(End::front, 1);
    const double s = c.slope_scale;
    const Real tx = s * frame.tx, ty = s * frame.ty;
    const Real ta = q[xa] * tx + q[ya] * ty, tb = q[xb] * tx + q[yb] * ty;  // slopes along t …
    const Real na = q[ya] * tx - q[xa] * ty, nb = q[yb] * tx - q[xb] * ty;  // … and along n
    const Real w = frame.turning;
    const Real ta_rate = v[xa] * tx + v[ya] * ty + w * na, tb_rate = v[xb] * tx + v[yb] * ty + w * nb;
    const Real na_rate = v[ya] * tx - v[xa] * ty - w * ta, nb_rate = v[yb] * tx - v[xb] * ty - w * tb;
    const Real bend = element_force(kind.bending, Real(ta - tb), Real(ta_rate - tb_rate), Energy::pack, books);
    const Real shear = element_force(kind.shear, Real(-ta - tb - rise), Real(-ta_rate - tb_rate - rise_rate), Energy::pack, books);
    const Real twist = element_force(kind.torsion, Real(nb - na), Real(nb_rate - na_rate), Energy::pack, books);
    f[xa] -= (bend - shear) * tx + twist * ty;
    f[ya] -= (bend - shear) * ty - twist * tx;
    f[xb] += (bend + shear) * tx + twist * ty;
    f[yb] += (bend + shear) * ty - twist * tx;
    f[zb] += inverse_half * shear;
    f[za] -= inverse_half * shear;
    return -bend * (na - nb) + shear * (na + nb) + twist * (tb - ta);
}

/// λ of the pins behind and in front of a link. @param c with lengths
[[nodiscard]] inline std::array<double, 2> lengths_at(const Coefficients& c, int link) noexcept {
    return {c.longer[static_cast<std::size_t>(link)], c.longer[static_cast<std::size_t>(c.layout.next(link))]};
}

/// The extension of pins of unequal length is e - λ: what that adds to the forces of e.
/// @param longer λ of the link's rear and of its front pin [m]
template <class Real, class Books>
inline void add_lengths(const Coefficients& c, const std::array<Real, 2>& longer, const Real* q, Real* f, Books& books) noexcept {
    for (const End end : {End::rear, End::front}) {
        const int e = link_layout.e(end);
        const Real& by = longer[static_cast<std::size_t>(end)];
        f[e] += c.extension.stiffness * by;
        books.store(Energy::inner, c.extension.stiffness * by * (0.5 * by - q[e]));
    }
}

/// All elasticity inside a link, and the forces of guides on it. Adds to the generalized forces f of the link; returns the moment about z
/// on the link [N·m].
template <class Kind, class Real, class Books>
[[nodiscard]] inline Real inner_elasticity(const Coefficients& c, const Kind& kind, const LinkFrameOf<Real>& frame, const Real* q,
                                           const Real* v, Real* f, Books& books) noexcept {
    Real moment = plate_pack(c, kind, frame, q, v, f, books);
    for (const End end : {End::rear, End::front}) {
        const int e = link_layout.e(end);
        f[e] -= element_force(c.extension, q[e], v[e], Energy::inner, books);
    }
    moment += bending(c, frame, q, v, f, books);
    FurtherElement::of_halves(frame, v, f, moment, books);
    if (c.guide.present) guide_force(c.guide, q, v, f, books);
    return moment;
}

}  // namespace
}  // namespace cvtflow::model
