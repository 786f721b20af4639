#pragma once
/// Sphere against torus: tips of links and the flanks of their two sheaves. The formulas are written once, for two ways to see tips:
///
///     FourTips    the tips of one link in four lanes: rear-, rear+, front-, front+ (side -z, +z)
///     OneTip<W>   the tip at the same corner of W links
///
/// (model/EQUATIONS.md section 6)

#include <type_traits>

#include "model/basis/lanes.hpp"
#include "model/basis/zero.hpp"
#include "model/force/link_frame.hpp"
#include "model/force/sheave_motion.hpp"
#include "model/machine/coefficients.hpp"

namespace cvtflow::model {
namespace {

using TipLanes = Lanes<tips_per_link>;

/// The four tips of one link. Reals of the link are numbers, those of tips have four lanes.
struct FourTips {
    using Real = double;
    using Tips = TipLanes;
    static constexpr int width = tips_per_link;

    /// (-, +, -, +): what differs between the two sides [any unit].
    [[nodiscard]] static Tips by_side(double minus, double plus) noexcept {
        const Lanes<2> sides = join<1>(minus, plus);
        return join<2>(sides, sides);
    }
    /// (rear, rear, front, front): what differs between the two ends of the link [any unit].
    [[nodiscard]] static Tips by_end(double rear, double front) noexcept { return join<2>(Lanes<2>(rear), Lanes<2>(front)); }
};

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
template <int P, class Corner>
[[nodiscard]] inline typename Corner::Tips coefficient(const Corner& at_tips, const typename Corner::Real* c, int m) noexcept {
    return at_tips.by_end(c[m], c[P + 1 + m]);
}

/// Σ c_m P_m(±1) of both halves: P_m(±1) = (±1)^m.
template <int P, class Corner>
[[nodiscard]] inline typename Corner::Tips end_values(const Corner& at_tips, const typename Corner::Real* c) noexcept {
    using Tips = typename Corner::Tips;
    Tips even = coefficient<P>(at_tips, c, 0);
    if constexpr (P == 0) {
        return even;
    } else {
        Tips odd = coefficient<P>(at_tips, c, 1);
        if constexpr (P >= 2) even += coefficient<P>(at_tips, c, 2);
        if constexpr (P >= 3) odd += coefficient<P>(at_tips, c, 3);
        return even + at_tips.by_side(-1.0, 1.0) * odd;
    }
}

/// Σ c_m P_m'(±1) of both halves: P_m'(±1) = (±1)^(m+1) m (m+1)/2.
template <int P, class Corner>
[[nodiscard]] inline auto end_slopes(const Corner& at_tips, const typename Corner::Real* c) noexcept {
    if constexpr (P == 0) {
        return Zero{};
    } else {
        typename Corner::Tips slope = coefficient<P>(at_tips, c, 1);
        if constexpr (P >= 3) slope += 6.0 * coefficient<P>(at_tips, c, 3);
        if constexpr (P >= 2) slope += at_tips.by_side(-3.0, 3.0) * coefficient<P>(at_tips, c, 2);
        return slope;
    }
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

/// Positions of contact: everything that depends on the coordinates alone. At order 0 pins do not tilt.
template <int P, class Tips>
struct TipGeometry {
    using Slope = std::conditional_t<P == 0, Zero, Tips>;
    Tips side;               ///< s = ±1
    Vector3<Tips> end;       ///< E
    Vector3<Tips> offset;    ///< S - E
    Slope slope_x, slope_y;  ///< σ_s
    Slope tilt;              ///< σ_s·o
    Vector3<Tips> arm;       ///< r = S - O
    Vector3<Tips> local;     ///< ν, in the sheave's frame
    Vector3<Tips> normal;    ///< G, in space
    Tips depth;              ///< δ [m], negative: gap
};

/// Sphere centre of every tip, without the sheave.
template <int P, class Corner>
[[gnu::always_inline]] inline void place_spheres(const Coefficients& c, const Corner& at_tips,
                                                 const LinkFrameOf<typename Corner::Real>& frame, const typename Corner::Real* q,
                                                 TipGeometry<P, typename Corner::Tips>& g) noexcept {
    using Tips = typename Corner::Tips;
    using Real = typename Corner::Real;
    const auto& tip = c.tip;
    const Real ox = frame.ty, oy = -frame.tx;
    g.side = at_tips.by_side(-1.0, 1.0);
    g.end.x = end_values<P>(at_tips, q);
    g.end.y = end_values<P>(at_tips, q + 2 * (P + 1));
    g.end.z = at_tips.by_end(q[at<P>.z(End::rear)], q[at<P>.z(End::front)]) +
              g.side * (c.half_length + at_tips.by_end(q[at<P>.e(End::rear)], q[at<P>.e(End::front)]));
    g.slope_x = c.slope_scale * end_slopes<P>(at_tips, q);
    g.slope_y = c.slope_scale * end_slopes<P>(at_tips, q + 2 * (P + 1));
    g.tilt = g.slope_x * ox + g.slope_y * oy;
    const Tips sideways = (tip.radius * tip.cosine) * g.side;
    const double outward = tip.radius * tip.sine;
    g.offset = {outward * ox - sideways * g.slope_x, outward * oy - sideways * g.slope_y, -outward * g.tilt - sideways};
}

/// Geometry of tips against the sheaves of their pulley.
template <int P, class Corner, class Sheaves>
[[nodiscard, gnu::always_inline]] inline TipGeometry<P, typename Corner::Tips> tip_geometry(const Coefficients& c, const Corner& at_tips,
                                                                                            const LinkFrameOf<typename Corner::Real>& frame,
                                                                                            const typename Corner::Real* q,
                                                                                            const Sheaves& o) noexcept {
    using Tips = typename Corner::Tips;
    TipGeometry<P, Tips> g;
    place_spheres<P>(c, at_tips, frame, q, g);
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

}  // namespace
}  // namespace cvtflow::model
