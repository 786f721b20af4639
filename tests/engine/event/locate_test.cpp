#include "engine/event/interpolant.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>

namespace cvtflow::engine {
namespace {

using Gap = std::function<double(double)>;

Crossing locate_in(const Gap& gap, double lo, double hi, double tolerance) { return locate(gap, lo, hi, gap(lo), gap(hi), tolerance); }

int max_evaluations(double width, double tolerance) { return static_cast<int>(std::ceil(std::log2(width / tolerance))) + 2; }

/// The promise: new sign at the answer, root within the tolerance before it, bounded effort.
void expect_located(const Gap& gap, double lo, double hi, double root, double tolerance) {
    const Crossing crossing = locate_in(gap, lo, hi, tolerance);
    EXPECT_GT(gap(crossing.theta) * gap(hi), 0.0) << "root " << root;
    EXPECT_GE(crossing.theta, root);
    EXPECT_LE(crossing.theta - root, tolerance * (1.0 + 1e-12));
    EXPECT_LE(crossing.evaluations, max_evaluations(hi - lo, tolerance)) << "root " << root;
}

TEST(Locate, RootsOfPolynomialsAreFoundToTheTolerance) {
    for (const double tolerance : {1e-3, 1e-6, 1e-12}) {
        for (const double root : {0.001, 0.25, 0.7, 0.999}) {
            expect_located([=](double x) { return x - root; }, 0.0, 1.0, root, tolerance);
            expect_located([=](double x) { return root - x; }, 0.0, 1.0, root, tolerance);
            expect_located([=](double x) { return (x - root) * (x + 1.0) * (x + 3.0); }, 0.0, 1.0, root, tolerance);
            expect_located([=](double x) { return (x - root) * (x - root) * (x - root); }, 0.0, 1.0, root, tolerance);
        }
    }
}

TEST(Locate, BracketsNeedNotBeginAtZero) {
    expect_located([](double x) { return 2.0 - x * x; }, 1.25, 2.0, std::sqrt(2.0), 1e-9);
}

TEST(Locate, NearlyDoubleRootsAreSeparated) {
    const auto gap = [](double x) { return (x - 0.5) * (x - 0.5) - 1e-10; };
    expect_located(gap, 0.0, 0.5, 0.5 - 1e-5, 1e-8);
    expect_located(gap, 0.5, 1.0, 0.5 + 1e-5, 1e-8);
}

TEST(Locate, SimpleRootsCostAHandfulOfEvaluations) {
    const auto gap = [](double x) { return std::exp(x) - 1.7; };
    EXPECT_LE(locate_in(gap, 0.0, 1.0, 1e-9).evaluations, 8);
}

TEST(Locate, JumpsAndFlatFunctionsAreLocatedToo) {
    expect_located([](double x) { return x < 0.3 ? -1.0 : 1e9; }, 0.0, 1.0, 0.3, 1e-9);
    expect_located([](double x) { return std::pow(x - 0.3, 21.0); }, 0.0, 1.0, 0.3, 1e-5);
}

TEST(Locate, AZeroIsNotYetTheNewSign) {
    const auto gap = [](double x) { return std::max(0.0, x - 0.5); };
    const Crossing crossing = locate_in(gap, 0.0, 1.0, 1e-9);
    EXPECT_GT(gap(crossing.theta), 0.0);
    EXPECT_NEAR(crossing.theta, 0.5, 1e-9);
}

TEST(Locate, TerminatesOnNoiseWithTheNewSign) {
    std::uint64_t state = 1;
    double last_positive = 1.0;
    const auto noise = [&](double x) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        const bool positive = (state >> 63) != 0;
        if (positive) last_positive = x;
        return positive ? 1e-3 : -1e-3;
    };
    for (int run = 0; run < 200; ++run) {
        last_positive = 1.0;
        const Crossing crossing = locate(noise, 0.0, 1.0, -1.0, 1.0, 1e-10);
        EXPECT_EQ(crossing.theta, last_positive);
        EXPECT_LE(crossing.evaluations, max_evaluations(1.0, 1e-10));
    }
}

TEST(Locate, TerminatesOnNotANumber) {
    const auto gap = [](double x) { return x < 0.8 ? std::nan("") : 1.0; };
    const Crossing crossing = locate(gap, 0.0, 1.0, -1.0, 1.0, 1e-6);
    EXPECT_NEAR(crossing.theta, 0.8, 1e-6);
    EXPECT_LE(crossing.evaluations, max_evaluations(1.0, 1e-6));
}

TEST(Locate, TerminatesAtZeroTolerance) {
    const Crossing crossing = locate_in([](double x) { return x - 0.3; }, 0.0, 1.0, 0.0);
    EXPECT_NEAR(crossing.theta, 0.3, 1e-15);
    EXPECT_GT(crossing.theta, 0.3);
}

TEST(Locate, WithoutASignChangeTheAnswerIsTheEnd) {
    for (const double at_end : {1.0, 0.0, std::nan("")}) {
        const Crossing crossing = locate([](double) { return 1.0; }, 0.0, 1.0, 1.0, at_end, 1e-6);
        EXPECT_EQ(crossing.theta, 1.0);
        EXPECT_EQ(crossing.evaluations, 0);
    }
}

}  // namespace
}  // namespace cvtflow::engine
