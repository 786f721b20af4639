#include "bench/method/stability/growth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

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

/// The second difference of a chain of `size` masses between walls: eigenvalues -4 sin²(k π/(2 (size + 1))).
LinearMap chain_of(int size) {
    return [size](const double* from, double* to) {
        for (int k = 0; k < size; ++k) to[k] = (k > 0 ? from[k - 1] : 0.0) - 2.0 * from[k] + (k + 1 < size ? from[k + 1] : 0.0);
        return true;
    };
}

TEST(KrylovSpace, OfTheWholeHasEveryEigenvalue) {
    constexpr int size = 12;
    KrylovSpace space(size, size);
    while (!space.full()) ASSERT_TRUE(space.grow(chain_of(size)));
    std::vector<std::complex<double>> values = space.values();
    ASSERT_EQ(values.size(), 12u);
    std::sort(values.begin(), values.end(), [](const auto& a, const auto& b) { return a.real() > b.real(); });
    for (int k = 1; k <= size; ++k) {
        const double half = std::sin(k * M_PI / (2.0 * (size + 1)));
        EXPECT_NEAR(values[static_cast<std::size_t>(k - 1)].real(), -4.0 * half * half, 1e-12);
    }
}

TEST(KrylovSpace, HasTheOutermostEigenvaluesFirst) {
    constexpr int size = 400;
    KrylovSpace space(size, 60);
    while (!space.full()) ASSERT_TRUE(space.grow(chain_of(size)));
    double farthest = 0.0;
    for (const std::complex<double>& value : space.values()) farthest = std::min(farthest, value.real());
    EXPECT_NEAR(farthest, -4.0, 0.02);  // Chebyshev: within (π/(2·60))² of the interval's length
}

TEST(KrylovSpace, VectorsBelongToTheirValues) {
    constexpr int size = 9;
    KrylovSpace space(size, size);
    while (!space.full()) ASSERT_TRUE(space.grow(chain_of(size)));
    const std::complex<double> value = space.values().front();
    const std::vector<std::complex<double>> vector = space.vector_of(value).vector;
    std::vector<double> real(size), mapped(size);
    for (std::size_t k = 0; k < size; ++k) real[k] = vector[k].real();
    ASSERT_TRUE(chain_of(size)(real.data(), mapped.data()));
    for (std::size_t k = 0; k < size; ++k) EXPECT_NEAR(mapped[k], value.real() * real[k], 1e-10);
}

TEST(KrylovSpace, IsFullWhereItIsInvariant) {
    KrylovSpace space(5, 5, {0.0, 1.0, 0.0, 0.0, 0.0});
    const LinearMap stretch = [](const double* from, double* to) {
        for (int k = 0; k < 5; ++k) to[k] = (k + 1.0) * from[k];
        return true;
    };
    ASSERT_TRUE(space.grow(stretch));
    EXPECT_TRUE(space.full());
    ASSERT_EQ(space.values().size(), 1u);
    EXPECT_DOUBLE_EQ(space.values().front().real(), 2.0);
}

TEST(KrylovSpace, DoesNotGrowByWhatIsNotFinite) {
    KrylovSpace space(3, 3);
    EXPECT_FALSE(space.grow([](const double*, double*) { return false; }));
    EXPECT_FALSE(space.grow([](const double*, double* to) {
        std::fill(to, to + 3, std::numeric_limits<double>::quiet_NaN());
        return true;
    }));
    EXPECT_EQ(space.dimension(), 0);
}

}  // namespace
}  // namespace cvtflow::bench
