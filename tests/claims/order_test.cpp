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

TEST(Rk4, ConvergesWithOrderFourOnAFreeRingAndOnAChainClampedBetweenElasticSheaves) {
    for (const Smooth& scene : {disturbed_ring(), clamped_ring()}) {
        const std::vector<double> reference = solution(scene, smooth_span / 256);  // its error is 4⁴ times smaller than that of the finest
        double coarser = 0.0;
        for (const int steps : {8, 16, 32, 64}) {
            const double error = distance(solution(scene, smooth_span / steps), reference);
            if (steps > 8) {
                EXPECT_NEAR(std::log2(coarser / error), 4.0, 0.25) << "errors " << coarser << " and " << error;
            }
            coarser = error;
        }
    }
}

}  // namespace
}  // namespace cvtflow::claims
