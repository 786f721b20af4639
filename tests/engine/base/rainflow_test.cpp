#include "engine/base/rainflow.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

namespace cvtflow::engine {
namespace {

std::map<double, double> counts_by_range(const std::vector<RainflowCycle>& cycles) {
    std::map<double, double> counts;
    for (const RainflowCycle& cycle : cycles) counts[cycle.range] += cycle.count;
    return counts;
}

/// ASTM E1049-85, figure 6 and its table of counts by range.
TEST(Rainflow, CountsTheStandardsExample) {
    const double history[] = {-2, 1, -3, 5, -1, 3, -4, 4, -2};
    const auto cycles = rainflow(history);
    EXPECT_EQ(counts_by_range(cycles), (std::map<double, double>{{3, 0.5}, {4, 1.5}, {6, 0.5}, {8, 1.0}, {9, 0.5}}));
    ASSERT_EQ(cycles.size(), 7u);
    EXPECT_EQ(cycles[2].count, 1.0);  // E-F, the only whole cycle
    EXPECT_EQ(cycles[2].mean, 1.0);
    EXPECT_EQ(cycles[2].first, 4u);
    EXPECT_EQ(cycles[2].second, 5u);
}

TEST(Rainflow, PointsOnTheWayAndPlateausChangeNothing) {
    const double plain[] = {-2, 1, -3, 5, -1, 3, -4, 4, -2};
    const double dense[] = {-2, -1, 0, 1, 1, -1, -3, -3, -3, 2, 5, 5, -1, -1, 3, 1, -4, 0, 0, 4, 1, -2, -2};
    EXPECT_EQ(counts_by_range(rainflow(dense)), counts_by_range(rainflow(plain)));
}

TEST(Rainflow, HistoriesWithoutCyclesHaveNone) {
    EXPECT_TRUE(rainflow({}).empty());
    EXPECT_TRUE(rainflow(std::vector<double>{3.0}).empty());
    EXPECT_TRUE(rainflow(std::vector<double>(10, 3.0)).empty());
    const auto ramp = rainflow(std::vector<double>{0.0, 1.0, 2.0});
    ASSERT_EQ(ramp.size(), 1u);
    EXPECT_EQ(ramp[0].range, 2.0);
    EXPECT_EQ(ramp[0].count, 0.5);
}

/// Every stretch between reversals belongs to exactly one cycle: a cycle has two of them, half a cycle one.
TEST(Rainflow, EveryStretchBetweenReversalsIsCountedOnce) {
    std::mt19937 chance(7);
    std::normal_distribution<double> normal;
    std::vector<double> history(2000);
    for (double& value : history) value = normal(chance);
    double stretches = 0.0;
    for (const RainflowCycle& cycle : rainflow(history)) stretches += 2.0 * cycle.count;
    EXPECT_EQ(stretches, static_cast<double>(reversals(history).size() - 1));
    const auto [least, most] = std::minmax_element(history.begin(), history.end());
    EXPECT_EQ(counts_by_range(rainflow(history)).rbegin()->first, *most - *least) << "the largest range is that of the whole history";
}

TEST(Rainflow, ClassesHoldAllCycles) {
    const double history[] = {-2, 1, -3, 5, -1, 3, -4, 4, -2};
    const auto classes = rainflow_classes(rainflow(history), 3);  // borders 3, 6, 9
    ASSERT_EQ(classes.size(), 3u);
    EXPECT_EQ(classes[0].count, 0.5);
    EXPECT_EQ(classes[1].count, 2.0);
    EXPECT_EQ(classes[2].count, 1.5);
    EXPECT_EQ(classes[1].largest, 6.0);
    EXPECT_EQ(classes[0].mean, -0.5);  // from -2 to 1
    EXPECT_EQ(rainflow_classes({}, 2)[1].count, 0.0);
}

}  // namespace
}  // namespace cvtflow::engine
