#pragma once
/// The slope of regularised Coulomb friction, over lanes. (model/EQUATIONS.md section 7)

#include "model/basis/lanes.hpp"
#include "model/friction/friction_curve.hpp"

namespace cvtflow::model {
namespace {

/// g(v) [s/m] for speeds v ≥ 0: 1/max(v, v0) for the piecewise law, and the parabola between (1-d) v0 and (1+d) v0 for the smoothed one.
/// Continuous; never divides by less than (1-d) v0.
template <int W>
[[nodiscard]] inline Lanes<W> slip_factor(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
    const Lanes<W> v0(curve.saturation_speed);
    const Lanes<W> saturated = Lanes<W>(1.0) / larger<W>(speed, v0);
    if (curve.smoothing == 0.0) return saturated;
    const double d = curve.smoothing;
    const Lanes<W> above = Lanes<W>(1.0 + d) - speed / v0;   // distance to full saturation, in units of v0: the parabola is between 0 and 2d
    const Lanes<W> share = Lanes<W>(1.0) - above * above / (4.0 * d);
    const Lanes<W> parabola = share / larger<W>(speed, (1.0 - d) * v0);
    const Lanes<W> rising = select_greater<W>(above, Lanes<W>(0.0), parabola, saturated);
    return select_greater<W>(Lanes<W>(2.0 * d), above, rising, saturated);
}

}  // namespace
}  // namespace cvtflow::model
