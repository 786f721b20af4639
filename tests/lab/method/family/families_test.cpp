#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <string>

#include "bench/method/analysis/order.hpp"
#include "bench/method/analysis/stability.hpp"
#include "bench/method/family/families.hpp"
#include "bench/method/family/fitted.hpp"
#include "bench/method/family/near_optimal.hpp"
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

/// The grids are much finer than the points of the fit.
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

TEST(NearOptimal, IsStableOnItsIntervalOfEightyOneHundredthsDegreeSquared) {
    for (const int degree : {5, 6, 7, 10, 20, 50, 100, 400}) {
        const NearOptimalPolynomial p = near_optimal_polynomial(degree);
        const double length = p.real_length(), square = degree * degree;
        EXPECT_GT(length / square, degree < 8 ? 0.77 : 0.79) << degree;
        EXPECT_LT(length / square, 0.82) << degree;  // 0.8222 is the optimum without damping
        long double largest = 0.0L, ripple = 0.0L;
        for (int i = 1; i <= 4000; ++i) {
            const long double z = -length * i / 4000;
            largest = std::max(largest, std::abs(p.value(z)));
            if (z < -0.2 * length) ripple = std::max(ripple, std::abs(p.value(z)));
        }
        EXPECT_LE(largest, 1.0L) << degree;
        EXPECT_LT(ripple, degree < 10 ? 0.99L : 0.97L) << degree;  // damped: 0.985 for degree 5, 0.964 for many
    }
}

TEST(NearOptimal, MethodsAreOfOrderTwoToTheLastDigits) {
    for (const char* name : {"serk2-s10", "serk2-s60", "serk2-s250"}) {
        const StagePlan plan = *make_method(name);
        EXPECT_EQ(order_of(plan, 5e-13), 2) << name;
        EXPECT_LE(time_defect(unroll(plan)), 5e-13) << name;
    }
}

TEST(NearOptimal, StabilityFunctionIsThePolynomial) {
    const NearOptimalPolynomial p = near_optimal_polynomial(20);
    for (const double z : {-0.5, -7.0, -100.0, -300.0}) {
        EXPECT_NEAR(stability_function(*make_method("serk2-s20"), z).real(), static_cast<double>(p.value(z)), 1e-10) << z;
    }
}

TEST(Rkc, EveryNumberOfStagesHasItsName) {
    for (int stages = min_rkc_stages; stages <= max_rkc_stages; ++stages) {
        const std::string name = "rkc-s" + std::to_string(stages);
        const std::optional<StagePlan> plan = rkc_by_name(name);
        ASSERT_TRUE(plan) << name;
        EXPECT_EQ(plan->name, name);
        EXPECT_NO_THROW(validate(*plan)) << name;
        EXPECT_EQ(plan->stages.size(), static_cast<std::size_t>(stages) + 1);
    }
}

TEST(Rkc, IsOfOrderTwoWhateverItsStages) {
    for (const int stages : {2, 3, 4, 5, 10, 37, 100, 400}) {
        for (const double damping : {0.0, rkc_damping, 10.0}) {
            const StagePlan plan = rkc(stages, damping);
            const Tableau tableau = unroll(plan);
            EXPECT_EQ(order_of(tableau, tableau.weights, 1e-10), 2) << plan.name;
            EXPECT_LE(time_defect(tableau), 1e-11) << plan.name;
        }
    }
}

/// Lengths per stages²; reach along the ray of damping ratio 1 % grows with ε. Survey of methods.
TEST(Rkc, DampingTradesLengthForWidth) {
    const std::complex<double> ray{-0.01, std::sqrt(1.0 - 1e-4)};
    const std::vector<std::array<double, 3>> known{{rkc_damping, 0.653, 0.67}, {10.0, 0.35, 0.91}, {20.0, 0.27, 1.03}};
    for (const auto& [damping, length, reach] : known) {
        const StagePlan plan = rkc(40, damping);
        EXPECT_NEAR(real_stability(plan) / 1600.0, length, 0.02 * length) << plan.name;
        EXPECT_NEAR(stability_reach(plan, ray, 1e-9), reach, 0.02 * reach) << plan.name;
    }
}

/// The estimate 0.8 (y - y') + 0.4 h (f + f') is h³ y'''/15 where y' is exact, and the local error is as much. From the y' of the method it
/// is 0.12 h³ y''': almost twice the error, on the safe side. Both for many stages: b·c² → 1/5.
TEST(Rkc, ErrorEstimateIsNearlyTwiceTheLocalError) {
    const Tableau tableau = unroll(rkc(50));
    double result = 0.0, embedded = 0.0;
    for (std::size_t j = 0; j < tableau.times.size(); ++j) {
        result += tableau.weights[j] * tableau.times[j] * tableau.times[j];
        embedded += tableau.embedded[j] * tableau.times[j] * tableau.times[j];
    }
    EXPECT_NEAR(0.5 * (1.0 / 3.0 - result), 1.0 / 15.0, 2e-3);
    EXPECT_NEAR(0.5 * (result - embedded), 0.12, 2e-3);
}

}  // namespace
}  // namespace cvtflow::bench
