/// Errors of means by batches of pin periods, and when a run is steady.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "tasks/run/mean_curve.hpp"
#include "tasks/run/run_means.hpp"

namespace cvtflow::tasks {
namespace {

constexpr double period = 7e-4, pins = 80.0;  // [s], [1]
constexpr SteadyRule one_percent{0.01, 20.0 * pins, pins, 1.0};

/// A machine at 100 rad/s that loses a fiftieth of its power; `fill` sets what its observations have besides.
/// @param cylinder power that the cylinders take in the first 24 periods [W]
template <class Fill>
RunMeans means_that(const Fill& fill, double until = 10.0, const SteadyRule& rule = one_percent, double pin_period = period,
                    double cylinder = 0.0) {
    RunMeans means;
    means.seek_steady(rule);
    for (double time = 0.0; time <= until && !means.ended(); time += period / 10.3) {  // samples lie at no fixed place of a period
        model::Observation now;
        now.time = time;
        now.speed = {100.0, 100.0};
        now.tight = 2000.0;
        now.slack = 500.0;
        now.clamping = {25e3, 20e3};
        now.slip = now.friction_slip = 0.003 + 3e-5 * std::sin(3000.0 * time);
        fill(now);
        EnergySums sums;
        sums.time = time;
        sums.work = {1e4 * time, -9.8e3 * time};
        sums.loss[0] = 200.0 * time;
        sums.loss[static_cast<std::size_t>(model::Loss::cylinder)] = cylinder * std::min(time, 24.0 * pin_period);
        means.add(now, sums, pin_period);
    }
    return means;
}

/// Whose tight tension is a function of time [N].
template <class Tension>
RunMeans means_of(const Tension& tension, double until, const SteadyRule& rule = one_percent) {
    return means_that([&](model::Observation& now) { now.tight = tension(now.time); }, until, rule);
}

double ripple(double time) { return 40.0 * std::cos(2.0 * std::numbers::pi * time / period + 0.3); }

TEST(ErrorOfMean, OfALineIsItsWholeChange) {
    const MeanError error = error_of_mean(std::vector{1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0});
    EXPECT_NEAR(error.mean, 4.5, 1e-14);
    EXPECT_NEAR(error.drift, 8.0, 1e-12);
    EXPECT_NEAR(error.noise, 0.0, 1e-12);
}

/// A decay nearly as slow as the window; in some phases of a swing, of which the window sees less than a third, a fifth is missing.
TEST(ErrorOfMean, CoversWhatADecayOrASwingHasLeft) {
    const auto share = [](const auto& left) {  // of a mean of zero; eight means of a window of unit length
        std::vector<double> values(8);
        for (std::size_t k = 0; k < 8; ++k)
            for (int fine = 0; fine < 100; ++fine) values[k] += 0.01 * left(0.125 * (static_cast<double>(k) + 0.01 * (fine + 0.5)));
        const MeanError error = error_of_mean(values);
        return error.sum() / std::abs(error.mean);
    };
    for (const double decay : {0.05, 0.1, 0.25, 0.5, 0.8}) EXPECT_GT(share([=](double t) { return std::exp(-t / decay); }), 1.0) << decay;
    for (double phase = 0.0; phase < 3.1; phase += 0.2)
        EXPECT_GT(share([=](double t) { return std::exp(-1.5 * t) * std::cos(2.0 * t + phase); }), 0.8) << phase;
}

/// Noise seldom makes a change certain that is larger than the one that was made.
TEST(ErrorOfMean, IsBesideAChangeThatIsCertain) {
    std::mt19937 chance(11);
    std::normal_distribution<double> noise(0.0, 0.5);
    int above = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        std::vector<double> values(8);
        for (std::size_t k = 0; k < 8; ++k) values[k] = 10.0 + 0.25 * static_cast<double>(k) + noise(chance);  // a change of 2
        above += error_of_mean(values).certain() > 2.0;
    }
    EXPECT_LE(above, 0.03 * 2000);  // half of 5 %, on one side
}

TEST(ErrorOfMean, CoversTheMeanOfNoise) {
    std::mt19937 chance(7);
    std::normal_distribution<double> noise;
    int outside = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        std::vector<double> values(8);
        for (double& value : values) value = noise(chance);
        const MeanError error = error_of_mean(values);
        outside += std::abs(error.mean) > error.sum();
    }
    EXPECT_LE(outside, 0.01 * 2000);  // 95 % by the scatter alone; the trends of noise add
}

