#include "tests/lab/method/jacobian/dual_law_properties.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "model/law/friction.hpp"

namespace cvtflow::model {
namespace {

constexpr int two = directions<2>;
using T = Lanes<two>;

T x() { return T::variable(3.0, 0); }
T y() { return T::variable(-0.7, 1); }

void expect(const T& of, double value, double by_x, double by_y) {
    EXPECT_DOUBLE_EQ(of.value, value);
    EXPECT_DOUBLE_EQ(of.slope[0], by_x);
    EXPECT_DOUBLE_EQ(of.slope[1], by_y);
}

TEST(DualLanes, FollowTheRulesOfDifferentiation) {
    expect(x() + y(), 2.3, 1.0, 1.0);
    expect(1.5 - x() * y(), 1.5 + 2.1, 0.7, -3.0);
    expect(2.0 * (x() - y()) * 0.5, 3.7, 1.0, -1.0);
    expect(6.0 / x(), 2.0, -2.0 / 3.0, 0.0);
    expect(x() / 4.0, 0.75, 0.25, 0.0);
    expect(sqrt(x()), std::sqrt(3.0), 0.5 / std::sqrt(3.0), 0.0);
    expect(ten_ninths<two>(x()), std::pow(3.0, 10.0 / 9.0), 10.0 / 9.0 * std::pow(3.0, 1.0 / 9.0), 0.0);
}

TEST(DualLanes, TakeTheBranchOfTheValueWithItsDerivative) {
    expect(larger<two>(x(), y()), 3.0, 1.0, 0.0);
    expect(smaller<two>(x(), y()), -0.7, 0.0, 1.0);
    expect(positive_part<two>(y()), 0.0, 0.0, 0.0);
    expect(abs(y()), 0.7, 0.0, -1.0);
    expect(select_greater<two>(x(), T(2.0), y(), x()), -0.7, 0.0, 1.0);
    expect(ten_ninths<two>(y()), 0.0, 0.0, 0.0);
    EXPECT_TRUE(all_at_most<two>(x(), 3.0));
    EXPECT_FALSE(all_at_most<two>(x(), 2.999));
}

TEST(DualLanes, ShareADivisionAsOtherLanesDo) {
    const Reciprocals<two> inverse(x(), 2.0 + y());
    EXPECT_DOUBLE_EQ(inverse.first.value, 1.0 / 3.0);
    EXPECT_NEAR(inverse.first.slope[0], -1.0 / 9.0, 1e-16);
    EXPECT_NEAR(inverse.second.slope[1], -1.0 / (1.3 * 1.3), 1e-15);  // a product and a quotient more
    // What the product of both has of the other one cancels but for rounding.
    EXPECT_NEAR(inverse.first.slope[1], 0.0, 1e-16);
    EXPECT_NEAR(inverse.second.slope[0], 0.0, 1e-16);
}

TEST(DualLanes, GiveTheDerivativesOfEveryFrictionLaw) {
    for (std::size_t law = 0; law < friction_law_names.size(); ++law) {
        SCOPED_TRACE(friction_law_names[law]);
        for (const double d : {0.1, 0.5}) {
            Detail detail;
            detail.friction = static_cast<FrictionLaw>(law);
            detail.smoothing = d;
            expect_the_derivative_of_the_law<FrictionLaws>(FrictionCurve({0.09, 0.01}, detail));
        }
    }
}

TEST(DualLanes, GiveTheSlopeOfTheProfileOverSpeed) {
    const TipLaw law{.by_speed = SpeedProfile::through(std::vector{0.0, 0.01, 0.03, 0.3, 2.0}, std::vector{0.5, 0.8, 1.0, 0.4, 0.4})};
    constexpr int one = directions<1>;
    for (const double v : {0.0, 0.017, 0.2, 7.0})
        EXPECT_NEAR(speed_factor<one>(law, Lanes<one>::variable(v, 0)).slope[0], speed_factor_slope<1>(law, Lanes<1>(v))[0], 1e-12) << v;
}

}  // namespace
}  // namespace cvtflow::model
