#pragma once
/// The slope of regularised Coulomb friction, over lanes. (model/EQUATIONS.md section 7)

#include "model/basis/lanes.hpp"
#include "model/law/friction_curve.hpp"

namespace cvtflow::model {
namespace {

/// The speed that the slope divides by: v, but at least v0 (piecewise) or (1-d) v0 (smoothed), below which s is proportional to v.
template <int W>
[[nodiscard]] inline Lanes<W> regular_speed(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
    return larger<W>(speed, Lanes<W>(curve.proportional_speed));
}

/// g(v) [s/m]: 1/max(v, v0) for the piecewise law; for the smoothed one, where s = u - (u - 1 + d)²/4d between 1 - d and 1 + d (the
/// parabola of the equations, written from its lower end: nothing cancels at low speed, nothing is divided). Continuous.
/// @param regular regular_speed(v)   @param inverse 1/regular, which the caller may have from a shared division
template <int W>
[[nodiscard]] inline Lanes<W> slip_factor(const FrictionCurve& curve, const Lanes<W>& regular, const Lanes<W>& inverse) noexcept {
    if (curve.smoothing == 0.0) return inverse;
    const Lanes<W> beyond = regular - curve.proportional_speed;
    const Lanes<W> parabola = curve.inverse_saturation_speed - curve.curvature * (beyond * beyond) * inverse;
    return select_greater<W>(regular, Lanes<W>(curve.full_speed), inverse, parabola);
}

/// g(v) for speeds v ≥ 0.
template <int W>
[[nodiscard]] inline Lanes<W> slip_factor(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
    const Lanes<W> regular = regular_speed<W>(curve, speed);
    return slip_factor<W>(curve, regular, 1.0 / regular);
}

/// g(v) from v². Where no lane slips beyond the proportional speed, nothing is divided and no root taken: the factor is known, to the
/// bit.
template <int W>
[[nodiscard]] inline Lanes<W> slip_factor_of_square(const FrictionCurve& curve, const Lanes<W>& square) noexcept {
    if (all_at_most<W>(square, curve.surely_proportional)) return Lanes<W>(curve.factor_at_rest);
    return slip_factor<W>(curve, sqrt(square));
}

}  // namespace
}  // namespace cvtflow::model
