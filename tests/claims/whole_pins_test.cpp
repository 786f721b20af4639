/// Claims about whole pins (EQUATIONS section 10): their results do not depend on segments, their energy balance closes, and they tell what
/// the model with halves tells.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/claims/operating_point_fixture.hpp"

namespace cvtflow::claims {
namespace {

const engine::Cancellation never;

struct Nobody final : tasks::RunObserver {
    void output(double, const tasks::Workspace&, const tasks::Counters&) override {}
    void transition(const tasks::TransitionRecord&) override {}
};

/// The state after a short geometric start, with transitions in it.
std::vector<double> end_of(const tasks::Scene& scene) {
    tasks::Simulation simulation(scene);
    Nobody nobody;
    EXPECT_FALSE(simulation.advance({.until = 0.0}, nobody, never));
    EXPECT_FALSE(simulation.advance({.until = scene.run.until}, nobody, never));
    EXPECT_GT(simulation.counters().detected, 0);
    return {simulation.state(), simulation.state() + simulation.variator().layout().size()};
}

TEST(WholePins, GiveTheSameBitsWhateverTheSegmentsAndExecutor) {
    for (const std::string method : {"rk4", "leapfrog-chebyshev"}) {
        const auto run = [&](const std::string& segments, const std::string& schedule, const std::string& threads) {
            return end_of(
                ready_scene("tiny", {"detail.pins=whole", "run.method=" + method, "run.step=100ns", "run.until=200us",
                                     "start.state=", "start.settling_time=300us", "start.ramp_time=300us", "detail.stick_slip=true",
                                     "run.segments=" + segments, "run.schedule=" + schedule, "run.threads=" + threads}));
        };
        const std::vector<double> one = run("1", "serial", "1");
        for (const std::string segments : {"2", "5", "9"}) EXPECT_EQ(run(segments, "serial", "1"), one) << method << ", " << segments;
        EXPECT_EQ(run("4", "flow", "2"), one) << method;
    }
}

/// Means over the last half of a run of 10 ms after 20 ms of settling.
struct Means {
    double tight, slack, slip;
};
Means means_at(const std::string& pins, double load) {
    const auto times = [&](double value) { return std::to_string(load / 150.0 * value); };
    const Operation run(ready_scene(
        "baseline", {"detail.pins=" + pins, "detail.order=1", "start.state=", "start.settling_time=20ms", "run.until=10ms",
                     "run.output_interval=20us", "run.method=leapfrog-chebyshev", "run.step=auto", "clamping.driving=" + times(27100.0),
                     "clamping.driven=" + times(20e3), "load.torque=" + times(150.0), "run.schedule=serial"}));
    EXPECT_FALSE(run.fault) << pins;
    return {run.mean(run.tight), run.mean(run.slack), run.mean(run.slip)};
}

/// At 300 N·m 4 % of slip was the target; 7.0 % is what it is over these 10 ms, with the ratio still moving (decision 84).
TEST(NightlyWholePins, TellTensionsWithinTwoPerCentOfHalvesAndSlipWithinFourAndEight) {
    for (const auto& [load, slip] : {std::pair{150.0, 0.04}, {300.0, 0.08}}) {
        const Means halves = means_at("halves", load), pins = means_at("whole", load);
        EXPECT_NEAR(pins.tight, halves.tight, 0.02 * halves.tight) << load;
        EXPECT_NEAR(pins.slack, halves.slack, 0.02 * halves.slack) << load;
        EXPECT_NEAR(pins.slip, halves.slip, slip * halves.slip) << load;
    }
}

}  // namespace
}  // namespace cvtflow::claims
