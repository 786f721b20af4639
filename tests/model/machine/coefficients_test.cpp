#include "model/machine/coefficients.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace cvtflow::model {
namespace {

/// A normal distribution that is cut at three deviations has 0.9733 of its variance: 1 - 6 φ(3)/(1 - 2 Φ(-3)).
TEST(Lengths, OfPinsAreNormalAndCutAtThreeDeviations) {
    Parameters p;
    EXPECT_TRUE(longer_halves(p).empty());
    p.chain.pins = 20000;
    p.imperfection.pin_length_spread = 2e-6;
    const std::vector<double> longer = longer_halves(p);
    ASSERT_EQ(longer.size(), 20000u);
    double sum = 0.0, squares = 0.0, largest = 0.0;
    for (const double half : longer) sum += half, squares += half * half, largest = std::max(largest, std::abs(half));
    const double deviation = 0.5 * 2e-6, root = std::sqrt(20000.0);
    EXPECT_NEAR(sum / 20000.0, 0.0, 4.0 * deviation / root);
    EXPECT_NEAR(squares / 20000.0 / (deviation * deviation), 0.9733, 4.0 * std::sqrt(2.0) / root);
    EXPECT_LE(largest, 3.0 * deviation);
    EXPECT_GT(largest, 2.7 * deviation) << "of 20,000, 130 are beyond 2.7";
    const double within = static_cast<double>(std::ranges::count_if(longer, [&](double half) { return std::abs(half) < deviation; }));
    EXPECT_NEAR(within / 20000.0, 0.6845, 4.0 * 0.465 / root) << "0.6827/0.9973";
    EXPECT_EQ(longer_halves(p), longer);
    p.imperfection.pin_length_seed = 2;
    EXPECT_NE(longer_halves(p), longer);
}

}  // namespace
}  // namespace cvtflow::model
