#pragma once
/// Properties of every friction law: checked for all laws of the catalogue, and for the toy of the recipe.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "model/law/friction_laws.hpp"

namespace cvtflow::model {
namespace {

/// Speeds over v0 that lie in all branches of all laws, and off their corners.
inline constexpr double law_speeds[] = {1e-9, 0.02, 0.3, 0.85, 0.97, 1.04, 1.2, 1.9, 5.0, 300.0};

template <class Laws>
[[nodiscard]] double share_at(const FrictionCurve& curve, double velocity) {
    return friction_share<1, Laws>(curve, Lanes<1>(velocity))[0];
}

template <class Laws>
void expect_a_rise_from_zero_to_one(const FrictionCurve& curve) {
    EXPECT_EQ(share_at<Laws>(curve, 0.0), 0.0);
    double before = 0.0;
    for (const double u : law_speeds) {
        const double share = share_at<Laws>(curve, u * curve.saturation_speed);
        EXPECT_GE(share, before) << u;
        EXPECT_LE(share, std::min(u, 1.0) * (1.0 + 1e-15)) << u << ": concave with slope 1 at rest";
        EXPECT_EQ(share_at<Laws>(curve, -u * curve.saturation_speed), -share) << u;
        before = share;
    }
    EXPECT_NEAR(share_at<Laws>(curve, 1e9 * curve.saturation_speed), 1.0, 1e-8);
}

/// Secant, share and tangent are functions of one another: s = g v, and ds/dv by differences.
template <class Laws>
void expect_one_law_in_three_functions(const FrictionCurve& curve) {
    const double v0 = curve.saturation_speed;
    for (const double u : law_speeds) {
        const double v = u * v0, secant = slip_factor<1, Laws>(curve, Lanes<1>(v))[0],
                     tangent = slip_tangent<1, Laws>(curve, Lanes<1>(v))[0];
        EXPECT_NEAR(secant * v, share_at<Laws>(curve, v), 1e-15) << u;  // an ulp of 1, some roundings
        EXPECT_NEAR((slip_factor_of_square<1, Laws>(curve, Lanes<1>(v * v))[0]) * v, secant * v, 1e-15) << u;
        const double step = 1e-6 * v;
        const double difference = (share_at<Laws>(curve, v + step) - share_at<Laws>(curve, v - step)) / (2.0 * step);
        EXPECT_NEAR(tangent * v, difference * v, 2e-9) << u;  // rounding: 1e-16 of a share over 1e-6 of the speed; second order is less
        EXPECT_LE(tangent, secant * (1.0 + 1e-15)) << u << ": a concave law gives implicit friction one solution";
    }
    EXPECT_EQ((slip_factor_of_square<1, Laws>(curve, Lanes<1>(0.0))[0]), 1.0 / v0);
}

/// Four speeds side by side give the bits of each alone.
template <class Laws>
void expect_the_same_side_by_side(const FrictionCurve& curve) {
    const double v0 = curve.saturation_speed;
    for (std::size_t k = 0; k + 4 <= std::size(law_speeds); ++k) {
        const double four[] = {law_speeds[k] * v0, law_speeds[k + 1] * v0, law_speeds[k + 2] * v0, law_speeds[k + 3] * v0};
        const Lanes<4> secants = slip_factor<4, Laws>(curve, load<4>(four));
        for (std::size_t lane = 0; lane < 4; ++lane) EXPECT_EQ(secants[lane], (slip_factor<1, Laws>(curve, Lanes<1>(four[lane]))[0]));
    }
}

template <class Laws>
void expect_a_law(const FrictionCurve& curve) {
    expect_a_rise_from_zero_to_one<Laws>(curve);
    expect_one_law_in_three_functions<Laws>(curve);
    expect_the_same_side_by_side<Laws>(curve);
}

}  // namespace
}  // namespace cvtflow::model
