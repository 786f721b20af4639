/// The emulation of extended precision, whose bits have to be those of the processor that has it.

#include <gtest/gtest.h>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "model/basis/extended.hpp"

namespace cvtflow::model {
namespace {

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

}  // namespace
}  // namespace cvtflow::model
