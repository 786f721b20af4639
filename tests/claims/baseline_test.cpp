/// The baseline operating point against one-dimensional theory.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/claims/operating_point_fixture.hpp"
#include "tests/claims/rig_fixture.hpp"

namespace cvtflow::claims {
namespace {

/// Amplitude of a signal at a frequency, mean removed, Hann window.
double amplitude(const std::vector<double>& time, const std::vector<double>& signal, double frequency) {
    const double n = static_cast<double>(signal.size());
    double mean = 0.0;
    for (const double value : signal) mean += value / n;
    double cosine = 0.0;
    double sine = 0.0;
    for (std::size_t k = 0; k < signal.size(); ++k) {
        const double window = 1.0 - std::cos(2.0 * std::numbers::pi * static_cast<double>(k) / n);
        const double angle = 2.0 * std::numbers::pi * frequency * time[k];
        cosine += window * (signal[k] - mean) * std::cos(angle);
        sine += window * (signal[k] - mean) * std::sin(angle);
    }
    return 2.0 * std::hypot(cosine, sine) / n;
}

/// Height of a line over what lies between it and its harmonics.
double prominence(const Operation& run, const std::vector<double>& signal, double frequency) {
    double floor = 0.0;
    for (const double factor : {0.6, 0.75, 1.25, 1.4}) floor = std::max(floor, amplitude(run.time, signal, factor * frequency));
    return amplitude(run.time, signal, frequency) / floor;
}

void expect_theory(const Operation& run) {
    // Means over 10 ms: 14 pin passages of 0.71 ms.
    const double drift = run.mean(run.ratio, 8e-3, 10e-3) / run.mean(run.ratio, 0.0, 2e-3) - 1.0;
    EXPECT_LT(std::abs(drift), 1e-3);
    EXPECT_NEAR(run.mean(run.tight), 4960.0, 0.05 * 4960.0);  // one-dimensional theory: 4850
    EXPECT_NEAR(run.mean(run.slack), 2210.0, 0.05 * 2210.0);  // one-dimensional theory: 2100
    EXPECT_NEAR((run.mean(run.tight) - run.mean(run.slack)) * run.mean(run.radius), 150.0, 1.5);
    const double clamping[] = {27.1e3, 27.1e3, 20e3, 20e3};
    for (std::size_t sheave = 0; sheave < 4; ++sheave) {
        EXPECT_NEAR(std::abs(run.mean(run.axial_force[sheave])), clamping[sheave], 0.01 * clamping[sheave]) << "sheave " << sheave;
    }
    testing::Test::RecordProperty("drift", std::to_string(drift));
    testing::Test::RecordProperty("tight", std::to_string(run.mean(run.tight)));
    testing::Test::RecordProperty("slack", std::to_string(run.mean(run.slack)));
}

void expect_hum(const Operation& run, const tasks::Scene& scene) {
    const double pitch = scene.parameters.chain.pitch[0];
    const double passing = run.mean(run.chain_speed) / pitch;
    EXPECT_NEAR(passing, 1404.0, 0.01 * 1404.0);
    EXPECT_GT(prominence(run, run.driven_speed, passing), 3.0);
    // At that frequency the polygon of pins moves the strand by no more than the sagitta of one pitch (peak to peak).
    const double r = run.mean(run.radius);
    const double sagitta = r * (1.0 - std::cos(std::asin(pitch / (2.0 * r))));
    EXPECT_LT(2.0 * amplitude(run.time, run.strand_height, passing), sagitta);
}

TEST(NightlyBaseline, IsStationaryWithTheTensionsTorqueAndAxialForcesOfTheoryAndHumsAtThePinPassingFrequency) {
    const tasks::Scene scene = ready_scene("baseline", {"run.method=rk4", "run.until=10 ms"});
    const Operation run(scene);
    ASSERT_FALSE(run.fault) << run.fault.message();
    expect_theory(run);
    expect_hum(run, scene);
    const double passing = run.mean(run.chain_speed) / scene.parameters.chain.pitch[0];
    EXPECT_GT(prominence(run, run.slack, passing), 3.0);
    EXPECT_GT(prominence(run, run.slack, 3.0 * passing), 3.0);
    EXPECT_GT(prominence(run, run.tight, 2.0 * passing), 3.0);
}

/// Claims at every level of detail, with the automatic step of each, but for the lines in the strands' tensions.
class EveryLevel : public testing::TestWithParam<std::string> {};

TEST_P(EveryLevel, ShowsTheBaselineOfTheoryItsHumAndAClosedEnergyBalance) {
    const tasks::Scene scene = scene_at_level("baseline", GetParam(), {"run.until=10 ms"});
    const Operation run(scene);
    ASSERT_FALSE(run.fault) << run.fault.message();
    EXPECT_LE(run.balance_error_ratio, 1.0);
    expect_theory(run);
    expect_hum(run, scene);
}

TEST(Baseline, ShiftsTowardsLowWhenTheDrivingSideIsClampedLess) {
    const Operation run(ready_scene("baseline", {"run.until=8 ms", "clamping.driving=22 kN"}));
    ASSERT_FALSE(run.fault) << run.fault.message();
    const double begin = run.mean(run.driven_speed, 1.4e-3, 2.8e-3);
    const double end = run.mean(run.driven_speed, 6.4e-3, 7.8e-3);
    // About 1 % in 40 ms once the shift has begun, so 0.125 % in 5 ms; half of that is asked.
    EXPECT_LT(end / begin - 1.0, -0.6e-3);
}

/// @return the largest torque that the driven side took [N·m]
double expect_gross_slip_at_the_limit(const tasks::Scene& scene, double within) {
    const Operation run(scene);
    const auto& p = scene.parameters;
    double carried = 0.0;  // largest torque that the driven side takes, averaged over a pin passage
    for (double from = 0.0; from + 0.72e-3 < run.time.back(); from += 0.36e-3)
        carried = std::max(carried, run.mean(run.driven_torque, from, from + 0.72e-3));
    const double limit =
        2.0 * p.tip.friction.coefficient * p.clamping.driven.at(0.0) * run.mean(run.radius, 0.0, 2e-3) / std::cos(p.tip.angle);
    EXPECT_NEAR(carried, limit, within * limit);
    // Gross slip, not creep: ten times what the baseline creeps, and growing to the end.
    EXPECT_GT(run.mean(run.slip, 24e-3, 25e-3), 10.0 * run.mean(run.slip, 0.0, 1e-3));
    EXPECT_GT(run.mean(run.slip, 24e-3, 25e-3), run.mean(run.slip, 22e-3, 23e-3));
    return carried;
}

TEST(LoadRamp, SlipsWithinFivePercentOfTheFrictionLimit) {
    RecordProperty("carried", std::to_string(expect_gross_slip_at_the_limit(ready_scene("load_ramp"), 0.05)));
}

TEST_P(EveryLevel, SlipsAtTheFrictionLimitWhenTheLoadIsRamped) {
    RecordProperty("carried", std::to_string(expect_gross_slip_at_the_limit(scene_at_level("load_ramp", GetParam()), 0.05)));
}

/// A run of some ten milliseconds settles for 60: the cheapest level in every run, all of them nightly.
INSTANTIATE_TEST_SUITE_P(Cheapest, EveryLevel, testing::Values(levels().front()), [](const auto& level) { return level.param; });
INSTANTIATE_TEST_SUITE_P(NightlyBaseline, EveryLevel, testing::ValuesIn(levels()), [](const auto& level) { return level.param; });

class NightlyThrustRatio : public testing::TestWithParam<std::string> {};

TEST_P(NightlyThrustRatio, UnderRatioControlTheControllerFindsTheThrustRatioOfTheory) {
    const Operation run(scene_at_level("control", GetParam()));
    ASSERT_FALSE(run.fault) << run.fault.message();
    const double end = run.time.back();
    // One-dimensional theory: 1.357 at 75 % of the torque limit. The controller still swings by a few per cent after 80 ms.
    EXPECT_NEAR(run.mean(run.thrust_ratio, end - 30e-3, end), 1.357, 0.05 * 1.357);
    RecordProperty("thrust_ratio", std::to_string(run.mean(run.thrust_ratio, end - 30e-3, end)));
}

TEST_P(NightlyThrustRatio, WithoutLoadTheStationaryThrustRatioIsOneWithinThreePercent) {
    const auto drift = [](const char* driving) {
        const Operation run(scene_at_level("baseline", GetParam(),
                                           {"start.settling_time=15 ms", "run.until=12 ms", "load.torque=0", "clamping.driven=20 kN",
                                            std::string("clamping.driving=") + driving}));
        EXPECT_FALSE(run.fault) << run.fault.message();
        return run.mean(run.ratio, 10e-3, 12e-3) - run.mean(run.ratio, 0.0, 2e-3);
    };
    // The ratio moves one way with a little too little on the driving side and the other way with a little too much.
    EXPECT_GT(drift("19.4 kN"), 0.0);
    EXPECT_LT(drift("20.6 kN"), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Levels, NightlyThrustRatio, testing::ValuesIn(levels()), [](const auto& level) { return level.param; });

/// Relative difference of the axial forces of all tips.
double difference(const std::vector<double>& a, const std::vector<double>& b) {
    double square = 0.0;
    double norm = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        square += (a[k] - b[k]) * (a[k] - b[k]);
        norm += b[k] * b[k];
    }
    return std::sqrt(square / norm);
}

/// RK4, by its stability interval and the spectrum of the chain.
TEST(StepSize, FiftyNanosecondsAreAccurateAndEightyChatter) {
    const auto forces = [](const char* step) {
        const Operation run(ready_scene("baseline", {"run.method=rk4", "run.until=80 us", "run.output_interval=40 us",
                                                     "run.state_interval=40 us", std::string("run.step=") + step}));
        EXPECT_FALSE(run.fault) << run.fault.message();
        return run.tip_axial.back();
    };
    const auto reference = forces("12.5 ns");
    const double fifty = difference(forces("50 ns"), reference);
    const double eighty = difference(forces("80 ns"), reference);
    RecordProperty("error_50ns", std::to_string(fifty));
    RecordProperty("error_80ns", std::to_string(eighty));
    // h λ at 6e7 1/s is 3.0 and 4.8, RK4 is stable to 2.785: the friction of a few joints chatters a little at 50 ns, all of it at 80 ns.
    EXPECT_LT(fifty, 1e-3);
    EXPECT_GT(eighty, 10.0 * fifty);
}

}  // namespace
}  // namespace cvtflow::claims
