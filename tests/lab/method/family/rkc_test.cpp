#include "bench/method/family/rkc.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <string>

#include "bench/method/analysis/order.hpp"
#include "bench/method/analysis/plan_check.hpp"
#include "bench/method/analysis/stability.hpp"
#include "engine/method/catalogue.hpp"
#include "tests/engine/method/plan_fixture.hpp"

namespace cvtflow::bench {
namespace {

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

TEST(Rkc, NamesWithDampingGiveThePlanByValue) {
    const std::optional<StagePlan> plan = make_method("rkc-s37-e10");
    ASSERT_TRUE(plan);
    EXPECT_EQ(plan->name, "rkc-s37-e10");
    EXPECT_EQ(plan->stages, rkc(37, 10.0).stages);
    EXPECT_EQ(rkc(37, 0.5).name, "rkc-s37-e0.5");
    EXPECT_EQ(make_method("rkc-s37-e0.5")->stages, rkc(37, 0.5).stages);
    EXPECT_EQ(make_method("rkc-s37")->stages, rkc(37).stages);
    EXPECT_EQ(make_method("rk4")->stages, find_method("rk4")->stages);
    EXPECT_EQ(find_method("rkc-s37-e10"), nullptr);
}

TEST(Rkc, OtherNamesGiveNothing) {
    for (const char* name : {"rkc", "rkc-s", "rkc-s1", "rkc-s401", "rkc-s-5", "rkc-s20x", "rkc-s20-e", "rkc-s20-ex", "rkc-s20-e-1",
                             "rkc-s20-e101", "rkc-s20-e1x", "rkc-s99999999999", "rkc-s20-einf", "rkc-s20-enan", "RKC-s20", ""}) {
        EXPECT_FALSE(make_method(name)) << name;
        EXPECT_EQ(find_method(name), nullptr) << name;
    }
    EXPECT_THROW((void)rkc(1), std::invalid_argument);
    EXPECT_THROW((void)rkc(401), std::invalid_argument);
    EXPECT_THROW((void)rkc(10, -1.0), std::invalid_argument);
    EXPECT_THROW((void)rkc(10, std::nan("")), std::invalid_argument);
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

/// The estimate 0.8 (y - y') + 0.4 h (f + f') is h³ y'''/15 where y' is exact, and the local error is as much. From the method's own y' it
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
