#include "tools/program/view/recorded_run.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

class RunDifferences : public Program {
protected:
    RecordedRun recorded(const std::string& name, const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"-o", name + ".h5"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = run_briefly(arguments);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return RecordedRun((folder_ / (name + ".h5")).string());
    }
};

TEST_F(RunDifferences, AreNoneBetweenARecordAndItself) {
    const RecordedRun run = recorded("a", {"--set", "run.output_interval=1 us"});
    const RunDifference d = difference(run, run);
    EXPECT_EQ(d.times, run.times());
    ASSERT_EQ(d.channels.size(), run.overview().size());
    for (const ChannelDifference& each : d.channels) {
        EXPECT_EQ(each.largest, 0.0) << each.curve.name;
        EXPECT_EQ(each.all.absolute(), 0.0) << each.curve.name;
    }
}

/// One simulation twice, the second with outputs half as often and for three quarters of the time: equal where both have a row; between
/// them, half the sum of its neighbours, which is linear interpolation.
TEST_F(RunDifferences, AreTakenAtTheRowsOfTheFirstWithinTheTimeThatBothHave) {
    const RecordedRun a = recorded("a", {"--set", "run.output_interval=1 us"});
    const RecordedRun b = recorded("b", {"--set", "run.output_interval=2 us", "--until", "14 us"});
    const RunDifference d = difference(a, b);
    ASSERT_EQ(d.times.size(), 15u);
    ASSERT_NEAR(d.times.back(), 14e-6, 1e-12);
    const auto curves = a.overview();
    const auto slip = std::find_if(curves.begin(), curves.end(), [](const Curve& curve) { return curve.name == "slip"; });
    const auto found =
        std::find_if(d.channels.begin(), d.channels.end(), [](const ChannelDifference& each) { return each.curve.name == "slip"; });
    ASSERT_TRUE(slip != curves.end() && found != d.channels.end());
    // Steps of both runs end at the same times but for rounding, which the slip's swings carry on: 1e-10 of them.
    double largest = 0.0, rounding = 0.0;
    for (const double value : slip->values) rounding = std::max(rounding, 1e-9 * std::abs(value));
    for (std::size_t k = 0; k < 15; ++k) {
        const double middle = k % 2 == 0 ? slip->values[k] : 0.5 * (slip->values[k - 1] + slip->values[k + 1]);
        EXPECT_NEAR(found->curve.values[k], middle - slip->values[k], rounding) << k;
        largest = std::max(largest, std::abs(middle - slip->values[k]));
    }
    EXPECT_GT(largest, 0.0);
    EXPECT_NEAR(found->largest, largest, rounding);
}

TEST_F(RunDifferences, AreSignedAndRelativeToTheFirst) {
    const MeanDifference mean{-2.0, 1.0};
    EXPECT_EQ(mean.absolute(), 3.0);
    EXPECT_EQ(mean.relative(), 1.5);
    EXPECT_TRUE(std::isnan((MeanDifference{0.0, 1.0}.relative())));
    const RecordedRun a = recorded("a", {}), b = recorded("b", {"--set", "load.torque=7 N*m", "--set", "record.ledger=true"});
    const RunDifference d = difference(b, a);
    for (const ChannelDifference& each : d.channels) {
        const RunDifference back = difference(a, b);
        const auto same = std::find_if(back.channels.begin(), back.channels.end(),
                                       [&](const ChannelDifference& other) { return other.curve.name == each.curve.name; });
        ASSERT_TRUE(same != back.channels.end());
        EXPECT_EQ(each.all.absolute(), -same->all.absolute()) << each.curve.name;
    }
}

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
