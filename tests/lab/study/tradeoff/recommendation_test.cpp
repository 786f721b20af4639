#include "bench/study/tradeoff/recommendation.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace cvtflow::bench {

namespace {

const std::vector<tasks::TradeoffPoint> tradeoffs{{"exact", 1e-6, 100.0},
                                                  {"good", 1e-4, 10.0},
                                                  {"beaten", 2e-4, 12.0},
                                                  {"fast", 1e-2, 1.0},
                                                  {"lost", std::numeric_limits<double>::infinity(), 0.1}};

TEST(ParetoFront, HoldsWhatNothingElseBeatsInBoth) {
    EXPECT_EQ(tasks::pareto_front(tradeoffs), (std::vector<bool>{true, true, false, true, false}));
}

TEST(Recommendation, IsTheFastestThatIsExactEnoughWithTheSafetyAsked) {
    EXPECT_EQ(recommended(tradeoffs, 1e-2, 1.0), 3U);
    EXPECT_EQ(recommended(tradeoffs, 1e-2, 3.0), 1U);
    EXPECT_EQ(recommended(tradeoffs, 1e-5, 3.0), 0U);
    EXPECT_EQ(recommended(tradeoffs, 1e-7, 1.0), std::nullopt);
}

}  // namespace

}  // namespace cvtflow::bench
