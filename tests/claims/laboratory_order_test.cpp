/// Claims about methods of the laboratory on smooth motions of the variator: the linearly implicit ones and the trapezoidal rule have their
/// order, with the whole state (chain and elastic pulleys).

#include <gtest/gtest.h>

#include <cmath>

#include "tasks/method/method.hpp"
#include "tests/claims/method_trial_fixture.hpp"
#include "tests/claims/rig_fixture.hpp"

namespace cvtflow::claims {
namespace {

/// Slopes of the error over these numbers of steps in the span, against 512 steps of rk4.
void expect_order(const Smooth& scene, const std::string& method, const std::vector<int>& numbers) {
    const tasks::FrozenStart start{0.0, scene.state, scene.phases};
    const auto solution = [&](const std::string& name, int steps) {
        const bench::TrialEnd end = bench::try_method(scene.parameters, start, name, smooth_span / steps, smooth_span);
        EXPECT_FALSE(end.fault) << name;
        EXPECT_EQ(end.counters.truncated, 0);
        return end.state;
    };
    static const std::vector<double> nothing;
    const std::vector<double> reference = solution("rk4", 512);
    double above = 0.0;
    for (const int steps : numbers) {
        const double error = distance(solution(method, steps), reference);
        if (above > 0.0) {
            EXPECT_NEAR(std::log2(above / error), tasks::find_program(method)->order, 0.15)
                << method << ": " << steps << " steps, error " << error;
        }
        above = error;
    }
}

TEST(ImplicitOrder, OnAChainClampedBetweenElasticSheaves) {
    const Smooth scene = clamped_ring();
    for (const char* method : {"trapezoidal-analytic", "sw2", "w-x2", "ros34pw2", "w-x3"}) expect_order(scene, method, {48, 96, 192});
}

TEST(ImplicitOrder, OnAFreeRing) {
    const Smooth scene = disturbed_ring();
    for (const char* method : {"trapezoidal-analytic", "sw2", "ros34pw2"}) expect_order(scene, method, {48, 96, 192});
}

}  // namespace
}  // namespace cvtflow::claims
