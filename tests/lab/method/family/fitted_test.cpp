#include "bench/method/family/fitted.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "bench/method/analysis/order.hpp"
#include "bench/method/analysis/stability.hpp"
#include "bench/method/family/chebyshev_basis.hpp"
#include "engine/method/catalogue.hpp"

namespace cvtflow::bench {
namespace {

FitRequest region(double real, double imaginary, double ripple = 0.2, int order = 3) { return {real, imaginary, order, ripple, 0.01}; }

/// Stages found by linear programming in a survey of these polynomials, for real 1e8 h and imaginary 1e6 h; this fit needs as many or less.
TEST(Fitted, NeedsAsFewStagesAsKnown) {
    const std::vector<std::array<double, 4>> known{{100, 1, 0.5, 16}, {100, 1, 0.2, 18}, {200, 2, 0.5, 22}, {200, 2, 0.2, 25},
                                                   {300, 3, 0.2, 30}, {400, 4, 0.2, 38}, {600, 6, 0.2, 52}};
    for (const auto& [real, imaginary, ripple, stages] : known) {
        const auto fitted = fit(region(real, imaginary, ripple));
        ASSERT_TRUE(fitted);
        EXPECT_LE(static_cast<double>(fitted->plan.stages.size()) - 1.0, stages) << real;
        EXPECT_GE(static_cast<double>(fitted->plan.stages.size()) - 1.0, stages - 2.0) << real;
        EXPECT_LE(fitted->largest, 1.0) << real;
    }
}

/// On grids much finer than the points of the fit.
TEST(Fitted, IsStableWhereItWasAskedTo) {
    for (const double h : {1.0, 2.0, 3.0, 4.0}) {
        const StagePlan plan = fit(region(100.0 * h, h))->plan;
        double largest = 0.0, ripple = 0.0;
        for (int i = 1; i <= 4000; ++i) {
            const double z = -102.0 * h * i / 4000;
            const double value = std::abs(stability_function(plan, z));
            largest = std::max(largest, value);
            if (z < -4.1) ripple = std::max(ripple, value);
        }
        for (int ray = 0; ray < 40; ++ray) {
            const double angle = std::acos(0.01) * (1.0 - ray / 40.0);
            for (int i = 1; i <= 100; ++i)
                largest = std::max(largest, std::abs(stability_function(plan, std::polar(h * i / 100, std::numbers::pi - angle))));
        }
        EXPECT_LE(largest, 1.0 + 1e-7) << h;
        EXPECT_LE(ripple, 1.05 * 0.2) << h;
        EXPECT_LE(stage_growth(plan, 100.0 * h), 1.01) << h;
        // As little as the recurrence itself, which is RKC's: a small multiple of the stages.
        EXPECT_LE(perturbation_gain(plan, 100.0 * h), 1.4 * static_cast<double>(plan.stages.size())) << h;
    }
}

TEST(Fitted, OrderThreeHoldsNearly) {
    const StagePlan plan = fit(region(200.0, 2.0))->plan;
    const Tableau tableau = unroll(plan);
    EXPECT_EQ(order_of(tableau, tableau.weights, 1e-5), 3);
    EXPECT_EQ(order_of(fit(region(200.0, 2.0, 0.2, 2))->plan), 2);
    EXPECT_LE(time_defect(tableau), 1e-13);
}

/// Elasticity alone decides: steps of a lightly loaded chain.
TEST(Fitted, WideRegionsCanBeMetToo) {
    for (const auto& [real, imaginary] : {std::pair{18.4, 4.88}, {5.0, 3.0}, {40.0, 6.0}}) {
        const auto fitted = fit(region(real, imaginary));
        ASSERT_TRUE(fitted) << real;
        EXPECT_LE(fitted->plan.stages.size(), 65u) << real;
        RecordProperty("stages_for_" + std::to_string(imaginary), std::to_string(fitted->plan.stages.size() - 1));
    }
}

/// A list of eigenvalues instead of a region: oscillations without damping, which the region would not cover.
TEST(Fitted, FollowsAListOfEigenvalues) {
    std::vector<std::complex<double>> points;
    for (int i = 1; i <= 50; ++i) points.emplace_back(0.0, 0.04 * i);
    for (int i = 1; i <= 50; ++i) points.emplace_back(-3.0 * i, 0.0);
    const auto fitted = fit(region(150.0, 2.0), points);
    ASSERT_TRUE(fitted);
    for (const auto& z : points) EXPECT_LE(std::abs(stability_function(fitted->plan, z)), 1.0 + 1e-9) << z.real() << ' ' << z.imag();
}

TEST(NightlyFitted, TakesMilliseconds) {
    const auto started = std::chrono::steady_clock::now();
    ASSERT_TRUE(fit(region(200.0, 2.0)));
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    RecordProperty("milliseconds", std::to_string(1e3 * seconds));
    EXPECT_LT(seconds, 2.0) << "50 ms on a free core";
}

TEST(Fitted, HasNames) {
    EXPECT_EQ(make_method("fitted-l200-w2")->stages, fit(region(200.0, 2.0))->plan.stages);
    EXPECT_EQ(make_method("fitted-l200-w2-s30")->stages.size(), 31u);
    EXPECT_EQ(make_method("fitted-w2-l200-r0.5-p2")->stages, fit(region(200.0, 2.0, 0.5, 2))->plan.stages);
    for (const char* name :
         {"fitted", "fitted-l200", "fitted-w2", "fitted-l200-w2-s12", "fitted-l200-w2-s3", "fitted-l200-w2-p4", "fitted-l1-w1",
          "fitted-l200-w2-r0", "fitted-l200-w2-l200", "fitted-l200-w2-x1", "fitted-l1e2-w2", "fitted-linf-w2"})
        EXPECT_FALSE(make_method(name)) << name;
    EXPECT_THROW((void)fit(region(1.0, 1.0)), std::invalid_argument);
    EXPECT_THROW((void)fit(region(200.0, 2.0), 3), std::invalid_argument);
}

/// The basis: consistent of order 2 but for Y_1, bounded by 1 on its interval.
TEST(ChebyshevBasis, DerivativesAreThoseOfItsStages) {
    const ChebyshevBasis basis(12, 60.0);
    std::vector<std::complex<double>> at(13), below(13), above(13);
    basis.evaluate(0.0, at);
    basis.evaluate(-1e-3, below);
    basis.evaluate(1e-3, above);
    for (int j = 0; j <= 12; ++j) {
        const auto i = static_cast<std::size_t>(j);
        EXPECT_DOUBLE_EQ(at[i].real(), 1.0);
        EXPECT_NEAR(basis.derivative(j, 1), (above[i].real() - below[i].real()) / 2e-3, 1e-6);
        EXPECT_NEAR(basis.derivative(j, 2), (above[i].real() - 2.0 * at[i].real() + below[i].real()) / 1e-6, 1e-5);
        if (j > 1) {
            EXPECT_NEAR(basis.derivative(j, 2), basis.derivative(j, 1) * basis.derivative(j, 1), 1e-12);
        }
    }
}

}  // namespace
}  // namespace cvtflow::bench
