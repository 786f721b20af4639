#include "tests/oracle/legendre.hpp"

#include <gtest/gtest.h>

namespace cvtflow::oracle {
namespace {

TEST(GaussLegendre, IntegratesPolynomialsUpToTwiceThePointsExactly) {
    for (int count = 1; count <= 20; ++count) {
        const auto points = gauss_legendre(count);
        for (int power = 0; power < 2 * count; ++power) {
            Real mean = 0.0L;
            for (const auto& point : points) mean += point.weight * std::pow(point.at, power);
            const Real expected = power % 2 == 0 ? 1.0L / (power + 1) : 0.0L;
            // Weights sum to 1 in numbers of 64 bits: as many roundings of 5e-20 as there are points, and those of the nodes.
            EXPECT_NEAR(static_cast<double>(mean - expected), 0.0, 1e-17) << count << " points, power " << power;
        }
    }
}

TEST(LegendrePolynomials, AreOrthogonalWithTheNormOfTheInertia) {
    for (int m = 0; m <= 3; ++m) {
        for (int n = 0; n <= 3; ++n) {
            Real mean = 0.0L;
            for (const auto& point : gauss_legendre(6)) mean += point.weight * legendre(m, point.at) * legendre(n, point.at);
            EXPECT_NEAR(static_cast<double>(mean), m == n ? 1.0 / (2 * m + 1) : 0.0, 1e-16);
        }
    }
}

TEST(LegendrePolynomials, HaveTheSlopesOfTheirDifferences) {
    for (int m = 0; m <= 3; ++m) {
        for (const Real x : {-1.0L, -0.3L, 0.6L, 1.0L}) {
            const Real slope = (legendre(m, x + 1e-6L) - legendre(m, x - 1e-6L)) / 2e-6L;
            EXPECT_NEAR(static_cast<double>(legendre_slope(m, x)), static_cast<double>(slope), 1e-11);
        }
    }
}

}  // namespace
}  // namespace cvtflow::oracle
