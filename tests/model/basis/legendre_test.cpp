#include "model/basis/legendre.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace cvtflow::model {
namespace {

TEST(Legendre, IsTheWrittenOutPolynomial) {
    for (double x = -1.0; x <= 1.0; x += 0.0625) {
        EXPECT_EQ(legendre(0, x), 1.0);
        EXPECT_EQ(legendre(1, x), x);
        EXPECT_NEAR(legendre(2, x), 1.5 * x * x - 0.5, 4e-16);
        EXPECT_NEAR(legendre(3, x), 2.5 * x * x * x - 1.5 * x, 4e-16);
        EXPECT_EQ(legendre_derivative(0, x), 0.0);
        EXPECT_EQ(legendre_derivative(1, x), 1.0);
        EXPECT_NEAR(legendre_derivative(2, x), 3.0 * x, 4e-16);
        EXPECT_NEAR(legendre_derivative(3, x), 7.5 * x * x - 1.5, 2e-15);
    }
}

TEST(Legendre, AtTheEndsHasTheKnownValuesAndSlopes) {
    for (int m = 0; m <= 12; ++m) {
        const double sign = m % 2 == 0 ? 1.0 : -1.0;
        EXPECT_NEAR(legendre(m, 1.0), 1.0, 1e-14);
        EXPECT_NEAR(legendre(m, -1.0), sign, 1e-14);
        EXPECT_NEAR(legendre_derivative(m, 1.0), 0.5 * m * (m + 1), 1e-12);
        EXPECT_NEAR(legendre_derivative(m, -1.0), -sign * 0.5 * m * (m + 1), 1e-12);
    }
}

TEST(GaussLegendre, IntegratesEveryPolynomialUpToTwiceItsPointsMinusOne) {
    for (int points = 1; points <= 16; ++points) {
        const Quadrature rule = gauss_legendre(points);
        ASSERT_EQ(rule.position.size(), static_cast<std::size_t>(points));
        for (int power = 0; power < 2 * points; ++power) {
            double sum = 0.0;
            for (std::size_t g = 0; g < rule.position.size(); ++g) sum += rule.weight[g] * std::pow(rule.position[g], power);
            EXPECT_NEAR(sum, power % 2 == 0 ? 1.0 / (power + 1) : 0.0, 1e-14)
                << points << " points, power " << power;  // weights sum to one
        }
    }
}

TEST(GaussLegendre, HasAscendingSymmetricPointsWithPositiveWeights) {
    for (int points = 1; points <= 16; ++points) {
        const Quadrature rule = gauss_legendre(points);
        for (std::size_t g = 0; g < rule.position.size(); ++g) {
            EXPECT_GT(rule.weight[g], 0.0);
            EXPECT_NEAR(rule.position[g], -rule.position[rule.position.size() - 1 - g], 1e-15);
            if (g > 0) {
                EXPECT_GT(rule.position[g], rule.position[g - 1]);
            }
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
