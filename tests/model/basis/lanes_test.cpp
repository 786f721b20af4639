#include "model/basis/lanes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

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

}  // namespace
}  // namespace cvtflow::model
