#include <gtest/gtest.h>
#include <cmath>

#include "law_properties.hpp"
#include "model/law/friction_laws.hpp"

namespace cvtflow::model {
namespace {

TEST(FrictionLaws, AllOweTheSame) {
    for (std::size_t law = 0; law < friction_law_names.size(); ++law) {
        SCOPED_TRACE(friction_law_names[law]);
        for (const double d : {0.1, 0.5}) {
            Detail detail;
            detail.friction = static_cast<FrictionLaw>(law);
            detail.smoothing = d;
            expect_a_law<FrictionLaws>(FrictionCurve({0.09, 0.01}, detail));
        }
    }
}

TEST(FrictionLaws, EachNameHasALawOfItsOwn) {
    for (std::size_t law = 0; law < friction_law_names.size(); ++law) {
        const auto chosen = FrictionLaws::visit(static_cast<FrictionLaw>(law), [](auto of) { return of.law; });
        EXPECT_EQ(chosen, static_cast<FrictionLaw>(law)) << friction_law_names[law];
    }
}

TEST(FrictionLaws, ACurveWithoutItsCornerIsThePiecewiseOne) {
    Detail detail;
    detail.friction = FrictionLaw::smoothed;
    const FrictionCurve plain = FrictionCurve({0.09, 0.01}, detail).piecewise();
    EXPECT_EQ(plain.coefficient, 0.09);
    for (const double u : law_speeds) EXPECT_NEAR(share_at<FrictionLaws>(plain, u * 0.01), std::min(u, 1.0), 1e-15) << u;
}

constexpr double v0 = 0.01;

FrictionCurve piecewise() { return FrictionCurve({0.09, v0}, {}); }
FrictionCurve smoothed(double half_width) {
    Detail detail;
    detail.friction = FrictionLaw::smoothed;
    detail.smoothing = half_width;
    return FrictionCurve({0.09, v0}, detail);
}
double slip_factor(const FrictionCurve& curve, double speed) { return model::slip_factor<1>(curve, Lanes<1>(speed))[0]; }
/// Share of the full friction, with the sign of the speed: what a force uses.
double share(const FrictionCurve& curve, double speed) { return slip_factor(curve, std::abs(speed)) * speed; }

TEST(Friction, PiecewiseIsLinearUpToTheSaturationSpeedAndConstantBeyond) {
    for (double u = 0.0; u < 1.0; u += 0.05) EXPECT_NEAR(share(piecewise(), u * v0), u, 1e-15);
    for (double u = 1.0; u < 1e6; u *= 1.7) EXPECT_NEAR(share(piecewise(), u * v0), 1.0, 1e-15);
}

TEST(Friction, IsOddNeverExceedsOneAndNeverOpposesTheSpeed) {
    for (const FrictionCurve& curve : {piecewise(), smoothed(0.05), smoothed(0.5), smoothed(1.0)}) {
        for (double u = 0.0; u < 4.0; u += 0.01) {
            EXPECT_EQ(share(curve, -u * v0), -share(curve, u * v0));
            EXPECT_GE(share(curve, u * v0), 0.0);
            EXPECT_LE(share(curve, u * v0), 1.0 + 1e-15);
        }
    }
}

TEST(Friction, NeverDividesByZero) {
    for (const FrictionCurve& curve : {piecewise(), smoothed(0.1), smoothed(1.0)}) {
        EXPECT_NEAR(slip_factor(curve, 0.0), 1.0 / v0, 1e-13 / v0);
        for (const double tiny : {5e-324, 1e-300, 1e-30, 1e-12}) EXPECT_TRUE(std::isfinite(slip_factor(curve, tiny))) << tiny;
    }
}

TEST(Friction, SmoothedIsTheParabolaOfItsDefinition) {
    for (const double d : {0.1, 0.5, 0.9}) {
        const FrictionCurve curve = smoothed(d);
        for (double u = 0.0; u < 3.0; u += 0.01) {
            const double expected = u <= 1.0 - d ? u : u >= 1.0 + d ? 1.0 : 1.0 - (1.0 + d - u) * (1.0 + d - u) / (4.0 * d);
            EXPECT_NEAR(share(curve, u * v0), expected, 2e-15) << u;
        }
    }
}

TEST(Friction, SmoothedIsContinuousWithItsSlope) {
    const double step = 1e-7;
    for (const double d : {0.1, 0.5, 0.9}) {
        const FrictionCurve curve = smoothed(d);
        const auto slope = [&](double u) { return (share(curve, (u + step) * v0) - share(curve, (u - step) * v0)) / (2.0 * step); };
        for (double u = 0.05; u < 3.0; u += 0.01) {
            // The second derivative is at most 1/(2d), so slopes 4 steps apart differ by 2 steps/d; rounding adds 1e-16/step.
            EXPECT_NEAR(slope(u + 2.0 * step), slope(u - 2.0 * step), 2.0 * step / d + 1e-8) << u;
        }
        for (const double corner : {1.0 - d, 1.0 + d}) {
            EXPECT_NEAR(slope(corner - 2.0 * step), corner < 1.0 ? 1.0 : 0.0, 2.0 * step / d + 1e-8);
            EXPECT_NEAR(slope(corner + 2.0 * step), corner < 1.0 ? 1.0 : 0.0, 2.0 * step / d + 1e-8);
        }
    }
}

TEST(Friction, SmoothedTendsToPiecewiseAsItsWidthShrinks) {
    for (const double d : {0.2, 0.02, 0.002}) {
        double worst = 0.0;
        for (double u = 0.0; u < 2.0; u += 1e-4) worst = std::max(worst, std::abs(share(smoothed(d), u * v0) - share(piecewise(), u * v0)));
        EXPECT_NEAR(worst, 0.25 * d, 1e-3 * d);  // the parabola is d/4 below the corner
    }
}

TEST(Friction, LanesAgreeWithOneLane) {
    for (const FrictionCurve& curve : {piecewise(), smoothed(0.3)}) {
        const double speeds[] = {0.0, 0.5 * v0, 0.95 * v0, 7.0 * v0};
        const Lanes<4> four = model::slip_factor<4>(curve, load<4>(speeds));
        for (std::size_t lane = 0; lane < 4; ++lane) EXPECT_EQ(four[lane], slip_factor(curve, speeds[lane]));
    }
}

}  // namespace
}  // namespace cvtflow::model
