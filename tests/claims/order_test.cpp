/// Claim: on smooth motions of the variator the classical Runge-Kutta method converges with its order, 4.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/claims/rig_fixture.hpp"

namespace cvtflow::claims {
namespace {

std::vector<double> solution(const Smooth& scene, double step) {
    Rig rig(scene.parameters, scene.state, scene.phases);
    EXPECT_FALSE(rig.run({0.0, smooth_span, step, smooth_span}));
    EXPECT_EQ(rig.counters().truncated, 0);
    return rig.state_copy();
}

void expect_fourth_order(const Smooth& scene) {
    const std::vector<double> reference = solution(scene, smooth_span / 256);  // its error is 4⁴ times smaller than that of the finest
    std::vector<double> errors;
    for (const int steps : {8, 16, 32, 64}) errors.push_back(distance(solution(scene, smooth_span / steps), reference));
    for (std::size_t k = 1; k < errors.size(); ++k) {
        EXPECT_NEAR(std::log2(errors[k - 1] / errors[k]), 4.0, 0.25) << "errors " << errors[k - 1] << " and " << errors[k];
    }
}

TEST(Rk4, ConvergesWithOrderFourOnAFreeRing) { expect_fourth_order(disturbed_ring()); }
TEST(Rk4, ConvergesWithOrderFourOnAChainClampedBetweenElasticSheaves) { expect_fourth_order(clamped_ring()); }

}  // namespace
}  // namespace cvtflow::claims
