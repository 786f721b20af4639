#include "model/law/friction_curve.hpp"

#include <algorithm>

#include "model/law/friction_laws.hpp"

namespace cvtflow::model {

FrictionCurve::FrictionCurve(const Friction& friction, const Detail& detail) noexcept
    : coefficient(friction.coefficient),
      saturation_speed(friction.saturation_speed),
      law(detail.friction),
      inverse_saturation_speed(1.0 / saturation_speed) {
    FrictionLaws::visit(law, [&](auto of) {
        proportional_speed = std::max(of.proportional(detail.smoothing), 1e-30) * saturation_speed;  // nothing is divided by zero
        full_speed = of.full(detail.smoothing) * saturation_speed;
        shape = of.shape(detail.smoothing, saturation_speed);
    });
    linear_speed_squared = (1.0 - 1e-12) * proportional_speed * proportional_speed;
}

FrictionCurve FrictionCurve::piecewise() const noexcept {
    Detail detail;
    detail.friction = FrictionLaw::piecewise;
    return FrictionCurve({coefficient, saturation_speed}, detail);
}

}  // namespace cvtflow::model