TEST(SteadyMeans, AreOfWholePinPeriodsWhateverRippleAndSamplesDo) {
    const RunMeans means = means_of([](double time) { return 2000.0 + ripple(time); }, 1.0);
    ASSERT_TRUE(means.ended());
    EXPECT_TRUE(means.steady().steady());
    EXPECT_FALSE(means.steady_fault());
    EXPECT_NEAR(means.all().tight, 2000.0, 0.2);                      // a hundredth of the ripple's amplitude, over a sample at each end
    EXPECT_NEAR(means.all().end, 2.0 * pins * period, 6.0 * period);  // after two revolutions, at the next check
    EXPECT_NEAR(means.all().begin, 0.5 * means.all().end, 8.0 * period);
    EXPECT_NEAR(means.all().periods * period, means.all().end - means.all().begin, 1e-9);
    EXPECT_LT(means.steady().alternation, 1e-4);
}

/// A held sheave rests. What its cylinder takes under control is part of the error, or control stays: also where pins are slow.
TEST(SteadyMeans, AreOfControlWhereItMovesTheSheave) {
    SteadyRule rule = one_percent;
    rule.controlled = 24.0;
    const auto means = [&](double cylinder, double pin_period) {
        return means_that([](model::Observation&) {}, 0.3, rule, pin_period, cylinder);
    };
    const RunMeans calm = means(1.4, period);
    EXPECT_TRUE(calm.rule().holds_sheave());
    EXPECT_GE(calm.steady().error[6].sum(), 1.4);
    EXPECT_LT(calm.steady().error[6].mean, 200.1);
    EXPECT_FALSE(means(1.8, period).rule().holds_sheave());  // 0.8 % of 200 W are 1.6 W
    EXPECT_FALSE(means(0.0, 1.2e-3).rule().holds_sheave());
}

TEST(SteadyMeans, WaitUntilATransientIsWithinTheTolerance) {
    for (const double decay : {0.02, 0.05, 0.1}) {
        std::mt19937 chance(3);
        std::normal_distribution<double> noise(0.0, 4.0);
        const RunMeans means =
            means_of([&](double time) { return 2000.0 - 300.0 * std::exp(-time / decay) + ripple(time) + noise(chance); }, 1.1);
        ASSERT_TRUE(means.ended());
        EXPECT_FALSE(means.steady_fault());
        const MeanError& tight = means.steady().error[2];
        EXPECT_LE(tight.sum(), 0.01 * tight.mean);
        EXPECT_LE(std::abs(means.all().tight - 2000.0), tight.sum()) << decay;
        EXPECT_GT(means.all().end, 2.0 * decay) << decay;
    }
}

/// One swing is from pin to pin, another is no multiple of half the pin frequency, as two modes of a strand have. One that stays as it is
/// has a mean.
TEST(SteadyMeans, OfAGrowingSwingAreNotSteady) {
    const auto swinging = [](double amplitude, double per_period, double growth) {
        return means_of(
            [=](double time) {
                return 2000.0 + ripple(time) +
                       amplitude * std::exp(growth * time) * std::sin(per_period * std::numbers::pi * time / period);
            },
            0.6, {0.01, 10.0 * pins, pins, 1.0});
    };
    const RunMeans constant = swinging(4.0, 1.0, 0.0), growing = swinging(4.0, 1.0, 3.0);
    EXPECT_NEAR(constant.steady().alternation, 4.0 / 2000.0, 0.05 * 4.0 / 2000.0);  // ten samples per period see sin x/x at pi/20
    const RunMeans other = swinging(6.0, 0.56, 0.0), other_growing = swinging(6.0, 0.56, 4.0);
    EXPECT_GT(other.steady().swing, 1e-3);
    EXPECT_FALSE(other_growing.steady().alternation > 1e-3);
    for (const RunMeans* each : {&constant, &other}) EXPECT_FALSE(each->steady_fault());
    for (const RunMeans* each : {&growing, &other_growing}) {
        EXPECT_TRUE(each->ended());
        EXPECT_TRUE(each->steady().grows);
        EXPECT_EQ(each->steady_fault().kind, FaultKind::not_steady);
        EXPECT_THAT(each->steady_fault().message(), testing::HasSubstr("swing from pin to pin"));
    }
}

