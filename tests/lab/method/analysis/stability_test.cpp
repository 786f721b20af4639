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

/// Two half Euler steps at h λ = -4: Y = y, -y; an error of the second stage is multiplied by 1 + z/2 = -1.
TEST(Stability, GrowthAndGainOfChainedSteps) {
    EXPECT_NEAR(stage_growth(engine::test::two_half_euler_steps(), 4.0), 1.0, 1e-14);
    EXPECT_NEAR(perturbation_gain(engine::test::two_half_euler_steps(), 4.0), 1.0, 1e-14);
    EXPECT_NEAR(perturbation_gain(engine::test::two_half_euler_steps(), 8.0), 3.0, 1e-14);
}

}  // namespace
}  // namespace cvtflow::bench
