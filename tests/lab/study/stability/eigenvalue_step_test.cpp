#include "bench/study/stability/eigenvalue_step.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "bench/method/analysis/stability.hpp"
#include "engine/method/catalogue.hpp"

namespace cvtflow::bench {
namespace {

using Values = std::vector<std::complex<double>>;

TEST(StableStep, IsTheReachOfTheRegionOverASingleEigenvalue) {
    for (const char* name : {"rk4", "heun", "dopri54", "dumka3-p3", "dumka3-p5", "rkc-s10"}) {
        const engine::StagePlan& plan = *engine::find_method(name);
        // The growth that is tolerated makes it a little longer; |R| rises by much more than 1e-4 per 0.1 %.
        const StableStep real = largest_stable_step(plan, Values{-1e7});
        EXPECT_NEAR(real.step * 1e7 / bench::real_stability(plan), 1.0, 1e-3) << name;
        EXPECT_EQ(real.limiting, std::complex<double>(-1e7));
    }
    const StableStep spring = largest_stable_step(*engine::find_method("rk4"), Values{{0.0, -1e6}, {0.0, 1e6}});
    EXPECT_NEAR(spring.step * 1e6, std::sqrt(8.0), 1e-3);
    EXPECT_EQ(spring.limiting, std::complex<double>(0.0, 1e6));
}

TEST(StableStep, IsLimitedByTheEigenvalueThatLeavesFirst) {
    // rk4 reaches 2.785 on the real axis and 2.828 on the imaginary one.
    const StableStep decay = largest_stable_step(*engine::find_method("rk4"), Values{-1e6, {0.0, 0.9e6}, {0.0, -0.9e6}, -5e5, 0.0});
    EXPECT_EQ(decay.limiting, std::complex<double>(-1e6));
    const StableStep spring = largest_stable_step(*engine::find_method("rk4"), Values{-1e6, {0.0, 1.1e6}, {0.0, -1.1e6}});
    EXPECT_EQ(spring.limiting, std::complex<double>(0.0, 1.1e6));
}

TEST(StableStep, OfEulersMethodOnADampedOscillationIsTwiceDampingOverSquare) {
    // |1 + h λ| ≤ 1 for h ≤ -2 Re λ/|λ|²; frequencies so low that 100 1/s of growth would be tolerated at much longer steps are not tested.
    const std::complex<double> value(-2e4, 1e6);
    const double step = largest_stable_step(*engine::find_method("euler"), Values{value}).step;
    EXPECT_NEAR(step / (2.0 * 2e4 / std::norm(value)), 1.0, 0.01);
}

TEST(StableStep, ForgivesWhatGrowsByItself) {
    const engine::StagePlan& rk4 = *engine::find_method("rk4");
    EXPECT_NEAR(largest_stable_step(rk4, Values{-1e6, 5e3}).step, largest_stable_step(rk4, Values{-1e6}).step, 1e-12);
}

TEST(StableStep, WithoutEigenvaluesIsNotDefined) {
    EXPECT_THROW((void)largest_stable_step(*engine::find_method("rk4"), Values{}), std::invalid_argument);
    EXPECT_THROW((void)largest_stable_step(*engine::find_method("rk4"), Values{0.0}), std::invalid_argument);
}

TEST(StableStep, StabilityFunctionReadyForManyCallsIsTheSame) {
    const engine::StagePlan& plan = *engine::find_method("dumka3-p4");
    const auto factor = stability_function(plan);
    for (const std::complex<double> z : {std::complex<double>(-100.0), {-3.0, 2.0}, {0.0, 1.0}})
        EXPECT_EQ(factor(z), stability_function(plan, z));
}

}  // namespace
}  // namespace cvtflow::bench
