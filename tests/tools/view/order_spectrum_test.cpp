#include "tools/program/view/order_lines.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cvtflow::tools {
namespace {

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
