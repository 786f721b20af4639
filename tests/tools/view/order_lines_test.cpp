#include "tools/program/view/order_lines.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace cvtflow::tools {
namespace {

std::vector<double> places(const Series& lines) {
    std::vector<double> found;
    for (const Point& point : lines.points) {
        if (std::isfinite(point.y) && (found.empty() || point.x != found.back())) found.push_back(point.x);
    }
    return found;
}

TEST(OrderLines, PitchesRepeatAfterTheShortestPatternThatDividesTheChain) {
    EXPECT_EQ(pattern_length({8.0}, 84), 1);
    EXPECT_EQ(pattern_length({8.0, 8.0}, 84), 1) << "equal pitches are no pattern";
    EXPECT_EQ(pattern_length({7.0, 9.0}, 84), 2);
    EXPECT_EQ(pattern_length({7.0, 9.0, 7.0, 9.0}, 84), 2);
    EXPECT_EQ(pattern_length({7.0, 7.0, 9.0}, 84), 3);
    EXPECT_EQ(pattern_length({7.0, 9.0}, 7), 7) << "7 9 7 9 7 9 7: the round alone";
}

TEST(OrderLines, MarkThePatternBetweenThePinsAndEachShaftOnce) {
    const std::vector<Repetition> all{{"pins", 1200.0, true, "#111"},
                                      {"pitch pattern", 400.0, true, "#222"},
                                      {"round of the chain", 20.0, false, ""},
                                      {"shaft 1", 30.0, false, "#333"}};
    const std::vector<Series> lines = order_lines(all, 2.5, {0.1, 10.0});
    ASSERT_EQ(lines.size(), 3U) << "rounds are too close to one another to be drawn";
    EXPECT_THAT(places(lines[0]), testing::Pointwise(testing::DoubleNear(1e-12), {1.0, 2.0}));
    EXPECT_THAT(places(lines[1]), testing::Pointwise(testing::DoubleNear(1e-12), {1.0 / 3, 2.0 / 3, 4.0 / 3, 5.0 / 3, 7.0 / 3}));
    EXPECT_THAT(places(lines[2]), testing::Pointwise(testing::DoubleNear(1e-12), {0.025}));
    EXPECT_EQ(lines[1].name, "pitch pattern: 400 Hz and multiples");
    EXPECT_EQ(lines[2].name, "shaft 1: 30 Hz");
    EXPECT_EQ(orders_text(all), "order 1 = 1200 Hz; pitch pattern 0.333, round of the chain 0.0167, shaft 1 0.025");
}

}  // namespace
}  // namespace cvtflow::tools
