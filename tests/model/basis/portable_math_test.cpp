#include <gtest/gtest.h>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <tuple>

#include "model/basis/portable_math.hpp"

namespace cvtflow::model {
namespace {

/// Error in units of the last place of the exact value, which the C library has in extended precision.
double ulps(double value, long double exact) {
    const double rounded = static_cast<double>(exact), next = std::nextafter(std::abs(rounded), std::numeric_limits<double>::infinity());
    return static_cast<double>(std::abs(static_cast<long double>(value) - exact) / static_cast<long double>(next - std::abs(rounded)));
}

constexpr double nearly_half = 0.502;  ///< correct rounding but for one case in some hundred

TEST(PortableMath, IsRoundedCorrectlyButForAFewCases) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> angle(-10.0, 10.0), far(-1e4, 1e4), sine(-1.0, 1.0), log(-30.0, 30.0), exponent(-1.5, 1.5);
    for (int i = 0; i < 20000; ++i) {
        for (const double x : {angle(random), far(random)}) {
            const double least = std::abs(x) < 10.0 ? nearly_half : 1.0;  // far away a zero of the sine may be near
            const bool sine_vanishes = std::abs(std::sin(x)) < 1e-3, cosine_vanishes = std::abs(std::cos(x)) < 1e-3;
            EXPECT_TRUE(sine_vanishes || ulps(portable_sin(x), std::sin(static_cast<long double>(x))) < least) << x;
            EXPECT_TRUE(cosine_vanishes || ulps(portable_cos(x), std::cos(static_cast<long double>(x))) < least) << x;
        }
        // |y log x| ≤ 45, which extended precision has to within 45 · 2⁻⁶³: 0.044 units of the result's last place beyond the half
        const double s = sine(random), x = std::exp(log(random)), y = exponent(random);
        EXPECT_LT(ulps(portable_asin(s), std::asin(static_cast<long double>(s))), nearly_half) << s;
        EXPECT_LT(ulps(portable_pow(x, y), std::pow(static_cast<long double>(x), static_cast<long double>(y))), 0.55) << x << "^" << y;
        EXPECT_LT(ulps(ten_ninths(x), std::pow(static_cast<long double>(x), 10.0L / 9.0L)), 2.0) << x;
    }
}

TEST(PortableMath, KnowsItsEnds) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(portable_sin(0.0), 0.0);
    EXPECT_EQ(portable_cos(0.0), 1.0);
    for (const double sign : {-1.0, 0.0, 1.0}) EXPECT_EQ(portable_asin(sign), sign * std::numbers::pi / 2.0);
    for (const auto& [x, y, power] :
         {std::tuple{1.0, 0.3, 1.0}, {10.0, 2.0, 100.0}, {60.0, 1.0, 60.0}, {0.0, 0.3, 0.0}, {1e300, 3.0, infinity}, {1e300, -3.0, 0.0}})
        EXPECT_EQ(portable_pow(x, y), power) << x << "^" << y;
    EXPECT_TRUE(std::isnan(portable_pow(-1.0, 0.3)));
    EXPECT_EQ(portable_hypot(3.0, 4.0), 5.0);
}

TEST(TenNinths, HaveTheirEnds) {
    EXPECT_EQ(ten_ninths(0.0), 0.0);
    EXPECT_EQ(ten_ninths(1e-300), 0.0);
    EXPECT_EQ(ten_ninths(1.0), 1.0);
    EXPECT_NEAR(ten_ninths(512.0), 1024.0, 1e-12 * 1024.0);
    EXPECT_TRUE(std::isnan(ten_ninths(std::nan(""))));
    for (double x = 1e-270; x < 1e250; x *= 1.7)
        EXPECT_NEAR(ten_ninths(x) / static_cast<double>(std::pow(static_cast<long double>(x), 10.0L / 9.0L)), 1.0, 5e-16) << x;
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

}  // namespace
}  // namespace cvtflow::model
