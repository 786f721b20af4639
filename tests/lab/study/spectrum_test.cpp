/// The fastest eigenvalues of the variator's Jacobian, found without all the others.

#include "bench/study/spectrum.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/method/analysis/eigenvalues.hpp"
#include "tasks/scene/scene.hpp"
#include "tests/lab/study/brief_fixture.hpp"

namespace cvtflow::bench {

using namespace tasks;
namespace {

TEST(Attribution, CountsBandsAndGrowth) {
    const Extent extent = extent_of({-2e7, -5e6, {-1e3, 4e5}, {-1e3, -4e5}, 0.0, 50.0, 200.0});
    EXPECT_EQ(extent.decay, 2e7);
    EXPECT_EQ(extent.oscillation, 4e5);
    EXPECT_EQ(extent.below_1e6, 2);
    EXPECT_EQ(extent.below_1e7, 1);
    EXPECT_EQ(extent.growing, 1);
    EXPECT_EQ(extent.growth, 200.0);
}

TEST(Attribution, OfFrictionOfOneKindGivesThatKindEverything) {
    for (int kind = 0; kind < contact_kind_count; ++kind) {
        model::Parameters alone = brief_scene().parameters;
        for (int other = 0; other < contact_kind_count; ++other) {
            if (other != kind) contact_kinds()[static_cast<std::size_t>(other)].friction(alone).coefficient = 0.0;
        }
        const Attribution found = attribute(alone, brief_start(), -2e5, {});
        ASSERT_FALSE(found.values.empty()) << kind;
        // -d without springs; with them λ² + d λ + ω² = 0, whose fast root has a share of d/sqrt(d² - 4 ω²) > 1.
        EXPECT_EQ(found.main_kind(0), kind);
        EXPECT_GT(found.shares[0][static_cast<std::size_t>(kind)], 0.8);
        for (std::size_t k = 0; k < found.values.size(); ++k) {
            for (int other = 0; other < contact_kind_count; ++other) {
                if (other == kind) continue;
                EXPECT_NEAR(found.shares[k][static_cast<std::size_t>(other)], 0.0, 1e-6) << found.values[k];
            }
        }
    }
}

TEST(Attribution, SharesOfStiffEigenvaluesSumToOne) {
    const Attribution found = attribute(brief_scene().parameters, brief_start(), -1e6, {});
    ASSERT_FALSE(found.values.empty());
    const auto& largest = found.shares.front();
    EXPECT_NEAR(largest[0] + largest[1] + largest[2], 1.0, 0.1);
}

TEST(Attribution, TriesKindsAloneAndOneAfterTheOther) {
    std::vector<std::string> activities;
    const Attribution found =
        attribute(brief_scene().parameters, brief_start(), -1e6, [&](const std::string& what) { activities.push_back(what); });
    std::vector<std::string> contacts;
    for (const SlowedSpectrum& slowed : found.slowed) contacts.push_back(slowed.contacts);
    EXPECT_THAT(contacts, testing::ElementsAre("", "joints", "plates", "tips", "joints, plates", "joints, plates, tips"));
    EXPECT_EQ(activities.size(), 9u);
    EXPECT_LT(extent_of(found.slowed.back().values).decay, 0.25 * extent_of(found.slowed.front().values).decay);
}

using Complex = std::complex<double>;

/// The Jacobian of the smallest scene after a millisecond of settling.
std::vector<double> jacobian_of_tiny() {
    const FrozenStart& start = brief_start();
    return jacobian(model::Variator(brief_scene().parameters), start.time, start.state, start.phases);
}

TEST(SpectrumEdge, OfTheVariatorIsThoseOfTheDenseMethod) {
    const std::vector<double> matrix = jacobian_of_tiny();
    const int size = static_cast<int>(brief_start().state.size());
    const bench::Eigenvalues all = bench::eigenvalues(matrix, size);
    const double border = -3e5;
    const bench::ExtremalEigenvalues edge = bench::extremal_eigenvalues(matrix, size, {.left_of = border, .progress = {}});
    const auto left = std::count_if(all.begin(), all.end(), [&](const Complex& value) { return value.real() < border; });
    const auto found = std::count_if(edge.values.begin(), edge.values.end(), [&](const Complex& value) { return value.real() < border; });
    EXPECT_GT(left, 20);
    EXPECT_EQ(found, left);
    for (int k = 0; k < left; ++k)
        EXPECT_LT(std::abs(edge.values[static_cast<std::size_t>(k)] - all[static_cast<std::size_t>(k)]),
                  1e-5 * std::abs(all[static_cast<std::size_t>(k)]))
            << k;
    const auto fastest = [](const bench::Eigenvalues& values) {
        double frequency = 0.0;
        for (const Complex& value : values) frequency = std::max(frequency, std::abs(value.imag()));
        return frequency;
    };
    EXPECT_NEAR(fastest(edge.values) / fastest(all), 1.0, 1e-5);
}

}  // namespace

}  // namespace cvtflow::bench