/// Control with an integral time of 0.2 s has 0.3 % to go: by the line through the means alone, an early end has a tenth of that left.
TEST(SteadyMeans, OfARatioThatIsHeldAreAtItsTarget) {
    const auto ending = [](bool holds) {
        return means_that(
            [](model::Observation& now) {
                const double ratio = 1.4 * (1.0 + 0.003 * std::exp(-now.time / 0.2));
                now.control = {1.4, ratio};
                now.speed = {100.0 * ratio, 100.0};
            },
            10.0, {0.01, 60.0 * pins, pins, 1.0, holds});
    };
    const RunMeans free = ending(false), held = ending(true);
    EXPECT_GT(std::abs(free.all().ratio - 1.4), 0.001 * 1.4);  // steady to 1 %
    EXPECT_FALSE(held.steady_fault());
    EXPECT_LE(held.steady().error[0].sum(), 0.001 * 1.4);
    EXPECT_LE(std::abs(held.all().ratio - 1.4), held.steady().error[0].sum());
}

/// Control with a ratio that is off by more than a tenth of the tolerance, while all other means are known.
TEST(SteadyMeans, OfARatioThatIsKnownWellEnoughAreSteadyAtTheLimit) {
    for (const double off : {0.0012, 0.003}) {
        const RunMeans means = means_that(
            [&](model::Observation& now) {
                now.control = {1.4, 1.4 * (1.0 + off)};
                now.speed = {100.0 * now.control.value, 100.0};
            },
            10.0, {0.01, 16.0 * pins, pins, 1.0, true});
        EXPECT_NEAR(means.all().end, 16.0 * pins * period, 2.0 * period) << off << ": not before";
        EXPECT_EQ(means.steady_fault().kind == FaultKind::not_steady, off > 0.002);
        EXPECT_GT(means.steady().error[0].sum(), off * 1.4) << "stated";
    }
}

/// Errors state half of the tolerance beside what a run shows when it passes, of a ratio that is held a tenth of that.
TEST(SteadyMeans, StateWhatNoMeanShowsToo) {
    const MeanErrors free = means_of([](double) { return 2000.0; }, 1.0).steady();
    EXPECT_NEAR(free.error[2].sum(), 0.005 * 2000.0, 1e-6);
    EXPECT_NEAR(free.error[0].sum(), 0.005, 1e-9);
    EXPECT_NEAR(free.error[5].sum(), 0.005 * 0.003, 0.05 * 0.005 * 0.003);
    const RunMeans held = means_that(
        [](model::Observation& now) {
            now.control = {1.0, now.time < 20.0 * period ? 1.1 : 1.002};  // what control does before is no part of the means
            now.speed = {100.0 * now.control.value, 100.0};
            now.sheave_position = {1e-3, 0.0};
        },
        10.0, {0.01, 20.0 * pins, pins, 1.0, true, 24.0});
    EXPECT_FALSE(held.steady_fault());
    EXPECT_NEAR(held.all().end, (24.0 + pins) * period, 6.0 * period);
    EXPECT_NEAR(held.steady().error[0].sum(), (0.002 + 0.0005) * 1.002, 1e-4);
    EXPECT_NEAR(held.all().begin, (24.0 + 0.5 * pins) * period, 8.0 * period);
}

TEST(SteadyMeans, OfAChainThatSlidesEndEarly) {
    const auto slipping = [](double begin, double rate, double until = 10.0, const SteadyRule& rule = {0.01, 16.0 * pins, pins, 1.0}) {
        const auto slip = [=](model::Observation& now) {
            now.slip = now.friction_slip = begin + rate * now.time + 0.01 * begin * std::sin(3000.0 * now.time);
        };
        return means_that(slip, until, rule);
    };
    const RunMeans sliding = slipping(0.003, 1.0), backwards = slipping(0.003, -1.0), creeping = slipping(0.003, 0.1);
    EXPECT_GT(sliding.steady().sliding, 0.1);
    EXPECT_GT(backwards.steady().sliding, 0.1);
    EXPECT_EQ(creeping.steady().sliding, 0.0);
    EXPECT_TRUE(slipping(0.15, 0.0).steady().steady());
    const RunMeans confirming = slipping(0.003, 1.0, 0.5, {0.0, 1e9, pins, 1.0});
    EXPECT_FALSE(confirming.ended());                             // a run without a tolerance does not end by itself
    EXPECT_NEAR(sliding.all().end, 0.097 / 0.875, 9.0 * period);  // the last quarter's mean slip is a tenth; a check each four periods
    EXPECT_EQ(sliding.steady_fault().kind, FaultKind::not_steady);
    EXPECT_THAT(sliding.steady_fault().message(), testing::StartsWith("the chain slides at t = "));
    EXPECT_THAT(creeping.steady_fault().message(), testing::HasSubstr("after 16 revolutions"));
}

