#include "bench/study/noise/noise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

namespace cvtflow::bench {
namespace {

/// Zwicker's critical bands are 100 Hz wide at low frequencies, 160 Hz at 1 kHz and 700 Hz at 4 kHz.
TEST(Tonality, CriticalBandsAreTheEars) {
    EXPECT_NEAR(critical_bandwidth(100.0), 100.0, 1.0);
    EXPECT_NEAR(critical_bandwidth(1000.0), 160.0, 5.0);
    EXPECT_NEAR(critical_bandwidth(4000.0), 700.0, 15.0);
}

/// A flat spectrum has the ratio of bandwidths, which grow with frequency: less than 1 dB. A line alone is bounded by the background.
TEST(Tonality, FlatSpectraHaveNoneAndLinesAll) {
    OrderPowers powers(421, 1.0);
    EXPECT_NEAR(tonality(powers, 16.7, 84), 0.0, 1.0);
    powers.assign(421, 0.0);
    EXPECT_EQ(tonality(powers, 16.7, 84), 0.0);
    powers[84] = 3.0;
    EXPECT_NEAR(tonality(powers, 16.7, 84), -10.0 * std::log10(background), 1e-9);
}

/// A line on flat noise: its band has the line and 13 orders of noise, its neighbours the noise alone.
TEST(Tonality, IsTheRatioOfBands) {
    OrderPowers powers(421, 1.0);
    const double alone = tonality(powers, 16.7, 84), orders = critical_bandwidth(84 * 16.7) / 16.7;
    powers[84] = 1.0 + 9.0 * orders;
    EXPECT_NEAR(tonality(powers, 16.7, 84), 10.0, 1.0);
    EXPECT_LT(alone, 1.0);
}

/// Lines 20 dB weaker than the strongest band do not count, however lonely.
TEST(Tonality, WeakLinesDoNotCount) {
    OrderPowers powers(421, 0.0);
    for (std::size_t n = 60; n < 110; ++n) powers[n] = 1.0;
    const double without = tonality(powers, 16.7, 84);
    powers[252] = 1e-2;
    EXPECT_EQ(tonality(powers, 16.7, 84), without);
}

TEST(ImpulsePowers, OfAUniformChainAreItsHarmonics) {
    const OrderPowers powers = impulse_powers(PitchSequence(12, 0), 0.1, 36);
    for (std::size_t n = 0; n < powers.size(); ++n) EXPECT_NEAR(powers[n], n % 12 == 0 ? 1.0 : 0.0, 1e-15) << n;
}

/// The sum, written out.
TEST(ImpulsePowers, AreTheSumOverThePins) {
    const PitchSequence sequence{1, -1, -1, 1, 1, -1};
    const double spread = 0.07;
    const OrderPowers powers = impulse_powers(sequence, spread, 30);
    for (int n = 0; n <= 30; ++n) {
        std::complex<double> sum;
        for (std::size_t k = 0; k < sequence.size(); ++k) {
            const double steps = std::accumulate(sequence.begin(), sequence.begin() + static_cast<long>(k), 0.0);
            sum += std::exp(std::complex<double>(0.0, 2.0 * std::numbers::pi * n * (static_cast<double>(k) + spread * steps) / 6.0));
        }
        EXPECT_NEAR(powers[static_cast<std::size_t>(n)], std::norm(sum) / 36.0, 1e-12) << n;
    }
}

TEST(PitchSearch, KeepsTheLengthAndTheSeed) {
    for (const int lengths : {2, 3}) {
        PitchSearch search(24, lengths, 0.08, 16.7);
        search.weigh({PitchSequence(24, 0)}, {OrderPowers(121, 1.0)});
        std::mt19937_64 first(7), again(7), other(8);
        const PitchSequence sequence = search.random(first);
        EXPECT_EQ(sequence, search.random(again));
        EXPECT_NE(sequence, search.random(other));
        for (const int step : {-1, 1}) EXPECT_EQ(std::count(sequence.begin(), sequence.end(), step), 24 / lengths);
        const std::vector<double> pitches = pitches_of(sequence, 8e-3, 0.08);
        EXPECT_NEAR(std::accumulate(pitches.begin(), pitches.end(), 0.0), 24 * 8e-3, 1e-15);
    }
    EXPECT_THROW(PitchSearch(25, 2, 0.08, 16.7), std::invalid_argument);
}

/// A machine that responds linearly is learned exactly from two sequences, and the climb lowers what it expects.
TEST(PitchSearch, LearnsALinearResponseAndClimbs) {
    PitchSearch search(84, 2, 0.08, 16.7);
    std::mt19937_64 urn(3);
    const std::vector<PitchSequence> sequences{search.random(urn), search.random(urn)};
    const auto response = [](OrderPowers powers) {
        for (std::size_t n = 0; n < powers.size(); ++n) powers[n] *= 5.0 / (1.0 + std::pow(0.02 * static_cast<double>(n), 4.0));
        return powers;
    };
    std::vector<OrderPowers> powers;
    for (const PitchSequence& each : sequences) powers.push_back(response(impulse_powers(each, 0.08, 420)));
    search.weigh(sequences, powers);
    const PitchSequence third = search.random(urn);
    EXPECT_NEAR(search.expected(third), tonality(response(impulse_powers(third, 0.08, 420)), 16.7, 84), 1e-9);
    std::mt19937_64 begin(5), climbing(5);
    EXPECT_LT(search.expected(search.climb(climbing, 300)), search.expected(search.random(begin)) - 1.0);
}

TEST(RankCorrelation, OfKnownRanks) {
    EXPECT_DOUBLE_EQ(rank_correlation({1, 2, 3, 4}, {10, 20, 30, 400}), 1.0);
    EXPECT_DOUBLE_EQ(rank_correlation({1, 2, 3, 4}, {4, 3, 2, 1}), -1.0);
    EXPECT_NEAR(rank_correlation({1, 2, 3, 4, 5}, {2, 1, 4, 3, 5}), 1.0 - 6.0 * 4.0 / 120.0, 1e-15);
    EXPECT_EQ(rank_correlation({1, 2}, {1, 2}), 0.0);
}

}  // namespace
}  // namespace cvtflow::bench
