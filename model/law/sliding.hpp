#pragma once
/// The friction law for a solver of friction alone: the law itself, or the steepest that it can be, which is that of sticking everywhere.

#include <utility>

#include "model/law/friction.hpp"

namespace cvtflow::model {
namespace {

/// s(v)/v for the square of a speed [s/m].
template <int W, bool Steepest>
[[nodiscard]] inline Lanes<W> sliding_factor(const FrictionCurve& curve, const Lanes<W>& square) noexcept {
    if constexpr (Steepest) return Lanes<W>(curve.inverse_saturation_speed);
    return slip_factor_of_square<W>(curve, square);
}

/// Two of them for one division. Sticking lanes get the factor at rest whether or not their neighbours need the division.
template <int W, bool Steepest>
[[nodiscard]] inline std::pair<Lanes<W>, Lanes<W>> sliding_factors(const FrictionCurve& curve, const Lanes<W>& first,
                                                                   const Lanes<W>& second) noexcept {
    if constexpr (Steepest) return {Lanes<W>(curve.inverse_saturation_speed), Lanes<W>(curve.inverse_saturation_speed)};
    const Lanes<W> at_rest(curve.inverse_saturation_speed);
    if (all_at_most<W>(larger<W>(first, second), curve.linear_speed_squared)) return {at_rest, at_rest};
    const Lanes<W> a = regular_speed<W>(curve, sqrt(first)), b = regular_speed<W>(curve, sqrt(second));
    const Reciprocals<W> inverse(a, b);
    const auto chosen = [&](const Lanes<W>& square, const Lanes<W>& sliding) {
        return select_greater<W>(square, Lanes<W>(curve.linear_speed_squared), sliding, at_rest);
    };
    return {chosen(first, slip_factor<W>(curve, a, inverse.first)), chosen(second, slip_factor<W>(curve, b, inverse.second))};
}

/// s of a velocity along one axis, with its sign [1]. velocity [m/s]
template <int W, bool Steepest>
[[nodiscard]] inline Lanes<W> sliding_share(const FrictionCurve& curve, const Lanes<W>& velocity) noexcept {
    if constexpr (Steepest) return curve.inverse_saturation_speed * velocity;
    return friction_share<W>(curve, velocity);
}

}  // namespace
}  // namespace cvtflow::model