TEST(SteadyMeans, OfADriftEndAtTheLimit) {
    const RunMeans means = means_of([](double time) { return 1000.0 + 4000.0 * time; }, 10.0, {0.01, 6.0 * pins, pins, 1.0});
    ASSERT_TRUE(means.ended());
    EXPECT_EQ(means.steady_fault().kind, FaultKind::not_steady);
    EXPECT_GT(means.steady_fault().value, 10.0);  // half of the run: 13 %
    EXPECT_EQ(means.steady().worst, 2u);
    EXPECT_NEAR(means.all().end, 6.0 * pins * period, period);
}

/// Means of an imperfect machine are over whole revolutions, at least four of them.
TEST(SteadyMeans, OfAnImperfectMachineAreOverRevolutions) {
    const double turn = pins * period;
    const RunMeans means = means_of([=](double time) { return 2000.0 + 200.0 * std::sin(2.0 * std::numbers::pi * time / turn); }, 2.0,
                                    {0.01, 20.0 * pins, pins, pins});
    ASSERT_TRUE(means.ended());
    EXPECT_FALSE(means.steady_fault());
    EXPECT_EQ(means.steady().batch, static_cast<std::size_t>(pins));
    EXPECT_NEAR(means.all().tight, 2000.0, 1.0);
    EXPECT_NEAR(means.all().end, 8.0 * turn, 6.0 * period);
}

/// Slip by friction that settles with 0.5 s, the time constant of shaft 2 at its load: the trend of the means counts as what is to come of
/// it, and close to the torque that the clamping forces carry errors are as large as a change of load makes them.
TEST(SteadyMeans, OfASlipNearItsLimitStateWhatIsToCome) {
    constexpr double settling = 0.5, grip = 0.2, clamping = 20e3, radius = 0.05, slip = 0.02;
    for (const double share : {0.1, 0.95}) {
        const double torque = share * grip * clamping * radius, inertia = settling * torque * (1.0 - share) / (100.0 * slip);
        const auto near_its_limit = [&](model::Observation& now) {
            now.torque = {torque, -torque};
            now.clamping = {clamping, 1.1 * clamping};
            now.radius = {radius, radius};
            now.slip = now.friction_slip = slip * (1.0 - 0.02 * std::exp(-now.time / settling));
        };
        SteadyRule rule = one_percent;
        const RunMeans blind = means_that(near_its_limit, 10.0, rule);
        rule.grip = grip;
        rule.inertia = inertia;
        const RunMeans means = means_that(near_its_limit, 10.0, rule);
        ASSERT_FALSE(means.steady_fault());
        const MeanError& error = means.steady().error[5];
        EXPECT_NEAR(error.mean, slip, error.sum()) << share;
        const MeanError& without = blind.steady().error[5];
        EXPECT_GT(std::abs(without.mean - slip), without.sum()) << share << ": the trend alone does not cover it";
        EXPECT_NEAR(error.sum() / slip, share > 0.9 ? 0.002 * 19.0 : 0.01, 0.003) << share;
    }
}

TEST(SteadyMeans, OfAChainAtRestDoNotExist) {
    const RunMeans means = means_that([](const model::Observation&) {}, 1.0, one_percent, 0.0);
    EXPECT_TRUE(means.ended());
    EXPECT_THAT(means.steady_fault().message(), testing::HasSubstr("moves too little"));
}

TEST(SteadyMeans, ContinueFromACheckpoint) {
    const auto tension = [](double time) { return 2000.0 - 300.0 * std::exp(-time / 0.03) + ripple(time); };
    RunMeans whole, second;
    whole.seek_steady(one_percent);
    second.seek_steady(one_percent);
    for (int k = 0; k < 3000 && !whole.ended(); ++k) {
        model::Observation now;
        now.time = k * period / 9.7;
        now.tight = tension(now.time);
        if (k == 500) {
            std::vector<std::byte> memory;
            engine::write_fields(memory, [&](auto& archive) { whole.visit(archive); });
            engine::read_fields(memory, [&](auto& archive) { second.visit(archive); });
        }
        whole.add(now, {now.time, {}, {}}, period);
        if (k >= 500) second.add(now, {now.time, {}, {}}, period);
    }
    ASSERT_TRUE(whole.ended());
    EXPECT_TRUE(second.ended());
    EXPECT_EQ(whole.all().tight, second.all().tight);
    EXPECT_EQ(whole.steady().share, second.steady().share);
}

}  // namespace
}  // namespace cvtflow::tasks
