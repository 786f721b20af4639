#include "model/machine/belt.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace cvtflow::model {
namespace {

constexpr double distance = 0.17;

TEST(Belt, AtRatioOneItsLengthIsTwoStrandsAndACircle) {
    // Sums of a few terms below 1 m: rounding is some 1e-16.
    EXPECT_NEAR(belt_length({0.05, 0.05}, distance), 2.0 * distance + 2.0 * std::numbers::pi * 0.05, 1e-15);
}

/// Published: 54.444 mm at ratio 1, 30.984 and 74.361 mm at ratio 2.4, rounded.
TEST(Belt, RadiiGiveBackTheLengthAndTheRatio) {
    EXPECT_NEAR(belt_radii(84 * 8.12e-3, 1.0, distance)->driving, 54.444e-3, 5e-7);
    EXPECT_NEAR(belt_radii(84 * 8.12e-3, 2.4, distance)->driving, 30.984e-3, 5e-7);
    EXPECT_NEAR(belt_radii(84 * 8.12e-3, 2.4, distance)->driven, 74.361e-3, 5e-7);
    for (const double ratio : {0.4, 0.7, 1.0, 1.6, 2.5}) {
        const auto radii = belt_radii(0.68208, ratio, distance);
        ASSERT_TRUE(radii.has_value()) << ratio;
        EXPECT_NEAR(radii->driven, ratio * radii->driving, 1e-17);
        EXPECT_NEAR(belt_length(*radii, distance), 0.68208, 1e-15) << ratio;  // bisected to the last digit
    }
}

TEST(Belt, HasNoRadiiIfItIsTooShortOrTooLong) {
    EXPECT_FALSE(belt_radii(2.0 * distance, 1.0, distance).has_value());                                // nothing left for the arcs
    EXPECT_FALSE(belt_radii(2.0 * distance + std::numbers::pi * distance, 1.0, distance).has_value());  // the pulleys would meet
    EXPECT_TRUE(belt_radii(2.0 * distance + 0.99 * std::numbers::pi * distance, 1.0, distance).has_value());
}

}  // namespace
}  // namespace cvtflow::model
