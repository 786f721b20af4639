#include "bench/study/profile/statistics.hpp"

#include <gtest/gtest.h>

namespace cvtflow::bench {

using namespace tasks;
namespace {

TEST(Statistics, MedianIsTheMiddleOrTheMeanOfTheMiddleTwo) {
    EXPECT_EQ(median({}), 0.0);
    EXPECT_EQ(median({3.0}), 3.0);
    EXPECT_EQ(median({9.0, 1.0, 2.0}), 2.0);
    EXPECT_EQ(median({4.0, 1.0, 100.0, 2.0}), 3.0);
}

TEST(Statistics, QuartilesEncloseTheMedian) {
    const Spread five = spread({5.0, 1.0, 4.0, 2.0, 3.0});
    EXPECT_EQ(five.lower_quartile, 2.0);
    EXPECT_EQ(five.median, 3.0);
    EXPECT_EQ(five.upper_quartile, 4.0);
    EXPECT_EQ(spread({}).median, 0.0);
    EXPECT_EQ(spread({7.0}).upper_quartile, 7.0);
}

}  // namespace
}  // namespace cvtflow::bench
