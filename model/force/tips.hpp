#pragma once
/// Forces between the tips of a link and the sheaves, sphere against torus: Hertz contact with friction.
/// Parts of both chains, sections of model/EQUATIONS.md; rigid pins are in model/rigid/:
///
///               pin halves (section 6)  rigid pins (section 11)               energy        loss
///     depth     tip_geometry()          rigid_tip.hpp: place_tip()
///     normal    tip_pressing()          rigid_tip.hpp: rigid_normal_force()   Energy::tips  Loss::tip_damping
///     friction  tip_forces()            rigid_tips.hpp: TipGroup::friction()                Loss::tip_friction
///
/// The formulas of halves are written once, for any way to arrange tips: OneTip<W>, the tip at the same corner of W links, and
/// bench/staged/one_link.hpp: FourTips, those of one link.

#include <cstdint>
#include <type_traits>

#include "model/basis/lanes.hpp"
#include "model/basis/zero.hpp"
#include "model/force/account.hpp"
#include "model/force/link_frame.hpp"
#include "model/force/sheave_motion.hpp"
#include "model/law/friction_laws.hpp"
#include "model/machine/coefficients.hpp"

namespace cvtflow::model {
namespace {

/// One corner of W links, numbers of any unit [any]. @param side 0 is -z
template <int W, End end, int side>
struct OneTip {
    using Real = Lanes<W>;
    using Tips = Lanes<W>;
    static constexpr int width = W;

