#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/event/interpolant.hpp"

namespace cvtflow::engine {
namespace {

using Gap = std::function<double(double)>;

TEST(Interpolant, ErrorIsOfFourthOrder) {
    const auto worst = [](double h) {
        const double y0 = std::exp(0.3), y1 = std::exp(0.3 + h);
        const Interpolant interpolant{&y0, &y0, &y1, &y1, h};
        double error = 0.0;
        for (double theta = 0.0; theta <= 1.0; theta += 1.0 / 64.0) {
            double y = 0.0;
            interpolant.evaluate(theta, 0, 1, &y);
            error = std::max(error, std::abs(y - std::exp(0.3 + theta * h)));
        }
        return error;
    };
    for (const double h : {0.4, 0.2, 0.1}) EXPECT_NEAR(std::log2(worst(h) / worst(0.5 * h)), 4.0, 0.15) << h;
    // Theory: max of θ²(1-θ)² h⁴ y''''/24 = h⁴ y''''/384.
    EXPECT_NEAR(worst(0.1), 1e-4 * std::exp(0.35) / 384.0, 1e-9);
}

/// Interpolant over 37 unknowns of no particular meaning.
class Vectors : public testing::Test {
protected:
    Vectors() {
        for (int i = 0; i < 4; ++i) {
            for (int j = 0; j < 37; ++j) data_[i].push_back(std::sin(1.0 + 7.0 * i + 3.1 * j));
        }
    }
    [[nodiscard]] Interpolant interpolant() const { return {data_[0].data(), data_[1].data(), data_[2].data(), data_[3].data(), 0.3}; }
    std::vector<double> data_[4];
};

TEST_F(Vectors, EndsAreBitwiseThoseOfTheStep) {
    std::vector<double> out(37);
    interpolant().evaluate(0.0, 0, 37, out.data());
    EXPECT_EQ(out, data_[0]);
    interpolant().evaluate(1.0, 0, 37, out.data());
    EXPECT_EQ(out, data_[2]);
}

TEST_F(Vectors, AnySplitOfTheRangeGivesTheSameBits) {
    std::vector<double> whole(37);
    interpolant().evaluate(0.37, 0, 37, whole.data());
    for (int cut = 0; cut <= 37; ++cut) {
        std::vector<double> parts(37);
        interpolant().evaluate(0.37, 0, cut, parts.data());
        interpolant().evaluate(0.37, cut, 37, parts.data() + cut);
        for (std::size_t i = 0; i < 37; ++i) ASSERT_EQ(std::bit_cast<std::uint64_t>(parts[i]), std::bit_cast<std::uint64_t>(whole[i]));
    }
}

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

TEST(Locate, RootsAreFoundToTheTolerance) {
    for (const double tolerance : {1e-3, 1e-6, 1e-12}) {
        for (const double root : {0.001, 0.25, 0.7, 0.999}) {
            expect_located([=](double x) { return x - root; }, 0.0, 1.0, root, tolerance);
            expect_located([=](double x) { return root - x; }, 0.0, 1.0, root, tolerance);
            expect_located([=](double x) { return (x - root) * (x + 1.0) * (x + 3.0); }, 0.0, 1.0, root, tolerance);
            expect_located([=](double x) { return (x - root) * (x - root) * (x - root); }, 0.0, 1.0, root, tolerance);
        }
    }
    expect_located([](double x) { return 2.0 - x * x; }, 1.25, 2.0, std::sqrt(2.0), 1e-9);
    const auto nearly_double = [](double x) { return (x - 0.5) * (x - 0.5) - 1e-10; };
    expect_located(nearly_double, 0.0, 0.5, 0.5 - 1e-5, 1e-8);
    expect_located(nearly_double, 0.5, 1.0, 0.5 + 1e-5, 1e-8);
    expect_located([](double x) { return x < 0.3 ? -1.0 : 1e9; }, 0.0, 1.0, 0.3, 1e-9);
    expect_located([](double x) { return std::pow(x - 0.3, 21.0); }, 0.0, 1.0, 0.3, 1e-5);
}

TEST(Locate, SimpleRootsCostAHandfulOfEvaluations) {
    const auto gap = [](double x) { return std::exp(x) - 1.7; };
    EXPECT_LE(locate_in(gap, 0.0, 1.0, 1e-9).evaluations, 8);
}

TEST(Locate, AZeroIsNotYetTheNewSign) {
    const auto gap = [](double x) { return std::max(0.0, x - 0.5); };
    const Crossing crossing = locate_in(gap, 0.0, 1.0, 1e-9);
    EXPECT_GT(gap(crossing.theta), 0.0);
    EXPECT_NEAR(crossing.theta, 0.5, 1e-9);
}

TEST(Locate, TerminatesOnNoiseWithTheNewSignOnNotANumberAndAtZeroTolerance) {
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
    const Crossing none = locate([](double x) { return x < 0.8 ? std::nan("") : 1.0; }, 0.0, 1.0, -1.0, 1.0, 1e-6);
    EXPECT_NEAR(none.theta, 0.8, 1e-6);
    EXPECT_LE(none.evaluations, max_evaluations(1.0, 1e-6));
    const Crossing exact = locate_in([](double x) { return x - 0.3; }, 0.0, 1.0, 0.0);
    EXPECT_NEAR(exact.theta, 0.3, 1e-15);
    EXPECT_GT(exact.theta, 0.3);
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
