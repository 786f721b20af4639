#pragma once
/// Regularised Coulomb friction. A contact with normal force N, coefficient μ and slip velocity v gives the force -μ N g(|v|) v,
/// g(v) = s(v/v0)/v, where s rises from 0 to 1 around the saturation speed v0. (model/EQUATIONS.md section 7)

#include <algorithm>

#include "model/parameters/parameters.hpp"

namespace cvtflow::model {

/// One friction law with its numbers, ready for kernels.
struct FrictionCurve {
    double coefficient = 0.0;       ///< μ [1]
    double saturation_speed = 1.0;  ///< v0 > 0 [m/s]
    double smoothing = 0.0;         ///< half-width d of the parabola in units of v0; 0 is the piecewise law [1]

    double proportional_speed = 1.0;        ///< (1-d) v0 > 0, up to which s = v/v0 [m/s]
    double full_speed = 1.0;                ///< (1+d) v0, from which s = 1 [m/s]
    double inverse_saturation_speed = 1.0;  ///< 1/v0 [s/m]
    double curvature = 0.0;                 ///< 1/(4 d v0²), 0 for the piecewise law [s²/m²]
    double factor_at_rest = 1.0;            ///< g(v) up to the proportional speed [s/m]
    double surely_proportional = 0.0;       ///< a v² whose root is below the proportional speed however it is rounded [m²/s²]

    FrictionCurve() = default;
    FrictionCurve(const Friction& friction, const Detail& detail) noexcept
        : coefficient(friction.coefficient),
          saturation_speed(friction.saturation_speed),
          smoothing(detail.friction == FrictionLaw::smoothed ? detail.smoothing : 0.0),
          proportional_speed(std::max(1.0 - smoothing, 1e-30) * saturation_speed),  // d = 1: nothing is divided by zero
          full_speed((1.0 + smoothing) * saturation_speed),
          inverse_saturation_speed(1.0 / saturation_speed),
          curvature(smoothing > 0.0 ? 0.25 / (smoothing * saturation_speed * saturation_speed) : 0.0),
          factor_at_rest(smoothing > 0.0 ? inverse_saturation_speed : 1.0 / proportional_speed),
          surely_proportional((1.0 - 1e-12) * proportional_speed * proportional_speed) {}
};

}  // namespace cvtflow::model