    [[nodiscard]] static constexpr double by_side(double minus, double plus) noexcept { return side == 0 ? minus : plus; }
    [[nodiscard]] static const Tips& by_side(const Tips& minus, const Tips& plus) noexcept { return side == 0 ? minus : plus; }
    [[nodiscard]] static const Tips& by_end(const Tips& rear, const Tips& front) noexcept { return end == End::rear ? rear : front; }
};

/// Coefficient m of both halves; c points at the rear half's m = 0, the front half's follow.
template <class Corner>
[[nodiscard]] inline typename Corner::Tips coefficient(const Corner& at_tips, const typename Corner::Real* c, int m) noexcept {
    return at_tips.by_end(c[m], c[axis_terms + m]);
}

/// Σ c_m P_m(±1) of both halves: P_m(±1) = (±1)^m.
template <class Corner>
[[nodiscard]] inline typename Corner::Tips end_values(const Corner& at_tips, const typename Corner::Real* c) noexcept {
    using Tips = typename Corner::Tips;
    const Tips even = coefficient(at_tips, c, 0) + coefficient(at_tips, c, 2),
               odd = coefficient(at_tips, c, 1) + coefficient(at_tips, c, 3);
    return even + at_tips.by_side(-1.0, 1.0) * odd;
}

/// Σ c_m P_m'(±1) of both halves: P_m'(±1) = (±1)^(m+1) m (m+1)/2.
template <class Corner>
[[nodiscard]] inline typename Corner::Tips end_slopes(const Corner& at_tips, const typename Corner::Real* c) noexcept {
    return coefficient(at_tips, c, 1) + 6.0 * coefficient(at_tips, c, 3) + at_tips.by_side(-3.0, 3.0) * coefficient(at_tips, c, 2);
}

template <class Tips>
struct Vector3 {
    Tips x, y, z;
};
template <class Tips>
[[nodiscard]] inline Tips dot(const Vector3<Tips>& a, const Vector3<Tips>& b) noexcept {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Both sheaves of a pulley as the tips see them. @tparam Displaced Zero where pulleys are rigid: sheaves that turn and move along z alone
template <class Tips, class Displaced = Tips>
struct SheaveLanes {
    struct Position {
        Tips x;
        Displaced y;
        Tips z;
    } position;  ///< O [m]
    Displaced tilt_x, tilt_y;
    struct Velocity {
        Displaced x, y;
        Tips z;
    } velocity, spin;  ///< [m/s], [rad/s]
};

/// @param s the two sheaves; their numbers, or Lanes where links side by side have different pulleys
template <class Corner, class Sheave>
[[nodiscard, gnu::always_inline]] inline SheaveLanes<typename Corner::Tips> sheaves_at(const Corner& at_tips, const Sheave* s) noexcept {
    const auto of = [&](auto number) -> typename Corner::Tips { return at_tips.by_side(s[0].*number, s[1].*number); };
    return {{of(&Sheave::x), of(&Sheave::y), of(&Sheave::z)},
            of(&Sheave::tilt_x),
            of(&Sheave::tilt_y),
            {of(&Sheave::vx), of(&Sheave::vy), of(&Sheave::vz)},
            {of(&Sheave::spin_x), of(&Sheave::spin_y), of(&Sheave::spin_z)}};
}
/// A sheave's motion at the tips for rigid pulleys.
template <class Corner, class Sheave>
[[nodiscard, gnu::always_inline]] inline SheaveLanes<typename Corner::Tips, Zero> rigid_sheaves_at(const Corner& at_tips,
                                                                                                   const Sheave* s) noexcept {
    const auto of = [&](auto number) -> typename Corner::Tips { return at_tips.by_side(s[0].*number, s[1].*number); };
    return {{of(&Sheave::x), {}, of(&Sheave::z)}, {}, {}, {{}, {}, of(&Sheave::vz)}, {{}, {}, of(&Sheave::spin_z)}};
}

/// Positions of contact: everything that depends on the coordinates alone.
template <class Tips>
struct TipGeometry {
    Tips side;              ///< s = ±1
    Vector3<Tips> end;      ///< E
    Vector3<Tips> offset;   ///< S - E
    Tips slope_x, slope_y;  ///< σ_s
    Tips tilt;              ///< σ_s·o
    Vector3<Tips> arm;      ///< r = S - O
    Vector3<Tips> local;    ///< ν, in the sheave's frame
    Vector3<Tips> normal;   ///< G, in space
    Tips depth;             ///< δ [m], negative: gap
};

/// Sphere centre of every tip, without the sheave.
template <class Corner>
[[gnu::always_inline]] inline void place_spheres(const Coefficients& c, const Corner& at_tips,
                                                 const LinkFrameOf<typename Corner::Real>& frame, const typename Corner::Real* q,
                                                 TipGeometry<typename Corner::Tips>& g) noexcept {
    using Tips = typename Corner::Tips;
    using Real = typename Corner::Real;
    const auto& tip = c.tip;
    const Real ox = frame.ty, oy = -frame.tx;
    g.side = at_tips.by_side(-1.0, 1.0);
    g.end.x = end_values(at_tips, q);
    g.end.y = end_values(at_tips, q + 2 * axis_terms);
    g.end.z = at_tips.by_end(q[link_layout.z(End::rear)], q[link_layout.z(End::front)]) +
              g.side * (c.half_length + at_tips.by_end(q[link_layout.e(End::rear)], q[link_layout.e(End::front)]));
    g.slope_x = c.slope_scale * end_slopes(at_tips, q);
    g.slope_y = c.slope_scale * end_slopes(at_tips, q + 2 * axis_terms);
    g.tilt = g.slope_x * ox + g.slope_y * oy;
    const Tips sideways = (tip.radius * tip.cosine) * g.side;
    const double outward = tip.radius * tip.sine;
    g.offset = {outward * ox - sideways * g.slope_x, outward * oy - sideways * g.slope_y, -outward * g.tilt - sideways};
}

/// Geometry of tips against the sheaves of their pulley.
template <class Corner, class Sheaves>
[[nodiscard, gnu::always_inline]] inline TipGeometry<typename Corner::Tips> tip_geometry(const Coefficients& c, const Corner& at_tips,
                                                                                         const LinkFrameOf<typename Corner::Real>& frame,
                                                                                         const typename Corner::Real* q,
                                                                                         const Sheaves& o) noexcept {
    using Tips = typename Corner::Tips;
    TipGeometry<Tips> g;
    place_spheres(c, at_tips, frame, q, g);
    g.arm = {g.end.x + g.offset.x - o.position.x, g.end.y + g.offset.y - o.position.y, g.end.z + g.offset.z - o.position.z};
    const Vector3<Tips>& r = g.arm;
    const Tips lx = r.x - o.tilt_y * r.z;
    const Tips ly = r.y + o.tilt_x * r.z;
    const Tips lz = r.z - (o.tilt_x * r.y - o.tilt_y * r.x);
    const Tips radius = sqrt(lx * lx + ly * ly);
    // Sphere centre from where it sits when a pin just touches at r_m: small numbers, so that the depth (µm) does not drown in the
    // rounding of the arc's radius (m):  depth = reach - |reach u + e| = -(2 reach u·e + e·e)/(reach + |reach u + e|).
    const Tips e1 = radius - c.tip.touching_radius;
    const Tips e2 = lz + (c.tip.radius * c.tip.cosine) * g.side;
    const Tips h1 = e1 + c.tip.reach * c.tip.sine;
    const Tips h2 = e2 - (c.tip.reach * c.tip.cosine) * g.side;
    const Tips distance = sqrt(h1 * h1 + h2 * h2);
    const Tips overall = c.tip.reach + distance, plane = radius * distance, share = 1.0 / (plane * overall);  // one division for three
    g.depth = -(2.0 * c.tip.reach * (c.tip.sine * e1 - c.tip.cosine * g.side * e2) + e1 * e1 + e2 * e2) * (share * plane);
    const Tips radial = h1 * (share * overall);
    g.local = {radial * lx, radial * ly, h2 * (share * overall * radius)};
    g.normal = {g.local.x + o.tilt_y * g.local.z, g.local.y - o.tilt_x * g.local.z,
                g.local.z + o.tilt_x * g.local.y - o.tilt_y * g.local.x};
    return g;
}

/// Velocities at the contact of every tip.
template <class Tips>
struct TipMotion {
    Tips closing;              ///< δ' [m/s]
    Vector3<Tips> material;    ///< v of the tip's material at P relative to the sheave's [m/s]
    Tips lever_x, lever_y;     ///< P - E [m]
    Vector3<Tips> sheave_arm;  ///< r_P = P - O [m]
};

template <class Corner, class Sheaves>
[[nodiscard, gnu::always_inline]] inline TipMotion<typename Corner::Tips> tip_motion(const Coefficients& c, const Corner& at_tips,
                                                                                     const LinkFrameOf<typename Corner::Real>& frame,
                                                                                     const typename Corner::Real* v, const Sheaves& o,
                                                                                     const TipGeometry<typename Corner::Tips>& g) noexcept {
    using Tips = typename Corner::Tips;
    TipMotion<Tips> m;
    const double outward = c.tip.radius * c.tip.sine;
    const Tips sideways = (c.tip.radius * c.tip.cosine) * g.side;
    const auto& w = frame.turning;
    const Tips ex = end_values(at_tips, v), ey = end_values(at_tips, v + 2 * axis_terms);
    const Tips ez = at_tips.by_end(v[link_layout.z(End::rear)], v[link_layout.z(End::front)]) +
                    g.side * at_tips.by_end(v[link_layout.e(End::rear)], v[link_layout.e(End::front)]);
    const auto slope_x = c.slope_scale * end_slopes(at_tips, v), slope_y = c.slope_scale * end_slopes(at_tips, v + 2 * axis_terms);
    const auto tilting = slope_x * frame.ty - slope_y * frame.tx + w * (g.slope_x * frame.tx + g.slope_y * frame.ty);
    const auto& [ux, uy, uz] = o.velocity;
    const auto& [wx, wy, wz] = o.spin;

    const Vector3<Tips> sphere{ex + outward * w * frame.tx - sideways * slope_x, ey + outward * w * frame.ty - sideways * slope_y,
                               ez - outward * tilting};
    m.closing = -dot(g.normal, Vector3<Tips>{sphere.x - ux, sphere.y - uy, sphere.z - uz}) +
                wx * (g.arm.y * g.local.z - g.arm.z * g.local.y) + wy * (g.arm.z * g.local.x - g.arm.x * g.local.z);

    m.lever_x = g.offset.x - c.tip.radius * g.normal.x;
    m.lever_y = g.offset.y - c.tip.radius * g.normal.y;
    m.sheave_arm = {g.arm.x - c.tip.radius * g.normal.x, g.arm.y - c.tip.radius * g.normal.y, g.arm.z - c.tip.radius * g.normal.z};
    const Vector3<Tips>& p = m.sheave_arm;
    m.material = {ex - w * m.lever_y - ux - (wy * p.z - wz * p.y), ey + w * m.lever_x - uy - (wz * p.x - wx * p.z),
                  ez - uz - (wx * p.y - wy * p.x)};
    return m;
}

/// Velocity in the tangent plane of the contact.
template <class Tips>
[[nodiscard]] inline Vector3<Tips> tangential(const Vector3<Tips>& v, const Vector3<Tips>& normal) noexcept {
    const Tips along = dot(v, normal);
    return {v.x - along * normal.x, v.y - along * normal.y, v.z - along * normal.z};
}

/// Phases of the tips in the lanes.
struct PhaseLanes {
    const Phase* first;  ///< phase of lane 0
    int stride;          ///< step from lane to lane
    bool by_phase;       ///< whether any of them is `stick` or `slip`
    std::size_t count;   ///< lanes that represent tips
    [[nodiscard]] Phase operator[](std::size_t lane) const noexcept { return first[static_cast<std::size_t>(stride) * lane]; }
};

/// g(|v|) from v², with the branch that the phase prescribes: frozen within a step for `stick` and `slip`.
template <int W>
[[nodiscard]] inline Lanes<W> phase_slip_factor(const FrictionCurve& curve, const Lanes<W>& square, const PhaseLanes& phases) noexcept {
    Lanes<W> factor = slip_factor_of_square<W>(curve, square);
    if (!phases.by_phase) return factor;
    const Lanes<W> inverse = 1.0 / sqrt(square);
    for (std::size_t tip = 0; tip < phases.count; ++tip) {
        if (phases[tip] == Phase::stick) take<W>(Lanes<W>(curve.inverse_saturation_speed), tip, factor);
        if (phases[tip] == Phase::slip) take<W>(inverse, tip, factor);
    }
    return factor;
}

/// Friction of a tip per sliding speed [N·s/m].
/// @param root √δ   @param square of the sliding speed
template <int W>
[[nodiscard]] inline Lanes<W> grip(const TipCoefficients& tip, const Lanes<W>& normal, const Lanes<W>& root, const Lanes<W>& square,
                                   const PhaseLanes& phases) noexcept {
    const Lanes<W> plain = tip.friction.coefficient * normal * phase_slip_factor<W>(tip.friction, square, phases);
    if (tip.law == nullptr) return plain;
    return plain * (pressure_factor<W>(*tip.law, root) * speed_factor_of_square<W>(*tip.law, square));
}

/// Normal force and friction of tips. @tparam Friction Zero: none
template <class Tips, class Friction = Tips>
struct TipForces {
    Tips normal;                 ///< N [N]
    Vector3<Friction> friction;  ///< f on the tip [N]
};

template <int W>
struct TipPressing {
    Lanes<W> depth;    ///< δ of a tip that touches, else 0 [m]
    Lanes<W> root;     ///< √δ
    Lanes<W> elastic;  ///< [N]
    Lanes<W> normal;   ///< N [N]
};

/// @param touching 1 or 0
template <int W>
[[nodiscard, gnu::always_inline]] inline TipPressing<W> tip_pressing(const TipCoefficients& tip, const TipGeometry<Lanes<W>>& g,
                                                                     const TipMotion<Lanes<W>>& motion, const Lanes<W>& touching) noexcept {
    TipPressing<W> p;
    p.depth = touching * positive_part<W>(g.depth);
    p.root = sqrt(p.depth), p.elastic = tip.hertz * p.depth * p.root;
    p.normal = positive_part<W>(p.elastic * (1.0 + tip.damping * motion.closing));
    return p;
}

/// @param touching 1 or 0
template <int W, class Books>
[[nodiscard, gnu::always_inline]] inline TipForces<Lanes<W>> tip_forces(const TipCoefficients& tip, const TipGeometry<Lanes<W>>& g,
                                                                        const TipMotion<Lanes<W>>& motion, const Lanes<W>& touching,
                                                                        const PhaseLanes& phases, Books& books) noexcept {
    using Tips = Lanes<W>;
    const auto [depth, root, elastic, normal] = tip_pressing<W>(tip, g, motion, touching);
    const Vector3<Tips> v = tangential(motion.material, g.normal);
    const Tips friction_per_speed = -grip<W>(tip, normal, root, dot(v, v), phases);
    const Vector3<Tips> friction{friction_per_speed * v.x, friction_per_speed * v.y, friction_per_speed * v.z};
    books.store(Energy::tips, elastic * depth, 0.4);
    books.lose(Loss::tip_damping, (normal - elastic) * motion.closing);
    books.lose(Loss::tip_friction, -dot(friction, motion.material));
    return {normal, friction};
}

/// Action of tips on their links: force, tilting of the pins' ends, moment about z.
template <class Tips>
struct TipAction {
    Vector3<Tips> total;
    Tips tilt_x, tilt_y;
    Tips moment;
};

template <class Real, class Tips, class Friction>
[[nodiscard, gnu::always_inline]] inline TipAction<Tips> tip_action(const Coefficients& c, const LinkFrameOf<Real>& frame,
                                                                    const TipGeometry<Tips>& g, const TipMotion<Tips>& motion,
                                                                    const TipForces<Tips, Friction>& t) noexcept {
    const double outward = c.tip.radius * c.tip.sine;
    const Tips sideways = (c.tip.radius * c.tip.cosine) * g.side;
    const Vector3<Tips> pressing{t.normal * g.normal.x, t.normal * g.normal.y, t.normal * g.normal.z};
    const Tips turning =
        outward * (pressing.x * frame.tx + pressing.y * frame.ty - (g.slope_x * frame.tx + g.slope_y * frame.ty) * pressing.z);
    return {{pressing.x + t.friction.x, pressing.y + t.friction.y, pressing.z + t.friction.z},
            c.slope_scale * (-outward * frame.ty * pressing.z - sideways * pressing.x),
            c.slope_scale * (outward * frame.tx * pressing.z - sideways * pressing.y),
            turning + motion.lever_x * t.friction.y - motion.lever_y * t.friction.x};
}

/// Forces and tilting of the two tips of a half (side -, side +) brought to its lateral coordinates.
template <class Real>
inline void spread_end(const Real& minus, const Real& plus, const Real& tilt_minus, const Real& tilt_plus, Real* f) noexcept {
    const Real even = minus + plus, odd = plus - minus;
    for (int m = 0; m < axis_terms; ++m) f[m] += m % 2 == 0 ? even : odd;
    const Real tilt_even = tilt_minus + tilt_plus, tilt_odd = tilt_plus - tilt_minus;
    f[1] += tilt_even;
    f[2] += 3.0 * tilt_odd;
    f[3] += 6.0 * tilt_even;
}

/// The tips' moments on all coordinates of a half.
template <class Real>
inline void load_end(End end, const TipAction<Real>& minus, const TipAction<Real>& plus, Real* f) noexcept {
    spread_end(minus.total.x, plus.total.x, minus.tilt_x, plus.tilt_x, f + link_layout.x(end, 0));
    spread_end(minus.total.y, plus.total.y, minus.tilt_y, plus.tilt_y, f + link_layout.y(end, 0));
    f[link_layout.z(end)] += minus.total.z + plus.total.z;
    f[link_layout.e(end)] += plus.total.z - minus.total.z;
}

/// Reaction of each tip on its sheave: force and generalized moments.
template <class Tips>
struct TipReaction {
    Vector3<Tips> force, moment;
};

template <class Tips, class Friction>
[[nodiscard, gnu::always_inline]] inline TipReaction<Tips> tip_reaction(const TipGeometry<Tips>& g, const TipMotion<Tips>& motion,
                                                                        const TipForces<Tips, Friction>& t) noexcept {
    const Vector3<Tips>& p = motion.sheave_arm;
    const Vector3<Tips>& r = g.arm;
    return {{-(t.normal * g.normal.x + t.friction.x), -(t.normal * g.normal.y + t.friction.y), -(t.normal * g.normal.z + t.friction.z)},
            {-t.normal * (r.y * g.local.z - r.z * g.local.y) - (p.y * t.friction.z - p.z * t.friction.y),
             -t.normal * (r.z * g.local.x - r.x * g.local.z) - (p.z * t.friction.x - p.x * t.friction.z),
             number<Tips>(-(p.x * t.friction.y - p.y * t.friction.x))}};
}

}  // namespace
}  // namespace cvtflow::model
