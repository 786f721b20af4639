#pragma once
/// Derivatives of every friction law, by numbers with derivatives: checked for all laws of the catalogue, and for the toy of the recipe.

#include "bench/method/jacobian/dual_lanes.hpp"
#include "tests/model/law/law_properties.hpp"

namespace cvtflow::model {
namespace {

/// A speed with a derivative gives that of the law: of s v/|v|, s'.
template <class Laws>
void expect_the_derivative_of_the_law(const FrictionCurve& curve) {
    const double v0 = curve.saturation_speed;
    for (const double u : law_speeds) {
        constexpr int one = directions<1>;
        const Lanes<one> v = Lanes<one>::variable(u * v0, 0), force = slip_factor_of_square<one, Laws>(curve, v * v) * v;
        EXPECT_NEAR(force.value, share_at<Laws>(curve, v.value), 1e-15) << u;
        const double tangent = slip_tangent<1, Laws>(curve, Lanes<1>(v.value))[0];
        EXPECT_NEAR(force.slope[0] * v.value, tangent * v.value, 1e-14) << u;  // both terms are up to 1, and cancel
        EXPECT_NEAR((friction_share<one, Laws>(curve, v).slope[0]) * v.value, tangent * v.value, 1e-14) << u;
    }
    EXPECT_EQ((slip_factor_of_square<directions<1>, Laws>(curve, Dual<1>::variable(0.0, 0)).slope[0]), 0.0)
        << "at rest it has a derivative";
}

}  // namespace
}  // namespace cvtflow::model
