#pragma once
/// The friction of a curve, whichever its law is, over lanes. (model/EQUATIONS.md section 7)
/// @tparam Laws among which a curve's law is

#include "model/law/friction_laws.hpp"

namespace cvtflow::model {
namespace {

/// The speed that the slope divides by, > 0: for some laws v itself, but at least the speed below which s is proportional to v. [m/s]
template <int W, class Laws = FrictionLaws>
[[nodiscard]] inline Lanes<W> regular_speed(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
    return Laws::visit(curve.law, [&](auto law) { return law.template divisor<W>(curve, speed); });
}

/// The secant g(v) = s/v [s/m]. Continuous.
/// @param regular regular_speed(v)   @param inverse 1/regular, which the caller may have from a shared division
template <int W, class Laws = FrictionLaws>
[[nodiscard]] inline Lanes<W> slip_factor(const FrictionCurve& curve, const Lanes<W>& regular, const Lanes<W>& inverse) noexcept {
    return Laws::visit(curve.law, [&](auto law) { return law.template secant<W>(curve, regular, inverse); });
}

/// g(v) for speeds v ≥ 0 [m/s].
template <int W, class Laws = FrictionLaws>
[[nodiscard]] inline Lanes<W> slip_factor(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
    const Lanes<W> regular = regular_speed<W, Laws>(curve, speed);
    return slip_factor<W, Laws>(curve, regular, 1.0 / regular);
}

/// g(v) from v² [m²/s²]. Where no lane slips beyond the proportional speed, nothing is divided and no root taken: the factor is known, to
/// the bit.
template <int W, class Laws = FrictionLaws>
[[nodiscard]] inline Lanes<W> slip_factor_of_square(const FrictionCurve& curve, const Lanes<W>& square) noexcept {
    if (all_at_most<W>(square, curve.linear_speed_squared)) return Lanes<W>(curve.inverse_saturation_speed);
    return slip_factor<W, Laws>(curve, sqrt(square));
}

/// The tangent ds/dv [s/m] for speeds v ≥ 0 [m/s].
template <int W, class Laws = FrictionLaws>
[[nodiscard]] inline Lanes<W> slip_tangent(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
    return Laws::visit(curve.law, [&](auto law) { return law.template tangent<W>(curve, speed); });
}

/// s of a velocity along one axis [m/s], with its sign [1].
template <int W, class Laws = FrictionLaws>
[[nodiscard]] inline Lanes<W> friction_share(const FrictionCurve& curve, const Lanes<W>& velocity) noexcept {
    return Laws::visit(curve.law, [&](auto law) { return law.template share<W>(curve, velocity); });
}

}  // namespace
}  // namespace cvtflow::model
