/// Lanes of floats are lanes: what is written over a width computes the same, lane by lane, as a float would.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "model/basis/single_lanes.hpp"

namespace cvtflow::model {
namespace {

template <int N>
std::vector<float> lanes_of_width(const Lanes<singles<N>>& lanes) {
    std::vector<float> to(N);
    lanes.copy_to(to.data());
    return to;
}

template <int N>
void expect_float_arithmetic() {
    constexpr int W = singles<N>;
    std::vector<float> a(N), b(N);
    for (int k = 0; k < N; ++k) {
        a[static_cast<std::size_t>(k)] = 0.1f + 0.37f * static_cast<float>(k * k);
        b[static_cast<std::size_t>(k)] = 3.3f - 0.71f * static_cast<float>(k);
    }
    const auto x = load<W>(a.data()), y = load<W>(b.data());
    const auto sum = lanes_of_width<N>(x + y), difference = lanes_of_width<N>(x - y), product = lanes_of_width<N>(x * y),
               quotient = lanes_of_width<N>(x / y), root = lanes_of_width<N>(sqrt(x)), size = lanes_of_width<N>(abs(y)),
               low = lanes_of_width<N>(smaller<W>(x, y)), high = lanes_of_width<N>(larger<W>(x, y)),
               chosen = lanes_of_width<N>(select_greater<W>(x, y, Lanes<W>(1.0), -y)), third = lanes_of_width<N>(Lanes<W>(1.0 / 3.0));
    for (std::size_t k = 0; k < N; ++k) {
        EXPECT_EQ(sum[k], a[k] + b[k]);
        EXPECT_EQ(difference[k], a[k] - b[k]);
        EXPECT_EQ(product[k], a[k] * b[k]);
        EXPECT_EQ(quotient[k], a[k] / b[k]);
        EXPECT_EQ(root[k], std::sqrt(a[k]));
        EXPECT_EQ(size[k], std::abs(b[k]));
        EXPECT_EQ(low[k], std::min(a[k], b[k]));
        EXPECT_EQ(high[k], std::max(a[k], b[k]));
        EXPECT_EQ(chosen[k], a[k] > b[k] ? 1.0f : -b[k]);
        EXPECT_EQ(third[k], static_cast<float>(1.0 / 3.0));
    }
}

TEST(SingleLanes, ComputeAsFloatsDoInEveryLane) {
    expect_float_arithmetic<native_floats>();
    expect_float_arithmetic<2 * native_floats>();
}

TEST(SingleLanes, AreAtMostALimitOnlyIfEveryLaneIs) {
    constexpr int N = 2 * native_floats, W = singles<N>;
    for (int lane = 0; lane < N; ++lane) {
        std::vector<float> numbers(N, 1.0f);
        EXPECT_TRUE(all_at_most<W>(load<W>(numbers.data()), 1.0));
        numbers[static_cast<std::size_t>(lane)] = std::nextafter(1.0f, 2.0f);
        EXPECT_FALSE(all_at_most<W>(load<W>(numbers.data()), 1.0)) << lane;
        numbers[static_cast<std::size_t>(lane)] = std::numeric_limits<float>::quiet_NaN();
        EXPECT_FALSE(all_at_most<W>(load<W>(numbers.data()), 1.0)) << lane;
    }
}

TEST(SingleLanes, TheFirstOfThemAreStoredAndNothingBehindThem) {
    constexpr int N = native_floats;
    for (int count = -1; count <= N; ++count) {
        std::vector<float> to(N, 7.0f);
        store_first<singles<N>>(Lanes<singles<N>>(2.0), to.data(), count);
        for (int k = 0; k < N; ++k) EXPECT_EQ(to[static_cast<std::size_t>(k)], k < count ? 2.0f : 7.0f) << count;
    }
}

TEST(SingleLanes, DoublesAreRoundedToTheNearest) {
    constexpr int W = 2 * native_lanes;
    const double between = 1.0 + 0.75 * static_cast<double>(std::numeric_limits<float>::epsilon());
    std::vector<float> to(W);
    store_rounded<W>(Lanes<W>(between), to.data());
    for (const float number : to) EXPECT_EQ(number, std::nextafter(1.0f, 2.0f));
}

}  // namespace
}  // namespace cvtflow::model
