#include "tasks/tuning/pareto.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace cvtflow::tasks {
namespace {

const std::vector<TradeoffPoint> points{{"exact", 1e-6, 100.0},
                                        {"good", 1e-4, 10.0},
                                        {"beaten", 2e-4, 12.0},
                                        {"fast", 1e-2, 1.0},
                                        {"lost", std::numeric_limits<double>::infinity(), 0.1}};

TEST(ParetoFront, HoldsWhatNothingElseBeatsInBoth) { EXPECT_EQ(pareto_front(points), (std::vector<bool>{true, true, false, true, false})); }

TEST(Recommendation, IsTheFastestThatIsExactEnoughWithTheSafetyAsked) {
    EXPECT_EQ(recommended(points, 1e-2, 1.0), 3U);
    EXPECT_EQ(recommended(points, 1e-2, 3.0), 1U);
    EXPECT_EQ(recommended(points, 1e-5, 3.0), 0U);
    EXPECT_EQ(recommended(points, 1e-7, 1.0), std::nullopt);
}

}  // namespace
}  // namespace cvtflow::tasks
