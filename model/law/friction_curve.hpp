#pragma once
/// Regularised Coulomb friction. A contact with normal force N, coefficient μ and slip velocity v gives the force -μ N g(|v|) v,
/// g(v) = s(v/v0)/v, where s rises from 0 to 1 around the saturation speed v0. (model/EQUATIONS.md section 7)

#include "model/parameters/parameters.hpp"

namespace cvtflow::model {

/// One friction law with its numbers, ready for kernels. The laws themselves are in friction_laws.hpp.
struct FrictionCurve {
    double coefficient = 0.0;       ///< μ [1]
    double saturation_speed = 1.0;  ///< v0 > 0 [m/s]
    FrictionLaw law = FrictionLaw::piecewise;

    double inverse_saturation_speed = 1.0;  ///< 1/v0, also g(0), the largest that g is [s/m]
    double proportional_speed = 1.0;        ///< ≥ 0, up to which s = v/v0; a hair above 0 where that is nowhere [m/s]
    double full_speed = 1.0;                ///< from which s = 1; may be infinite [m/s]
    double shape = 0.0;                     ///< one more number, whatever the law needs [s²/m²]
    double linear_speed_squared = 0.0;      ///< a v² whose root is below the proportional speed however it is rounded [m²/s²]

    FrictionCurve() = default;
    FrictionCurve(const Friction& friction, const Detail& detail) noexcept;

    /// With the same coefficient and saturation speed, without a smoothed corner.
    [[nodiscard]] FrictionCurve piecewise() const noexcept;
};

}  // namespace cvtflow::model
