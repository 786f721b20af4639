#include "bench/method/stability/krylov_space.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace cvtflow::bench {
namespace {

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
