/// Lanes of doubles and of floats: code over a width computes, lane by lane, the results of single numbers.

#include <gtest/gtest.h>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "model/basis/lanes.hpp"

namespace cvtflow::model {
namespace {

/// Values of both signs, zero and NaN, in every lane position in turn.
template <int W>
void compare_with_scalars() {
    const std::array<double, 7> values{-2.5, 0.0, 1e-300, 3.0, -1e9, std::numeric_limits<double>::quiet_NaN(), 7.0};
    for (std::size_t shift = 0; shift < values.size(); ++shift) {
        std::array<double, W> a{};
        std::array<double, W> b{};
        for (std::size_t lane = 0; lane < W; ++lane) {
            a[lane] = values[(lane + shift) % values.size()];
            b[lane] = values[(2 * lane + shift + 1) % values.size()];
        }
        const auto chosen = select_greater<W>(load<W>(a.data()), load<W>(b.data()), Lanes<W>(1.0), Lanes<W>(-1.0));
        const auto positive = positive_part<W>(load<W>(a.data()));
        bool all = true;
        for (int lane = 0; lane < W; ++lane) {
            const auto k = static_cast<std::size_t>(lane);
            EXPECT_EQ(chosen[lane], a[k] > b[k] ? 1.0 : -1.0) << "lane " << lane << " of " << W;
            EXPECT_EQ(positive[lane], a[k] > 0.0 ? a[k] : 0.0) << "lane " << lane << " of " << W;
            all = all && a[k] <= 3.0;
        }
        EXPECT_EQ(all_at_most<W>(load<W>(a.data()), 3.0), all);
    }
}

TEST(Lanes, ChooseAsScalarsDoInEveryLaneAndWidth) {
    compare_with_scalars<1>();
    compare_with_scalars<2>();
    compare_with_scalars<4>();
    compare_with_scalars<8>();
    compare_with_scalars<16>();
}

template <int W>
void expect_tree_sum() {
    std::array<double, W> values{};
    for (std::size_t lane = 0; lane < W; ++lane)
        values[lane] = std::sin(1.0 + static_cast<double>(lane)) * std::pow(10.0, static_cast<double>(lane % 5));
    std::array<double, W> tree = values;
    for (std::size_t half = W / 2; half > 0; half /= 2) {
        for (std::size_t lane = 0; lane < half; ++lane) tree[lane] += tree[lane + half];
    }
    EXPECT_EQ(sum<W>(load<W>(values.data())), tree[0]) << W;
}

TEST(Lanes, AreSummedInOneFixedTree) {
    expect_tree_sum<1>();
    expect_tree_sum<2>();
    expect_tree_sum<4>();
    expect_tree_sum<8>();
    expect_tree_sum<16>();
}

template <int W, std::size_t count>
void expect_same_sums() {
    std::array<Lanes<W>, count> terms;
    for (std::size_t k = 0; k < count; ++k) {
        for (std::size_t lane = 0; lane < W; ++lane) terms[k].set(lane, std::sin(1.0 + static_cast<double>(k * W + lane)));
    }
    std::array<double, count> together{};
    sums<W, count>(terms, together.data());
    for (std::size_t k = 0; k < count; ++k)
        EXPECT_EQ(together[k], sum<W>(terms[k])) << "value " << k << " of " << count << ", " << W << " lanes";
}

template <int W>
void expect_same_sums_of_any_number() {
    expect_same_sums<W, 1>();
    expect_same_sums<W, 3>();
    expect_same_sums<W, 4>();
    expect_same_sums<W, 10>();
    expect_same_sums<W, 23>();
}

TEST(Lanes, SummedSideBySideGiveTheSameBitsAsOneByOne) {
    expect_same_sums_of_any_number<1>();
    expect_same_sums_of_any_number<2>();
    expect_same_sums_of_any_number<4>();
    expect_same_sums_of_any_number<8>();
    expect_same_sums_of_any_number<16>();
}

TEST(Lanes, TwoReciprocalsComeFromOneDivision) {
    const Reciprocals<4> both(Lanes<4>(3.0), Lanes<4>(7.0));
    EXPECT_DOUBLE_EQ(both.first[0], 1.0 / 3.0);
    EXPECT_DOUBLE_EQ(both.second[3], 1.0 / 7.0);
}

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
