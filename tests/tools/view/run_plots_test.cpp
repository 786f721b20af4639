#include "tools/program/view/run_plots.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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

}  // namespace
}  // namespace cvtflow::tools
