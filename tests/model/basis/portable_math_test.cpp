#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <tuple>

#include "model/basis/extended.hpp"
#include "model/basis/portable_math.hpp"

namespace cvtflow::model {
namespace {

// The emulation of extended precision, whose bits have to be those of the processor that has it.

constexpr bool processor_has_it = std::numeric_limits<long double>::digits == 64;

/// One number in both forms.
struct Pair {
    EmulatedExtended emulated;
    long double expected;
};

/// The emulated number as the processor has it: exact.
long double value_of(EmulatedExtended x) {
    int exponent = 0;
    EmulatedExtended rest = x < 0.0 ? -x : x;
    if (!(rest > 0.0)) return static_cast<long double>(static_cast<double>(x));
    rest = frexp(rest, &exponent);
    const auto high = static_cast<double>(rint(ldexp(rest, 32))),
               low = static_cast<double>(ldexp(rest, 64) - ldexp(EmulatedExtended(high), 32));
    const long double size = std::ldexp(std::ldexp(static_cast<long double>(high), 32) + static_cast<long double>(low), exponent - 64);
    return x < 0.0 ? -size : size;
}

/// Significands of all bits, of few bits (ties) and of nearly all ones (carries); exponents near one another and far.
class Samples {
public:
    Pair next() {
        std::uint64_t significand = random_() | 1ull << 63;
        const auto kind = random_() % 4;
        if (kind == 1) significand &= ~0ull << random_() % 64;
        if (kind == 2) significand |= ~0ull >> random_() % 64;
        const int exponent = static_cast<int>(random_() % (random_() % 2 == 0 ? 8 : 200)) - 100;
        Pair pair{EmulatedExtended::of(significand, exponent), std::ldexp(static_cast<long double>(significand), exponent)};
        if (random_() % 2 == 0) pair = {-pair.emulated, -pair.expected};
        return pair;
    }

private:
    std::mt19937_64 random_{11};
};

TEST(EmulatedExtended, RoundsEveryOperationAsTheProcessor) {
    if (!processor_has_it) GTEST_SKIP() << "long double has no 64-bit significand here";
    Samples samples;
    for (int i = 0; i < 300000; ++i) {
        const Pair a = samples.next(), b = samples.next();
        ASSERT_EQ(value_of(a.emulated), a.expected);
        ASSERT_EQ(value_of(a.emulated + b.emulated), a.expected + b.expected) << a.expected << " " << b.expected;
        ASSERT_EQ(value_of(a.emulated - b.emulated), a.expected - b.expected) << a.expected << " " << b.expected;
        ASSERT_EQ(value_of(a.emulated * b.emulated), a.expected * b.expected) << a.expected << " " << b.expected;
        ASSERT_EQ(value_of(a.emulated / b.emulated), a.expected / b.expected) << a.expected << " " << b.expected;
        ASSERT_EQ(value_of(sqrt(a.emulated * a.emulated)), std::sqrt(a.expected * a.expected)) << a.expected;
        if (a.expected > 0.0L) {
            ASSERT_EQ(value_of(sqrt(a.emulated)), std::sqrt(a.expected)) << a.expected;
        }
        ASSERT_EQ(value_of(rint(a.emulated)), std::rint(a.expected)) << a.expected;
        ASSERT_EQ(static_cast<double>(a.emulated), static_cast<double>(a.expected));
        ASSERT_EQ(a.emulated < b.emulated, a.expected < b.expected);
    }
}

TEST(EmulatedExtended, RoundsToDoublesOnceAmongDenormalNumbersToo) {
    if (!processor_has_it) GTEST_SKIP() << "long double has no 64-bit significand here";
    Samples samples;
    for (int i = 0; i < 100000; ++i) {
        const Pair a = samples.next();
        for (const int twos : {-1100, -1040, -1000, 1000})
            ASSERT_EQ(static_cast<double>(ldexp(a.emulated, twos)), static_cast<double>(std::ldexp(a.expected, twos)))
                << a.expected << " " << twos;
    }
}

TEST(EmulatedExtended, TakesEveryDouble) {
    constexpr double smallest = std::numeric_limits<double>::denorm_min(), largest = std::numeric_limits<double>::max();
    for (const double x : {0.0, -0.0, 1.0, -3.5, smallest, -7.0 * smallest, std::numeric_limits<double>::min(), largest, 1e-310})
        EXPECT_EQ(static_cast<double>(EmulatedExtended(x)), x);
    EXPECT_TRUE(std::signbit(static_cast<double>(EmulatedExtended(-0.0))));
    EXPECT_EQ(static_cast<double>(ldexp(EmulatedExtended(1.0), 1024)), std::numeric_limits<double>::infinity());
}

TEST(EmulatedExtended, ReportsWhatIsNoNumber) {
    const EmulatedExtended zero = 0.0, one = 1.0, invalid = std::numeric_limits<double>::quiet_NaN();
    for (const EmulatedExtended x :
         {invalid, one / zero, zero / zero, sqrt(-one), invalid + one, one - invalid, invalid * zero, one / invalid,
          EmulatedExtended(std::numeric_limits<double>::infinity()), ldexp(invalid, -3), -invalid, rint(invalid)}) {
        EXPECT_TRUE(std::isnan(static_cast<double>(x)));
        EXPECT_FALSE(x < one);
        EXPECT_FALSE(x > one);
    }
}

TEST(Extended, HasSixtyFourBits) {
    const Extended third = Extended(1.0) / 3.0;
    EXPECT_EQ(static_cast<double>((third - static_cast<double>(third)) * 0x1p66), 1366.0);
    EXPECT_EQ(static_cast<double>(extended(0xc90fdaa22168c235, -63)), std::acos(-1.0) / 2.0);
}

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
