#pragma once
/// One tip against its sheave in any number type, for its derivatives: the formulas of model/force/tip_geometry.hpp and tips.hpp.

#include "model/force/sheave_motion.hpp"
#include "model/jacobian/contact_points.hpp"

namespace cvtflow::model {
namespace {

/// What a tip depends on.
template <class T>
struct TipPoint {
    double side;                            ///< ±1 [1]
    Force3<T> end;                          ///< E, end of the pin's axis [m]
    T slope_x, slope_y;                     ///< of the axis there [1]
    T tx, ty;                               ///< direction of the link
    Force3<T> end_rate;                     ///< [m/s]
    T slope_rate_x, slope_rate_y, turning;  ///< [1/s], [rad/s]
    Force3<T> centre;                       ///< O of the sheave [m]
    T tilt_x, tilt_y;
    Force3<T> centre_rate, spin;  ///< [m/s], [rad/s]
};

/// What it does.
template <class T>
struct TipEffect {
    Force3<T> force;   ///< on the end of the axis
    T tilt_x, tilt_y;  ///< on its slopes, times slope_scale
    T moment;          ///< about z on the link
    T sheave[6];       ///< (F_x, F_y, M_τx, M_τy, F_z, M_φ) on the sheave
};

template <class T>
[[nodiscard]] inline T dot(const Force3<T>& a, const Force3<T>& b) noexcept {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
[[nodiscard]] inline Force3<T> operator-(const Force3<T>& a, const Force3<T>& b) noexcept {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

/// Place of the contact.
template <class T>
struct TipPlace {
    Force3<T> offset, arm, local, normal;
    T depth;

    TipPlace(const TipCoefficients& tip, const TipPoint<T>& p) noexcept {
        const double outward = tip.radius * tip.sine, sideways = tip.radius * tip.cosine * p.side;
        const T lean = p.slope_x * p.ty - p.slope_y * p.tx;
        offset = {outward * p.ty - sideways * p.slope_x, -(outward * p.tx) - sideways * p.slope_y, -(outward * lean) - sideways};
        arm = {p.end.x + offset.x - p.centre.x, p.end.y + offset.y - p.centre.y, p.end.z + offset.z - p.centre.z};
        const T lx = arm.x - p.tilt_y * arm.z, ly = arm.y + p.tilt_x * arm.z, lz = arm.z - (p.tilt_x * arm.y - p.tilt_y * arm.x);
        const T radius = sqrt(lx * lx + ly * ly);
        const T e1 = radius - tip.touching_radius, e2 = lz + tip.radius * tip.cosine * p.side;
        const T h1 = e1 + tip.reach * tip.sine, h2 = e2 - tip.reach * tip.cosine * p.side;
        const T distance = sqrt(h1 * h1 + h2 * h2);
        depth = -((2.0 * tip.reach * (tip.sine * e1 - tip.cosine * p.side * e2) + e1 * e1 + e2 * e2) * inverse(distance + tip.reach));
        const T reciprocal = inverse(distance), radial = h1 * inverse(radius) * reciprocal;
        local = {radial * lx, radial * ly, h2 * reciprocal};
        normal = {local.x + p.tilt_y * local.z, local.y - p.tilt_x * local.z, local.z + p.tilt_x * local.y - p.tilt_y * local.x};
    }
};

/// Rate of approach, and velocity of the tip's material relative to the sheave's.
template <class T>
struct TipRates {
    T closing, lever_x, lever_y;
    Force3<T> sheave_arm, material;

    TipRates(const TipCoefficients& tip, const TipPoint<T>& p, const TipPlace<T>& g) noexcept {
        const double outward = tip.radius * tip.sine, sideways = tip.radius * tip.cosine * p.side;
        const T& w = p.turning;
        const T lean = p.slope_rate_x * p.ty - p.slope_rate_y * p.tx + w * (p.slope_x * p.tx + p.slope_y * p.ty);
        const Force3<T> sphere{p.end_rate.x + outward * (w * p.tx) - sideways * p.slope_rate_x,
                               p.end_rate.y + outward * (w * p.ty) - sideways * p.slope_rate_y, p.end_rate.z - outward * lean};
        const Force3<T>& s = p.spin;
        closing = s.x * (g.arm.y * g.local.z - g.arm.z * g.local.y) + s.y * (g.arm.z * g.local.x - g.arm.x * g.local.z) -
                  dot(g.normal, sphere - p.centre_rate);
        lever_x = g.offset.x - tip.radius * g.normal.x;
        lever_y = g.offset.y - tip.radius * g.normal.y;
        sheave_arm = {g.arm.x - tip.radius * g.normal.x, g.arm.y - tip.radius * g.normal.y, g.arm.z - tip.radius * g.normal.z};
        const Force3<T>& a = sheave_arm;
        material = {p.end_rate.x - w * lever_y - p.centre_rate.x - (s.y * a.z - s.z * a.y),
                    p.end_rate.y + w * lever_x - p.centre_rate.y - (s.z * a.x - s.x * a.z),
                    p.end_rate.z - p.centre_rate.z - (s.x * a.y - s.y * a.x)};
    }
};

/// g(|v|) with the branch that the phase prescribes.
template <class T>
[[nodiscard]] inline T phase_factor(const FrictionCurve& curve, const T& square, Phase phase) noexcept {
    if (phase == Phase::stick) return T(1.0 / curve.saturation_speed);
    return phase == Phase::slip ? inverse(sqrt(square)) : slip_factor_of_square(curve, square);
}

/// A touching tip.
template <class T>
[[nodiscard]] inline TipEffect<T> tip_effect(const Coefficients& c, const TipPoint<T>& p, Phase phase) noexcept {
    const TipCoefficients& tip = c.tip;
    const TipPlace<T> g(tip, p);
    if (!(g.depth.value > 0.0)) return {};
    const TipRates<T> m(tip, p, g);
    const T normal = positive_part(tip.hertz * (g.depth * sqrt(g.depth)) * (1.0 + tip.damping * m.closing));
    const T along = dot(m.material, g.normal);
    const Force3<T> slip{m.material.x - along * g.normal.x, m.material.y - along * g.normal.y, m.material.z - along * g.normal.z};
    const T grip = -(tip.friction.coefficient * (normal * phase_factor(tip.friction, dot(slip, slip), phase)));
    const Force3<T> friction{grip * slip.x, grip * slip.y, grip * slip.z};
    const Force3<T> push{normal * g.normal.x, normal * g.normal.y, normal * g.normal.z};
    const double outward = tip.radius * tip.sine, sideways = tip.radius * tip.cosine * p.side;
    const Force3<T>&a = m.sheave_arm, &r = g.arm;
    return {{push.x + friction.x, push.y + friction.y, push.z + friction.z},
            -(outward * (p.ty * push.z)) - sideways * push.x,
            outward * (p.tx * push.z) - sideways * push.y,
            outward * (push.x * p.tx + push.y * p.ty - (p.slope_x * p.tx + p.slope_y * p.ty) * push.z) + m.lever_x * friction.y -
                m.lever_y * friction.x,
            {-(push.x + friction.x), -(push.y + friction.y),
             -(normal * (r.y * g.local.z - r.z * g.local.y)) - (a.y * friction.z - a.z * friction.y),
             -(normal * (r.z * g.local.x - r.x * g.local.z)) - (a.z * friction.x - a.x * friction.z), -(push.z + friction.z),
             -(a.x * friction.y - a.y * friction.x)}};
}

}  // namespace
}  // namespace cvtflow::model
