/// Claim: whole pins (EQUATIONS section 10) tell what the model with halves tells. What holds at every level of detail stands elsewhere.

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "tests/claims/operating_point_fixture.hpp"

namespace cvtflow::claims {
namespace {

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
