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
    if (all_at_most<W>(larger<W>(first, second), curve.surely_proportional))
        return {Lanes<W>(curve.factor_at_rest), Lanes<W>(curve.factor_at_rest)};
    const Lanes<W> a = regular_speed<W>(curve, sqrt(first)), b = regular_speed<W>(curve, sqrt(second));
    const Lanes<W> share = 1.0 / (a * b);
    const auto chosen = [&](const Lanes<W>& square, const Lanes<W>& sliding) {
        return select_greater<W>(square, Lanes<W>(curve.surely_proportional), sliding, Lanes<W>(curve.factor_at_rest));
    };
    return {chosen(first, slip_factor<W>(curve, a, share * b)), chosen(second, slip_factor<W>(curve, b, share * a))};
}

/// s(v) of a speed along one axis, with its sign: without division where the law is piecewise.
template <int W, bool Steepest>
[[nodiscard]] inline Lanes<W> held(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
    const Lanes<W> share = curve.inverse_saturation_speed * speed;
    if (Steepest) return share;
    if (curve.smoothing != 0.0) return slip_factor<W>(curve, abs(speed)) * speed;
    return larger<W>(smaller<W>(share, Lanes<W>(1.0)), Lanes<W>(-1.0));
}

}  // namespace
}  // namespace cvtflow::model
