#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "bench/study/tradeoff/relative_error.hpp"

namespace cvtflow::bench {

namespace {

using Numbers = std::vector<double>;

TEST(RelativeError, IsTheDistanceOverTheLengthOfTheReference) {
    EXPECT_DOUBLE_EQ(relative_error(Numbers{3.0, 4.5}, Numbers{3.0, 4.0}), 0.1);
    RelativeError error;
    error.add(Numbers{3.0}, Numbers{3.0});
    RelativeError rest;
    rest.add(Numbers{4.5}, Numbers{4.0});
    error.add(rest);
    EXPECT_DOUBLE_EQ(error.value(), 0.1);
}

TEST(RelativeError, IsInfiniteForAZeroReferenceAndNumbersThatAreNotFinite) {
    EXPECT_EQ(relative_error(Numbers{0.0, 0.0}, Numbers{0.0, 0.0}), 0.0);
    EXPECT_EQ(relative_error(Numbers{1.0}, Numbers{0.0}), INFINITY);
    EXPECT_EQ(relative_error(Numbers{NAN}, Numbers{1.0}), INFINITY);
    EXPECT_EQ(relative_error(Numbers{1.0}, Numbers{NAN}), INFINITY);
}

}  // namespace

}  // namespace cvtflow::bench
