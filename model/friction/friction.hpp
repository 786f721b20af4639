#pragma once
/// The slope of regularised Coulomb friction, over lanes. (model/EQUATIONS.md section 7)

#include "model/basis/lanes.hpp"
#include "model/friction/friction_curve.hpp"

namespace cvtflow::model {
namespace {

/// The speed that the slope divides by: v, but at least v0 (piecewise) or (1-d) v0 (smoothed), below which s is proportional to v.
template <int W>
[[nodiscard]] inline Lanes<W> regular_speed(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
    return larger<W>(speed, Lanes<W>(curve.proportional_speed));
}

/// g(v) [s/m] for speeds v ≥ 0: 1/max(v, v0) for the piecewise law, and the parabola between (1-d) v0 and (1+d) v0 for the smoothed one.
/// Continuous. @param inverse 1/regular_speed(speed), which the caller may have from a shared division
template <int W>
[[nodiscard]] inline Lanes<W> slip_factor(const FrictionCurve& curve, const Lanes<W>& speed, const Lanes<W>& inverse) noexcept {
    if (curve.smoothing == 0.0) return inverse;
    // c = 1 + d - v/v0, the distance to full saturation: the parabola 1 - c²/4d is between 0 and 2d, and gives 1 and 1 - d at their ends.
    const double d = curve.smoothing;
    const Lanes<W> distance = (1.0 + d) - curve.inverse_saturation_speed * speed;
    const Lanes<W> missing = smaller<W>(positive_part<W>(distance), Lanes<W>(2.0 * d));
    return (1.0 - curve.curvature * (missing * missing)) * inverse;
}

template <int W>
[[nodiscard]] inline Lanes<W> slip_factor(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
    return slip_factor<W>(curve, speed, 1.0 / regular_speed<W>(curve, speed));
}

}  // namespace
}  // namespace cvtflow::model
