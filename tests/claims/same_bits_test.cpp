/// Claim: at every level of detail results are the same bits whatever segments, schedule and threads.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/claims/operating_point_fixture.hpp"
#include "tests/claims/rig_fixture.hpp"

namespace cvtflow::claims {
namespace {

/// The state after a short geometric start, with transitions in it.
std::vector<double> final_state(const tasks::Scene& scene) {
    tasks::Simulation simulation(scene);
    tasks::SilentObserver silent;
    const engine::Cancellation never;
    EXPECT_FALSE(simulation.advance({.until = 0.0}, silent, never));
    EXPECT_GT(simulation.counters().detected, 0);
    EXPECT_FALSE(simulation.advance({.until = scene.run.until}, silent, never));
    return {simulation.workspace().state(), simulation.workspace().state() + simulation.workspace().layout().size()};
}

class SameBits : public testing::TestWithParam<std::string> {};

TEST_P(SameBits, WhateverTheSegmentsAndExecutor) {
    for (const auto& [method, step] : {std::pair{"rk4", "50ns"}, {"leapfrog-chebyshev", "500ns"}}) {
        const auto run = [&method = method, &step = step](const std::string& segments, const std::string& schedule,
                                                          const std::string& threads) {
            tasks::Scene scene =
                scene_at_level("tiny", GetParam(), {"run.until=200us", "start.settling_time=300us", "start.ramp_time=300us"});
            tasks::set_values(scene, std::vector<std::string>{std::string("run.method=") + method, std::string("run.step=") + step,
                                                              "detail.stick_slip=true", "run.segments=" + segments,
                                                              "run.schedule=" + schedule, "run.threads=" + threads});
            return final_state(scene);
        };
        const std::vector<double> one = run("1", "serial", "1");
        for (const std::string segments : {"2", "5", "9"}) EXPECT_EQ(run(segments, "serial", "1"), one) << method << ", " << segments;
        EXPECT_EQ(run("4", "flow", "2"), one) << method;
    }
}

INSTANTIATE_TEST_SUITE_P(Cheapest, SameBits, testing::Values(levels().front()), [](const auto& level) { return level.param; });
INSTANTIATE_TEST_SUITE_P(DeepEveryLevel, SameBits, testing::ValuesIn(levels()), [](const auto& level) { return level.param; });

}  // namespace
}  // namespace cvtflow::claims
