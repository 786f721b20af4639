#include "tools/program/plot/finite.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace cvtflow::tools {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN(), endless = std::numeric_limits<double>::infinity();

TEST(FiniteFigures, LeaveOutWhatIsUndefined) {
    const FiniteFigures figures(std::vector{none, 3.0, 1.0, endless, 2.0, none});
    EXPECT_EQ(figures.mean, 2.0);
    EXPECT_EQ(figures.least, 1.0);
    EXPECT_EQ(figures.largest, 3.0);
}

TEST(FiniteFigures, AreUndefinedWhereNothingIsFinite) {
    for (const std::vector<double>& numbers : {std::vector<double>{}, {none, none}, {endless}}) {
        const FiniteFigures figures(numbers);
        EXPECT_TRUE(std::isnan(figures.mean) && std::isnan(figures.least) && std::isnan(figures.largest)) << numbers.size();
    }
}

TEST(FiniteExtremes, AreWhereTheyStandInTheRange) {
    const std::vector numbers{none, 0.5, -1.0, 4.0, none};
    const auto [low, high] = finite_extremes(numbers.begin(), numbers.end(), [](double number) { return number; });
    EXPECT_EQ(low - numbers.begin(), 2);
    EXPECT_EQ(high - numbers.begin(), 3);
}

}  // namespace
}  // namespace cvtflow::tools
