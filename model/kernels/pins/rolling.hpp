#pragma once
/// Where the halves of whole pins are: they roll on each other, so that their distance is a function of the angle between the links.
/// (model/EQUATIONS.md section 10)

#include <cmath>

#include "model/basis/lanes.hpp"
#include "model/machine/coefficients.hpp"

namespace cvtflow::model {
namespace {

/// A vector in the plane; of several pins side by side if Real is Lanes.
template <class Real>
struct Plane {
    Real x, y;

    friend Plane operator+(const Plane& a, const Plane& b) noexcept { return {a.x + b.x, a.y + b.y}; }
    friend Plane operator-(const Plane& a, const Plane& b) noexcept { return {a.x - b.x, a.y - b.y}; }
    friend Plane operator*(const Real& factor, const Plane& a) noexcept { return {factor * a.x, factor * a.y}; }
};
template <class Real>
[[nodiscard]] inline Real dot(const Plane<Real>& a, const Plane<Real>& b) noexcept {
    return a.x * b.x + a.y * b.y;
}

/// Line from a pin's middle to that of the next one.
template <class Real>
struct PitchLine {
    Plane<Real> along;    ///< t
    Real inverse_length;  ///< [1/m]
    Real turning;         ///< θ' [rad/s]
};

/// @param step, rate from one pin to the next: [m], [m/s]
template <class Real>
[[nodiscard]] inline PitchLine<Real> pitch_line(const Plane<Real>& step, const Plane<Real>& rate) noexcept {
    using std::sqrt;
    const Real inverse = 1.0 / sqrt(dot(step, step));
    const Plane<Real> t = inverse * step;
    return {t, inverse, (t.x * rate.y - t.y * rate.x) * inverse};
}

/// The halves of a pin between two links.
template <class Real>
struct Rolling {
    Plane<Real> reach, reach_rate;  ///< u: from the rear half R to the front half L of the link before [m], [m/s]
    Plane<Real> bisector;           ///< b
    Real turning;                   ///< of the bisector: the mean of both links' [rad/s]
    Real bending;                   ///< θ'₊ - θ'₋ [rad/s]
    Real xx, xy, yy;                ///< ∂u/∂s, symmetric; s = t₋ + t₊ [m]
};

/// @param diameter 2ρ, arm c_a [m]
template <class Real>
[[nodiscard]] inline Rolling<Real> rolling(double diameter, double arm, const PitchLine<Real>& before,
                                           const PitchLine<Real>& after) noexcept {
    using std::sqrt;
    const Plane<Real> s = before.along + after.along;
    const Real inverse = 1.0 / sqrt(dot(s, s));
    const Plane<Real> b = inverse * s;
    const Real wide = diameter * inverse, stretch = wide - arm;
    Rolling<Real> r;
    r.bisector = b;
    r.reach = stretch * s;
    r.xx = stretch - wide * b.x * b.x;
    r.xy = -(wide * b.x * b.y);
    r.yy = stretch - wide * b.y * b.y;
    const Plane<Real> rate{-(before.turning * before.along.y + after.turning * after.along.y),
                           before.turning * before.along.x + after.turning * after.along.x};
    r.reach_rate = {r.xx * rate.x + r.xy * rate.y, r.xy * rate.x + r.yy * rate.y};
    r.turning = 0.5 * (before.turning + after.turning);
    r.bending = after.turning - before.turning;
    return r;
}

}  // namespace
}  // namespace cvtflow::model
