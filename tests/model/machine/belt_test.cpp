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

TEST(Belt, RadiiGiveBackTheLengthAndTheRatio) {
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

/// Every pitch path of these tests.
const PitchPath paths[] = {PitchPath(BeltRadii{0.03, 0.07}, distance), PitchPath(BeltRadii{0.07, 0.03}, distance),
                           PitchPath(BeltRadii{0.05, 0.05}, distance), PitchPath(0.1)};

TEST(PitchPath, ClosesAndIsTravelledAtUnitSpeed) {
    const double step = 1e-6;
    for (const PitchPath& path : paths) {
        for (int k = 0; k < 1000; ++k) {
            const double s = path.length() * k / 1000.0;
            const Point here = path.at(s), next = path.at(s + step), around = path.at(s + path.length());
            EXPECT_NEAR(std::hypot(around.x - here.x, around.y - here.y), 0.0, 1e-15);
            // A chord is shorter than its arc by s³/(24 r²), here 5e-17; the corner of arc and strand is smooth.
            EXPECT_NEAR(std::hypot(next.x - here.x, next.y - here.y), step, 1e-15);
        }
    }
}

TEST(PitchPath, RunsCounterClockwiseAroundBothAxes) {
    for (const PitchPath& path : paths) {
        double area = 0.0;  // of the polygon of 1000 points, positive if counter-clockwise
        for (int k = 0; k < 1000; ++k) {
            const Point a = path.at(path.length() * k / 1000.0), b = path.at(path.length() * (k + 1) / 1000.0);
            area += 0.5 * (a.x * b.y - a.y * b.x);
        }
        EXPECT_GT(area, 0.005);
    }
}

TEST(PitchPath, KeepsTheRadiiOnItsArcs) {
    const BeltRadii radii{0.03, 0.07};
    const PitchPath path(radii, distance);
    for (int k = 0; k < 1000; ++k) {
        const double s = path.length() * k / 1000.0;
        const Point here = path.at(s);
        const double side = path.side_at(s);
        if (side == 0.0 && k > 0) {
            EXPECT_NEAR(std::hypot(here.x, here.y), radii.driving, 1e-15);
        }
        if (side == 1.0) {
            EXPECT_NEAR(std::hypot(here.x - distance, here.y), radii.driven, 1e-15);
        }
    }
}

TEST(PitchPath, AdvancesByChords) {
    for (const PitchPath& path : paths) {
        for (int k = 0; k < 100; ++k) {
            const double s = path.length() * k / 100.0;
            const double to = path.advance(s, 8e-3);
            const Point a = path.at(s), b = path.at(to);
            EXPECT_GT(to, s);
            EXPECT_NEAR(std::hypot(b.x - a.x, b.y - a.y), 8e-3, 1e-16 * 4);  // coordinates of 0.2 m have units in the last place of 3e-17
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
