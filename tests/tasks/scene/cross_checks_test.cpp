#include "tasks/scene/cross_checks.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tasks/scene/parameter_table.hpp"

namespace cvtflow::tasks {
namespace {

TEST(CrossChecks, DefaultsPassAll) {
    for (const CrossCheck& check : cross_checks()) EXPECT_EQ(check.violation(Scene{}), std::nullopt);
}

TEST(CrossChecks, KeysExist) {
    for (const CrossCheck& check : cross_checks()) {
        EXPECT_FALSE(check.keys.empty());
        for (const auto key : check.keys) EXPECT_NE(find_parameter(key), nullptr) << key;
    }
}

TEST(BeltRadii, AtRatioOneTheBeltIsTwoStrandsAndOneCircle) {
    const auto radii = belt_radii(84 * 8.12e-3, 0.170, 1.0);
    ASSERT_TRUE(radii);
    const double expected = (84 * 8.12e-3 - 2 * 0.170) / (2 * std::numbers::pi);
    EXPECT_NEAR(radii->driving, expected, 1e-15);
    EXPECT_NEAR(radii->driven, expected, 1e-15);
}

TEST(BeltRadii, SatisfyTheBeltEquationAtEveryRatio) {
    for (const double ratio : {0.417, 0.7, 1.0, 1.5, 2.4}) {
        const auto radii = belt_radii(0.68208, 0.170, ratio);
        ASSERT_TRUE(radii);
        const auto [r1, r2] = *radii;
        const double f = std::asin((r2 - r1) / 0.170);
        EXPECT_NEAR(r2 / r1, ratio, 1e-12);
        EXPECT_NEAR(2 * 0.170 * std::cos(f) + std::numbers::pi * (r1 + r2) + 2 * f * (r2 - r1), 0.68208, 1e-14);
    }
}

TEST(BeltRadii, AtRatioTwoPointFourAreThePublishedOnes) {
    const auto radii = belt_radii(84 * 8.12e-3, 0.170, 2.4);
    ASSERT_TRUE(radii);
    EXPECT_NEAR(radii->driving, 30.984e-3, 5e-7);
    EXPECT_NEAR(radii->driven, 74.361e-3, 5e-7);
}

TEST(BeltRadii, ReciprocalRatiosSwapTheShafts) {
    const auto low = belt_radii(0.68208, 0.170, 2.4);
    const auto high = belt_radii(0.68208, 0.170, 1.0 / 2.4);
    ASSERT_TRUE(low && high);
    EXPECT_NEAR(low->driving, high->driven, 1e-14);
    EXPECT_NEAR(low->driven, high->driving, 1e-14);
}

TEST(BeltRadii, AreEmptyForAChainThatIsTooShortOrTooLong) {
    EXPECT_FALSE(belt_radii(0.34, 0.170, 1.0));
    EXPECT_FALSE(belt_radii(0.90, 0.170, 1.0));
}

TEST(CrossChecks, AStateToStartFromNeedsNoGeometricStart) {
    Scene scene;
    scene.parameters.start.ratio = 10.0;
    const auto& closes = cross_checks().front();
    EXPECT_TRUE(closes.violation(scene));
    scene.state_file = "/some/state.h5";
    EXPECT_FALSE(closes.violation(scene));
}

TEST(CrossChecks, WithoutSettlingTheRampDoesNotMatter) {
    Scene scene;
    scene.parameters.start.settling_time = 0.0;
    for (const CrossCheck& check : cross_checks()) EXPECT_EQ(check.violation(scene), std::nullopt);
}

}  // namespace
}  // namespace cvtflow::tasks
