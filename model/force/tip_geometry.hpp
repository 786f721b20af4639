#pragma once
/// Sphere against torus: the four tips of a link and the flanks of its two sheaves. Lanes: rear-, rear+, front-, front+ (side -z, +z).
/// (model/EQUATIONS.md section 6)

#include "model/basis/lanes.hpp"
#include "model/coefficients.hpp"
#include "model/force/link_frame.hpp"
#include "model/force/sheave_motion.hpp"

namespace cvtflow::model {
namespace {

using TipLanes = Lanes<tips_per_link>;

/// (-, +, -, +): what differs between the two sides.
[[nodiscard]] inline TipLanes by_side(double minus, double plus) noexcept {
    const Lanes<2> sides = join<1>(minus, plus);
    return join<2>(sides, sides);
}
/// (rear, rear, front, front): what differs between the two ends of the link.
[[nodiscard]] inline TipLanes by_end(double rear, double front) noexcept { return join<2>(Lanes<2>(rear), Lanes<2>(front)); }

/// Coefficient m of both halves; c points at the rear half's m = 0, the front half's follow.
template <int P>
[[nodiscard]] inline TipLanes coefficient(const double* c, int m) noexcept { return by_end(c[m], c[P + 1 + m]); }

/// Σ c_m P_m(±1) of both halves: P_m(±1) = (±1)^m.
template <int P>
[[nodiscard]] inline TipLanes end_values(const double* c) noexcept {
    TipLanes even = coefficient<P>(c, 0);
    if constexpr (P == 0) return even;
    TipLanes odd = coefficient<P>(c, 1);
    if constexpr (P >= 2) even += coefficient<P>(c, 2);
    if constexpr (P >= 3) odd += coefficient<P>(c, 3);
    return even + by_side(-1.0, 1.0) * odd;
}

/// Σ c_m P_m'(±1) of both halves: P_m'(±1) = (±1)^(m+1) m (m+1)/2.
template <int P>
[[nodiscard]] inline TipLanes end_slopes(const double* c) noexcept {
    if constexpr (P == 0) return TipLanes(0.0);
    TipLanes slope = coefficient<P>(c, 1);
    if constexpr (P >= 3) slope += 6.0 * coefficient<P>(c, 3);
    if constexpr (P >= 2) slope += by_side(-3.0, 3.0) * coefficient<P>(c, 2);
    return slope;
}

struct Vector3Lanes {
    TipLanes x, y, z;
};
[[nodiscard]] inline TipLanes dot(const Vector3Lanes& a, const Vector3Lanes& b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// Both sheaves of a pulley, spread over the lanes.
struct SheaveLanes {
    TipLanes x, y, z, tilt_x, tilt_y;
    explicit SheaveLanes(const SheaveMotion* s) noexcept
        : x(by_side(s[0].x, s[1].x)), y(by_side(s[0].y, s[1].y)), z(by_side(s[0].z, s[1].z)),
          tilt_x(by_side(s[0].tilt_x, s[1].tilt_x)), tilt_y(by_side(s[0].tilt_y, s[1].tilt_y)) {}
};

/// Positions of contact: everything that depends on the coordinates alone.
struct TipGeometry {
    TipLanes side;          ///< s = ±1
    Vector3Lanes end;       ///< E
    Vector3Lanes offset;    ///< S - E
    TipLanes slope_x, slope_y;  ///< σ_s
    TipLanes lean;          ///< σ_s·o
    Vector3Lanes arm;       ///< r = S - O
    Vector3Lanes local;     ///< ν, in the sheave's frame
    Vector3Lanes normal;    ///< G, in space
    TipLanes depth;         ///< δ [m], negative: gap
};

/// Sphere centre of every tip, without the sheave.
template <int P>
inline void place_spheres(const Coefficients& c, const LinkFrame& frame, const double* q, TipGeometry& g) noexcept {
    const auto& tip = c.tip;
    const double ox = frame.ty, oy = -frame.tx;
    g.side = by_side(-1.0, 1.0);
    g.end.x = end_values<P>(q);
    g.end.y = end_values<P>(q + 2 * (P + 1));
    g.end.z = by_end(q[at<P>.z(End::rear)], q[at<P>.z(End::front)]) +
              g.side * (c.half_length + by_end(q[at<P>.e(End::rear)], q[at<P>.e(End::front)]));
    g.slope_x = c.slope_scale * end_slopes<P>(q);
    g.slope_y = c.slope_scale * end_slopes<P>(q + 2 * (P + 1));
    g.lean = g.slope_x * ox + g.slope_y * oy;
    const TipLanes sideways = (tip.radius * tip.cosine) * g.side;
    const double outward = tip.radius * tip.sine;
    g.offset = {outward * ox - sideways * g.slope_x, outward * oy - sideways * g.slope_y, -outward * g.lean - sideways};
}

/// Geometry of all four tips of a link against the two sheaves of its pulley.
template <int P>
[[nodiscard, gnu::always_inline]] inline TipGeometry tip_geometry(const Coefficients& c, const LinkFrame& frame, const double* q, const SheaveMotion* sheaves) noexcept {
    TipGeometry g;
    place_spheres<P>(c, frame, q, g);
    const SheaveLanes o(sheaves);
    g.arm = {g.end.x + g.offset.x - o.x, g.end.y + g.offset.y - o.y, g.end.z + g.offset.z - o.z};
    const Vector3Lanes& r = g.arm;
    const TipLanes lx = r.x - o.tilt_y * r.z;
    const TipLanes ly = r.y + o.tilt_x * r.z;
    const TipLanes lz = r.z - (o.tilt_x * r.y - o.tilt_y * r.x);
    const TipLanes radius = sqrt(lx * lx + ly * ly);
    // Sphere centre from where it sits when a pin just touches at r_m: small numbers, so that the depth (µm) does not drown in the
    // rounding of the arc's radius (m):  depth = reach - |reach u + e| = -(2 reach u·e + e·e)/(reach + |reach u + e|).
    const TipLanes e1 = radius - c.tip.touching_radius;
    const TipLanes e2 = lz + (c.tip.radius * c.tip.cosine) * g.side;
    const TipLanes h1 = e1 + c.tip.reach * c.tip.sine;
    const TipLanes h2 = e2 - (c.tip.reach * c.tip.cosine) * g.side;
    const TipLanes distance = sqrt(h1 * h1 + h2 * h2);
    const TipLanes overall = c.tip.reach + distance, plane = radius * distance, share = 1.0 / (plane * overall);   // one division for three
    g.depth = -(2.0 * c.tip.reach * (c.tip.sine * e1 - c.tip.cosine * g.side * e2) + e1 * e1 + e2 * e2) * (share * plane);
    const TipLanes radial = h1 * (share * overall);
    g.local = {radial * lx, radial * ly, h2 * (share * overall * radius)};
    g.normal = {g.local.x + o.tilt_y * g.local.z, g.local.y - o.tilt_x * g.local.z,
                g.local.z + o.tilt_x * g.local.y - o.tilt_y * g.local.x};
    return g;
}

}  // namespace
}  // namespace cvtflow::model
