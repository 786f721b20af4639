#include "bench/method/analysis/stability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>

#include "engine/method/catalogue.hpp"
#include "tests/engine/method/plan_fixture.hpp"

namespace cvtflow::bench {
namespace {

TEST(Stability, FunctionOfRk4IsItsTaylorPolynomial) {
    for (const std::complex<double> z : {std::complex<double>{-2.0, 0.0}, {0.3, 1.7}, {0.0, 2.8}}) {
        const std::complex<double> expected = 1.0 + z + z * z / 2.0 + z * z * z / 6.0 + z * z * z * z / 24.0;
        EXPECT_LT(std::abs(stability_function(*find_method("rk4"), z) - expected), 1e-14);
        EXPECT_LT(std::abs(stability_function(*find_method("rk38"), z) - expected), 1e-14);
    }
}

TEST(Stability, BoundariesOfRk4) {
    EXPECT_NEAR(real_stability(*find_method("rk4")), 2.785, 1e-3);
    EXPECT_NEAR(imaginary_stability(*find_method("rk4")), std::sqrt(8.0), 1e-3);
}

TEST(Stability, BoundariesOfEuler) {
    EXPECT_NEAR(real_stability(*find_method("euler")), 2.0, 1e-5);
    EXPECT_LT(imaginary_stability(*find_method("euler")), 1e-4);
}

TEST(Stability, ChainedStepsMultiply) {
    const std::complex<double> z{-0.7, 0.4};
    const std::complex<double> half = 1.0 + 0.5 * z;
    EXPECT_LT(std::abs(stability_function(engine::test::two_half_euler_steps(), z) - half * half), 1e-15);
    EXPECT_NEAR(real_stability(engine::test::two_half_euler_steps()), 4.0, 1e-2);
}

/// Degree 3, order 3: Taylor's polynomial. Degree 6: at least the length that Medovikov's table claims. Imaginary: survey of methods.
TEST(Stability, BoundariesOfDumka) {
    EXPECT_NEAR(real_stability(engine::test::dumka3_degree_3()), 2.5127, 1e-3);
    EXPECT_GE(real_stability(engine::test::dumka3_degree_6()), 9.784756);
    EXPECT_LE(real_stability(engine::test::dumka3_degree_6()), 11.0);
    EXPECT_NEAR(imaginary_stability(engine::test::dumka3_degree_3()), std::sqrt(3.0), 1e-3);
    EXPECT_NEAR(imaginary_stability(engine::test::dumka3_degree_6()), 2.744, 1e-3);
}

TEST(Stability, ReachAlongARayOfDampingRatioFivePercent) {
    const std::complex<double> ray{-0.05, std::sqrt(1.0 - 0.05 * 0.05)};
    EXPECT_NEAR(stability_reach(engine::test::dumka3_degree_6(), ray, 1e-9), 3.065, 2e-3);
}

/// Two half Euler steps at h λ = -4: Y = y, -y; an error of the second stage is multiplied by 1 + z/2 = -1.
TEST(Stability, GrowthAndGainOfChainedSteps) {
    EXPECT_NEAR(stage_growth(engine::test::two_half_euler_steps(), 4.0), 1.0, 1e-14);
    EXPECT_NEAR(perturbation_gain(engine::test::two_half_euler_steps(), 4.0), 1.0, 1e-14);
    EXPECT_NEAR(perturbation_gain(engine::test::two_half_euler_steps(), 8.0), 3.0, 1e-14);
}

/// The order of DUMKA3's Euler steps lets stages grow, and errors made within a step much more. Survey of methods, on [-200, 0] for P5.
TEST(Stability, DumkaAmplifiesErrorsOfItsStages) {
    EXPECT_NEAR(stage_growth(*find_method("dumka3-p5"), 200.0), 4.7, 0.1);
    EXPECT_NEAR(perturbation_gain(*find_method("dumka3-p5"), 200.0), 570.0, 6.0);
    EXPECT_NEAR(perturbation_gain(*find_method("dumka3-p6"), 404.72), 1.4e4, 0.05e4);
    EXPECT_NEAR(perturbation_gain(*find_method("dumka3-p7"), 720.74), 8e6, 0.4e6);
}

/// RKC's stages never exceed y; an error of one grows like the number of stages at most, and less with damping.
TEST(Stability, RkcDoesNot) {
    for (const char* name : {"rkc-s10", "rkc-s20", "rkc-s50", "rkc-s20-e10", "rkc-s20-e20"}) {
        const StagePlan plan = *make_method(name);
        const double length = 0.99 * real_stability(plan);
        EXPECT_LE(stage_growth(plan, length), 1.0 + 1e-12) << name;
        EXPECT_LE(perturbation_gain(plan, length), 1.4 * static_cast<double>(plan.stages.size())) << name;
        RecordProperty(std::string("gain_") + name, std::to_string(perturbation_gain(plan, length)));
    }
    const StagePlan damped = *make_method("rkc-s20-e20");
    EXPECT_LE(perturbation_gain(damped, 0.99 * real_stability(damped)), 12.0);
}

}  // namespace
}  // namespace cvtflow::bench
