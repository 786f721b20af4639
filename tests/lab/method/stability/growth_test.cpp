#include "bench/method/stability/growth.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace cvtflow::bench {
namespace {

TEST(Growth, IsTheLargestMultiplierThatIsNotNearOne) {
    // Diagonal: 0.02 … 0.98, then -1.05, and 1.06 that a step resolves.
    constexpr int size = 51;
    const LinearMap map = [](const double* from, double* to) {
        for (int k = 0; k < size - 2; ++k) to[k] = 0.02 * (k + 1) * from[k];
        to[size - 2] = -1.05 * from[size - 2];
        to[size - 1] = 1.06 * from[size - 1];
        return true;
    };
    const Growth growth = fastest_growth(size, map, {});
    EXPECT_NEAR(growth.factor, 1.05, 1e-9);  // a Krylov space of the whole: exact but for rounding
    EXPECT_NEAR(growth.multiplier.real(), -1.05, 1e-9);
    EXPECT_NEAR(std::abs(growth.real[size - 2]), 1.0, 1e-6);
    EXPECT_NEAR(fastest_growth(size, map, {}, {.from_one = 0.0}).factor, 1.06, 1e-9);
}

TEST(Growth, FindsPairsOfComplexMultipliers) {
    const LinearMap turn = [](const double* from, double* to) {
        const double c = 0.9 * std::cos(1.0), s = 0.9 * std::sin(1.0);
        to[0] = c * from[0] - s * from[1];
        to[1] = s * from[0] + c * from[1];
        return true;
    };
    const Growth growth = fastest_growth(2, turn, {});
    EXPECT_NEAR(growth.factor, 0.9, 1e-12);
    EXPECT_NEAR(std::arg(growth.multiplier), 1.0, 1e-12);
}

/// 200 rotations by 0.12 … 0.5, all with multipliers of size 0.995, each driven a little by the next: estimates from 160 directions reach
/// 1.003, outside all of them, with a residual of 0.011. Such a step does not grow.
TEST(Growth, IsNotCertainWhereEstimatesLieOutsideAllMultipliers) {
    constexpr int size = 400;
    constexpr double decay = 0.995, drive = 0.02;
    const LinearMap map = [](const double* from, double* to) {
        for (int k = 0; k < size / 2; ++k) {
            const double angle = 0.12 + 0.38 * k / (size / 2 - 1), c = decay * std::cos(angle), s = decay * std::sin(angle);
            to[2 * k] = c * from[2 * k] - s * from[2 * k + 1] + (2 * k + 2 < size ? drive * from[2 * k + 2] : 0.0);
            to[2 * k + 1] = s * from[2 * k] + c * from[2 * k + 1];
        }
        return true;
    };
    const Growth once = fastest_growth(size, map, {}, {.restarts = 0});
    EXPECT_GT(once.factor, 1.001);
    EXPECT_LE(once.certain(), 1.0);
    EXPECT_LE(fastest_growth(size, map, {}).certain(), 1.0);
}

TEST(Growth, IsInfiniteWhereTheMapFails) {
    EXPECT_TRUE(std::isinf(fastest_growth(3, [](const double*, double*) { return false; }, {}).factor));
    EXPECT_TRUE(std::isinf(fastest_growth(1,
                                          [](const double*, double* to) {
                                              *to = NAN;
                                              return true;
                                          },
                                          {})
                               .factor));
}

}  // namespace
}  // namespace cvtflow::bench
