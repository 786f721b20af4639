/// Plots and reports as they show records and sweeps: differences of runs, lines and spectra of orders, marks of maps.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "tests/tools/program_fixture.hpp"
#include "tools/program/view/recorded_run.hpp"
#include "tools/program/view/run_plots.hpp"
#include "tools/program/view/sweep_view.hpp"

namespace cvtflow::tools {
namespace {

class RunDifferences : public Program {
protected:
    RecordedRun recorded(const std::string& name, const std::vector<std::string>& more) {
        const Outcome outcome = run_briefly(Words{"-o", name + ".h5"} + more);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return RecordedRun((folder_ / (name + ".h5")).string());
    }
};

/// Where no energy flows, as in these runs, an efficiency and a share of losses are none.
bool lacks_energy(const ChannelDifference& each) {
    return std::isnan(each.all.absolute()) && (each.curve.name == "efficiency" || each.curve.name == "loss_slip");
}

TEST_F(RunDifferences, AreNoneBetweenARecordAndItself) {
    const RecordedRun run = recorded("a", {"--set", "run.output_interval=1 us"});
    const RunDifference d = difference(run, run);
    EXPECT_EQ(d.times, run.times());
    ASSERT_EQ(d.channels.size(), run.overview().size());
    for (const ChannelDifference& each : d.channels) {
        EXPECT_EQ(each.largest, 0.0) << each.curve.name;
        EXPECT_TRUE(each.all.absolute() == 0.0 || lacks_energy(each)) << each.curve.name;
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
        EXPECT_TRUE(each.all.absolute() == -same->all.absolute() || lacks_energy(each)) << each.curve.name;
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

struct Sine {
    std::vector<double> times, values;
};

Sine sine(double frequency, double amplitude, std::size_t count) {
    Sine made;
    for (std::size_t k = 0; k < count; ++k) {
        made.times.push_back(1e-3 * static_cast<double>(k));
        made.values.push_back(5.0 + amplitude * std::sin(2.0 * std::numbers::pi * frequency * made.times.back()));
    }
    return made;
}

std::size_t peak(const AmplitudeSpectrum& spectrum) {
    return static_cast<std::size_t>(std::max_element(spectrum.amplitude.begin(), spectrum.amplitude.end()) - spectrum.amplitude.begin());
}

TEST(OrderSpectrum, ASinePeaksAtItsFrequencyWithItsAmplitude) {
    const Sine given = sine(125.0, 3.0, 512);  // a line of 1024 points
    const AmplitudeSpectrum spectrum = amplitude_spectrum(given.times, given.values);
    EXPECT_NEAR(spectrum.frequency[peak(spectrum)], 125.0, 1e-9);
    EXPECT_NEAR(spectrum.amplitude[peak(spectrum)], 3.0, 1e-3);  // leakage of the negative frequency
    EXPECT_LT(spectrum.amplitude[0], 1e-3);                      // the mean is not in it
    EXPECT_NEAR(spectrum.frequency.back(), 500.0, 1e-9);
}

/// A drift a hundred times as large as the line, of which a Hann window lets a fifth of a line pass at its fourth order.
TEST(OrderSpectrum, ADriftDoesNotLeakIntoLowOrders) {
    constexpr double frequency = 21.0 / 1.024;  // a line of 1024 points, 10.5 periods
    Sine given = sine(frequency, 3.0, 512);
    for (std::size_t k = 0; k < given.values.size(); ++k) given.values[k] += 300.0 * static_cast<double>(k) / 512.0;
    const AmplitudeSpectrum spectrum = amplitude_spectrum(given.times, given.values);
    EXPECT_NEAR(spectrum.frequency[peak(spectrum)], frequency, 1e-9);
    EXPECT_NEAR(spectrum.amplitude[peak(spectrum)], 3.0, 0.03);  // a line fits 10.5 periods of a sine by less than 1 % of it
    for (std::size_t k = 0; spectrum.frequency[k] < 10.0; ++k) EXPECT_LT(spectrum.amplitude[k], 0.03) << spectrum.frequency[k] << " Hz";
}

TEST(OrderSpectrum, AnyNumberOfValuesWillDo) {
    const Sine given = sine(123.4, 3.0, 777);
    const AmplitudeSpectrum spectrum = amplitude_spectrum(given.times, given.values);
    EXPECT_NEAR(spectrum.frequency[peak(spectrum)], 123.4, 0.25);  // half a line: 1/(2 · 2048 · 1 ms)
    EXPECT_NEAR(spectrum.amplitude[peak(spectrum)], 3.0, 0.03);    // a Hann window, at most an eighth of its width beside the line: 1 %
}

TEST(OrderSpectrum, ALastOutputAtAnotherDistanceIsLeftOut) {
    Sine given = sine(125.0, 3.0, 512);
    const AmplitudeSpectrum alone = amplitude_spectrum(given.times, given.values);
    given.times.push_back(given.times.back() + 1e-4);
    given.values.push_back(1e6);
    EXPECT_EQ(amplitude_spectrum(given.times, given.values).amplitude, alone.amplitude);
}

TEST(OrderSpectrum, OfTooFewValuesIsEmpty) { EXPECT_TRUE(amplitude_spectrum({0.0, 1.0}, {1.0, 2.0}).frequency.empty()); }

class Maps : public Program {
protected:
    [[nodiscard]] Plot map(const std::string& table, const std::string& y = "start.ratio") const {
        return sweep_map(read_sweep((folder_ / table).string()), "load.torque", y, "slip mean");
    }
    /// Points of a series; none without it.
    [[nodiscard]] static std::vector<Point> points_of(const Plot& plot, const std::string& series) {
        const auto found = std::ranges::find(plot.series, series, &Series::name);
        return found == plot.series.end() ? std::vector<Point>{} : found->points;
    }
    /// Map over load and ratio of four cases of tiny in a folder of their own. @param loads "6, 30" [N*m]   @param more further keys
    [[nodiscard]] Plot swept(const std::string& loads, const std::string& more = "") const {
        write("sweep.toml",
              "[sweep]\nscene = \"tiny\"\n[set]\nrun.until = \"20 us\"\nstart.state = \"\"\nstart.settling_time = \"20 us\"\n"
              "start.ramp_time = \"10 us\"\n" +
                  more + "[[axes]]\nkey = \"load.torque\"\nvalues = [" + loads +
                  "]\n[[axes]]\nkey = \"start.ratio\"\nvalues = [1, 1.2]\n[outputs]\nscalars = [\"slip mean\"]\n");
        std::filesystem::remove_all(folder_ / "swept");
        const Outcome batch = run({"batch", "sweep.toml", "-q", "-o", "swept"});
        EXPECT_EQ(batch.status, 0) << batch.err;
        return map("swept");
    }
};

TEST_F(Maps, PlaceASpeedRatioLogarithmically) {
    for (const auto& [column, scale] : {std::pair{"start_ratio", Scale::logarithmic},
                                        {"control_ratio", Scale::logarithmic},
                                        {"ratio_mean", Scale::logarithmic},
                                        {"thrust_ratio_mean", Scale::linear},
                                        {"chain_damping_ratio", Scale::linear}}) {
        write("cases.csv", std::string("status,load_torque,") + column + ",slip_mean\nok,10,0.5,1\nok,20,0.5,2\nok,10,2,3\nok,20,2,4\n");
        EXPECT_EQ(map("cases.csv", column).y.scale, scale) << column;
        EXPECT_EQ(map("cases.csv", column).x.scale, Scale::linear);
    }
    write("cases.csv", "status,load_torque,ratio_mean,slip_mean\nok,10,0,1\nok,20,0,2\nok,10,2,3\nok,20,2,4\n");
    EXPECT_EQ(map("cases.csv", "ratio_mean").y.scale, Scale::linear) << "0 has no logarithm";
}

TEST_F(Maps, OverTheLoadHaveTheTorqueLimit) {
    const std::vector<Point> limit = points_of(swept("6, 30"), "torque limit");
    ASSERT_EQ(limit.size(), 2U);
    const double radius = (24 * 8.12e-3 - 2.0 * 47e-3) / (2.0 * std::numbers::pi);  // of both pulleys at ratio 1
    EXPECT_NEAR(limit[0].x, 2.0 * 0.09 * 5700.0 * radius / std::cos(11.0 * std::numbers::pi / 180.0), 1e-9);
    EXPECT_EQ(limit[0].y, 1.0);
    EXPECT_NEAR(limit[1].x / limit[0].x, 1.2 / 1.1, 0.01) << "the sum of the radii hardly changes";
    EXPECT_EQ(limit[1].y, 1.2);
}

TEST_F(Maps, ShowNoTorqueLimitThatNoCaseReaches) {
    EXPECT_THAT(points_of(swept("6, 12"), "torque limit"), testing::IsEmpty()) << "beyond the loads";
    EXPECT_THAT(points_of(swept("6, 30", "clamping.safety = 1.3\n"), "torque limit"), testing::IsEmpty()) << "the clamping force follows";
}

TEST_F(Maps, TheTorqueLimitOfALoadBelowZeroIsBelowZero) {
    const std::vector<Point> above = points_of(swept("6, 30"), "torque limit"), below = points_of(swept("-30, -6"), "torque limit");
    ASSERT_EQ(below.size(), above.size());
    for (std::size_t k = 0; k < above.size(); ++k) EXPECT_DOUBLE_EQ(below[k].x, -above[k].x);
}

/// The axes end where the cases do, although the line continues.
TEST_F(Maps, TheTorqueLimitSetsNoEnds) {
    const Plot plot = swept("6, 17");
    const auto line = std::ranges::find(plot.series, "torque limit", &Series::name);
    ASSERT_NE(line, plot.series.end());
    EXPECT_GT(line->points[1].x, 17.0);
    Plot without = plot;
    std::erase_if(without.series, [](const Series& series) { return series.name == "torque limit"; });
    const auto ticks = [](const std::string& svg) {
        return svg.substr(svg.find("class=\"x\""), svg.rfind("class=\"x\"") - svg.find("class=\"x\""));
    };
    EXPECT_EQ(ticks(svg(plot)), ticks(svg(without)));
}

TEST_F(Maps, MarkVerifiedCases) {
    const std::string cases = "\nok,10,1,0.1,nan,1\nok,20,1,0.2,0.03,1\nok,10,2,0.3,nan,1\nok,20,2,0.4,nan,1\n";
    write("cases.csv", "status,load_torque,start_ratio,slip_mean,error_of_slip_mean,wall" + cases);
    const std::vector<Point> marked = points_of(map("cases.csv"), "verified");
    ASSERT_EQ(marked.size(), 1U);
    EXPECT_EQ(marked[0].x, 20.0);
    EXPECT_EQ(marked[0].y, 1.0);
    write("cases.csv", "status,load_torque,start_ratio,slip_mean,error_of_slip_mean,settled_for" + cases);
    EXPECT_THAT(points_of(map("cases.csv"), "verified"), testing::IsEmpty()) << "errors of means that are steady";
}

}  // namespace
}  // namespace cvtflow::tools
