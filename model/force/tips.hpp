#pragma once
/// Forces between the tips of a link and the sheaves: Hertz contact with friction. Lanes run over the four tips.
/// (model/EQUATIONS.md section 6)

#include <cstdint>
#include <cstring>

#include "model/account.hpp"
#include "model/force/tip_geometry.hpp"
#include "model/friction/friction.hpp"

namespace cvtflow::model {
namespace {

/// Velocities at the contact of every tip.
struct TipMotion {
    TipLanes closing;        ///< δ' [m/s]
    Vector3Lanes material;   ///< v of the tip's material at P relative to the sheave's [m/s]
    TipLanes lever_x, lever_y;   ///< P - E [m]
    Vector3Lanes sheave_arm; ///< r_P = P - O [m]
};

template <int P>
[[nodiscard, gnu::always_inline]] inline TipMotion tip_motion(const Coefficients& c, const LinkFrame& frame, const double* v, const SheaveMotion* s, const TipGeometry& g) noexcept {
    TipMotion m;
    const double outward = c.tip.radius * c.tip.sine;
    const TipLanes sideways = (c.tip.radius * c.tip.cosine) * g.side;
    const double w = frame.turning;
    const TipLanes ex = end_values<P>(v), ey = end_values<P>(v + 2 * (P + 1));
    const TipLanes ez = by_end(v[at<P>.z(End::rear)], v[at<P>.z(End::front)]) + g.side * by_end(v[at<P>.e(End::rear)], v[at<P>.e(End::front)]);
    const TipLanes slope_x = c.slope_scale * end_slopes<P>(v), slope_y = c.slope_scale * end_slopes<P>(v + 2 * (P + 1));
    const TipLanes lean = slope_x * frame.ty - slope_y * frame.tx + w * (g.slope_x * frame.tx + g.slope_y * frame.ty);
    const TipLanes ux = by_side(s[0].vx, s[1].vx), uy = by_side(s[0].vy, s[1].vy), uz = by_side(s[0].vz, s[1].vz);
    const TipLanes wx = by_side(s[0].spin_x, s[1].spin_x), wy = by_side(s[0].spin_y, s[1].spin_y), wz = by_side(s[0].spin_z, s[1].spin_z);

    const Vector3Lanes sphere{ex + outward * w * frame.tx - sideways * slope_x, ey + outward * w * frame.ty - sideways * slope_y, ez - outward * lean};
    m.closing = -dot(g.normal, {sphere.x - ux, sphere.y - uy, sphere.z - uz}) + wx * (g.arm.y * g.local.z - g.arm.z * g.local.y) +
                wy * (g.arm.z * g.local.x - g.arm.x * g.local.z);

    m.lever_x = g.offset.x - c.tip.radius * g.normal.x;
    m.lever_y = g.offset.y - c.tip.radius * g.normal.y;
    m.sheave_arm = {g.arm.x - c.tip.radius * g.normal.x, g.arm.y - c.tip.radius * g.normal.y, g.arm.z - c.tip.radius * g.normal.z};
    const Vector3Lanes& p = m.sheave_arm;
    m.material = {ex - w * m.lever_y - ux - (wy * p.z - wz * p.y), ey + w * m.lever_x - uy - (wz * p.x - wx * p.z), ez - uz - (wx * p.y - wy * p.x)};
    return m;
}

/// Velocity in the tangent plane of the contact.
[[nodiscard]] inline Vector3Lanes tangential(const Vector3Lanes& v, const Vector3Lanes& normal) noexcept {
    const TipLanes along = dot(v, normal);
    return {v.x - along * normal.x, v.y - along * normal.y, v.z - along * normal.z};
}

/// The phases of a link's four tips, one byte each.
[[nodiscard]] inline std::uint32_t phase_word(const Phase* phases) noexcept {
    std::uint32_t word;
    std::memcpy(&word, phases, sizeof word);
    return word;
}

/// g(|v|) with the branch that the phase prescribes: frozen within a step for `stick` and `slip`.
[[nodiscard]] inline TipLanes phase_slip_factor(const FrictionCurve& curve, const TipLanes& speed, const Phase* phases) noexcept {
    TipLanes factor = slip_factor<tips_per_link>(curve, speed);
    constexpr std::uint32_t stick_or_slip = 0x02020202;
    if ((phase_word(phases) & stick_or_slip) == 0) return factor;
    for (std::size_t tip = 0; tip < tips_per_link; ++tip) {
        if (phases[tip] == Phase::stick) factor.set(tip, 1.0 / curve.saturation_speed);
        if (phases[tip] == Phase::slip) factor.set(tip, 1.0 / speed[tip]);
    }
    return factor;
}

/// One lane pair (side -, side +) of a half brought to its coordinates.
template <int P>
inline void spread_end(const double* total, const double* tilting, int tip, double* f) noexcept {
    const double even = total[tip] + total[tip + 1], odd = total[tip + 1] - total[tip];
    for (int m = 0; m <= P; ++m) f[m] += m % 2 == 0 ? even : odd;
    const double tilt_even = tilting[tip] + tilting[tip + 1], tilt_odd = tilting[tip + 1] - tilting[tip];
    if constexpr (P >= 1) f[1] += tilt_even;
    if constexpr (P >= 2) f[2] += 3.0 * tilt_odd;
    if constexpr (P >= 3) f[3] += 6.0 * tilt_even;
}

/// Normal force and friction of the four tips.
struct TipForces {
    TipLanes normal;        ///< N [N]
    Vector3Lanes friction;  ///< f on the tip [N]
};

template <bool Observe>
[[nodiscard, gnu::always_inline]] inline TipForces tip_forces(const TipCoefficients& tip, const TipGeometry& g, const TipMotion& motion, const Phase* phases, Account* account) noexcept {
    const auto touching_at = [&](int corner) { return phases[corner] == Phase::free ? 0.0 : 1.0; };
    const TipLanes touching = join<2>(join<1>(touching_at(0), touching_at(1)), join<1>(touching_at(2), touching_at(3)));
    const TipLanes depth = touching * positive_part<tips_per_link>(g.depth);
    const TipLanes elastic = tip.hertz * depth * sqrt(depth);
    const TipLanes normal = positive_part<tips_per_link>(elastic * (1.0 + tip.damping * motion.closing));
    const Vector3Lanes v = tangential(motion.material, g.normal);
    const TipLanes grip = -tip.friction.coefficient * normal * phase_slip_factor(tip.friction, sqrt(dot(v, v)), phases);
    const Vector3Lanes friction{grip * v.x, grip * v.y, grip * v.z};
    if constexpr (Observe) {
        account->store(Energy::tips, 0.4 * sum<tips_per_link>(elastic * depth));
        account->lose(Loss::tip_damping, sum<tips_per_link>((normal - elastic) * motion.closing));
        account->lose(Loss::tip_friction, -sum<tips_per_link>(dot(friction, motion.material)));
    }
    return {normal, friction};
}

/// Generalized forces of the tips on their link; returns the moment about z on the link.
template <int P>
[[nodiscard]] inline double load_link(const Coefficients& c, const LinkFrame& frame, const TipGeometry& g, const TipMotion& motion, const TipForces& t, double* f) noexcept {
    const double outward = c.tip.radius * c.tip.sine;
    const TipLanes sideways = (c.tip.radius * c.tip.cosine) * g.side;
    const Vector3Lanes push{t.normal * g.normal.x, t.normal * g.normal.y, t.normal * g.normal.z};
    alignas(64) double total_x[4], total_y[4], total_z[4], tilt_x[4], tilt_y[4];
    TipLanes(push.x + t.friction.x).copy_to(total_x);
    TipLanes(push.y + t.friction.y).copy_to(total_y);
    TipLanes(push.z + t.friction.z).copy_to(total_z);
    TipLanes(c.slope_scale * (-outward * frame.ty * push.z - sideways * push.x)).copy_to(tilt_x);
    TipLanes(c.slope_scale * (outward * frame.tx * push.z - sideways * push.y)).copy_to(tilt_y);
    for (const End end : {End::rear, End::front}) {
        const int tip = 2 * static_cast<int>(end);
        spread_end<P>(total_x, tilt_x, tip, f + at<P>.x(end, 0));
        spread_end<P>(total_y, tilt_y, tip, f + at<P>.y(end, 0));
        f[at<P>.z(end)] += total_z[tip] + total_z[tip + 1];
        f[at<P>.e(end)] += total_z[tip + 1] - total_z[tip];
    }
    const TipLanes turning = outward * (push.x * frame.tx + push.y * frame.ty - (g.slope_x * frame.tx + g.slope_y * frame.ty) * push.z);
    return sum<tips_per_link>(turning + motion.lever_x * t.friction.y - motion.lever_y * t.friction.x);
}

/// Reactions on the two sheaves.
[[nodiscard, gnu::always_inline]] inline SheaveLoad load_sheaves(const TipGeometry& g, const TipMotion& motion, const TipForces& t) noexcept {
    const auto pair = [](const TipLanes& lanes, double* two) { folded<tips_per_link>(lanes).copy_to(two); };   // rear + front, by side
    const Vector3Lanes& p = motion.sheave_arm;
    const Vector3Lanes& r = g.arm;
    SheaveLoad load;
    pair(-(t.normal * g.normal.x + t.friction.x), load.fx);
    pair(-(t.normal * g.normal.y + t.friction.y), load.fy);
    pair(-(t.normal * g.normal.z + t.friction.z), load.fz);
    pair(-t.normal * (r.y * g.local.z - r.z * g.local.y) - (p.y * t.friction.z - p.z * t.friction.y), load.mx);
    pair(-t.normal * (r.z * g.local.x - r.x * g.local.z) - (p.z * t.friction.x - p.x * t.friction.z), load.my);
    pair(-(p.x * t.friction.y - p.y * t.friction.x), load.mz);
    return load;
}

/// All tips of a link; `sheaves` are the two of its pulley. Adds to the link's generalized forces, returns the moment about z on it.
template <int P, bool Observe>
[[nodiscard]] inline double tips(const Coefficients& c, const LinkFrame& frame, const double* q, const double* v, const SheaveMotion* sheaves, const Phase* phases,
                                 double* f, SheaveLoad& load, Account* account) noexcept {
    const TipGeometry geometry = tip_geometry<P>(c, frame, q, sheaves);
    const TipMotion motion = tip_motion<P>(c, frame, v, sheaves, geometry);
    const TipForces forces = tip_forces<Observe>(c.tip, geometry, motion, phases, account);
    load = load_sheaves(geometry, motion, forces);
    return load_link<P>(c, frame, geometry, motion, forces, f);
}

}  // namespace
}  // namespace cvtflow::model
