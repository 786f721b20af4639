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

[[nodiscard]] inline TipLanes tip_lanes(double rear_minus, double rear_plus, double front_minus, double front_plus) noexcept {
    const double values[tips_per_link] = {rear_minus, rear_plus, front_minus, front_plus};
    return load<tips_per_link>(values);
}
[[nodiscard]] inline TipLanes by_side(double minus, double plus) noexcept { return tip_lanes(minus, plus, minus, plus); }
[[nodiscard]] inline TipLanes by_end(double rear, double front) noexcept { return tip_lanes(rear, rear, front, front); }

/// Σ c_m P_m(±1) of both halves; c points at the rear half's m = 0, the front half's follow.
template <int P>
[[nodiscard]] inline TipLanes end_values(const double* c) noexcept {
    double even[2] = {}, odd[2] = {};
    for (int end = 0; end < 2; ++end) {
        for (int m = 0; m <= P; ++m) (m % 2 == 0 ? even : odd)[end] += c[end * (P + 1) + m];
    }
    return tip_lanes(even[0] - odd[0], even[0] + odd[0], even[1] - odd[1], even[1] + odd[1]);
}

/// P_m'(±1) without its sign.
template <int M>
inline constexpr double end_derivative = 0.5 * M * (M + 1);

/// Σ c_m P_m'(±1) of both halves.
template <int P>
[[nodiscard]] inline TipLanes end_slopes(const double* c) noexcept {
    double even[2] = {}, odd[2] = {};   // of the derivative: P_1', P_3' are even
    for (int end = 0; end < 2; ++end) {
        const double* half = c + end * (P + 1);
        if constexpr (P >= 1) even[end] += half[1];
        if constexpr (P >= 2) odd[end] += 3.0 * half[2];
        if constexpr (P >= 3) even[end] += 6.0 * half[3];
    }
    return tip_lanes(even[0] - odd[0], even[0] + odd[0], even[1] - odd[1], even[1] + odd[1]);
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
[[nodiscard]] inline TipGeometry tip_geometry(const Coefficients& c, const LinkFrame& frame, const double* q, const SheaveMotion* sheaves) noexcept {
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
    g.depth = -(2.0 * c.tip.reach * (c.tip.sine * e1 - c.tip.cosine * g.side * e2) + e1 * e1 + e2 * e2) / (c.tip.reach + distance);
    const TipLanes radial = h1 / (radius * distance);
    g.local = {radial * lx, radial * ly, h2 / distance};
    g.normal = {g.local.x + o.tilt_y * g.local.z, g.local.y - o.tilt_x * g.local.z,
                g.local.z + o.tilt_x * g.local.y - o.tilt_y * g.local.x};
    return g;
}

}  // namespace
}  // namespace cvtflow::model
