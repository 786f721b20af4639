#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "tasks/run/mean_curve.hpp"
#include "tasks/run/run.hpp"
#include "tasks/run/run_means.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/ready_scenes.hpp"

namespace cvtflow::tasks {
namespace {

/// Means over the outputs 0 … `last`, an interval apart [s], of a machine at a ratio of one; `fill` sets what they have besides.
template <class Fill>
RunMeans means_over(int last, double interval, double pin_period, const Fill& fill) {
    RunMeans means;
    for (int k = 0; k <= last; ++k) {
        model::Observation now;
        now.time = interval * k;
        now.ratio = 1.0;
        now.speed = {200.0, -200.0};
        now.tight = now.slack = 100.0;
        EnergySums sums;
        sums.time = now.time;
        fill(k, now, sums);
        means.add(now, sums, pin_period);
    }
    return means;
}

TEST(RunMeans, AreOverWholePinPeriodsAndSayWhatIsOdd) {
    // More outputs than bins: 100 ms of a chain that begins to slide.
    const RunMeans means = means_over(5000, 2e-5, 7e-4, [](int k, model::Observation& now, EnergySums& sums) {
        now.slip = k < 2500 ? 0.002 : 0.1;
        sums.work = {1e4 * now.time, -9.8e3 * now.time};
        sums.loss[0] = 200.0 * now.time;
    });
    const SpanMeans whole = means.all();  // of the last 142 pin periods
    EXPECT_NEAR(whole.end - whole.begin, 142 * 7e-4, 1e-12);
    EXPECT_NEAR(whole.slip, (0.002 * (0.05 - whole.begin) + 0.1 * 0.05) / (0.1 - whole.begin), 1e-4);  // a sample is 1e-4 of it
    EXPECT_NEAR(means.fifth(4).slip, 0.1, 1e-12);                                                      // rounding of sums of thousands
    EXPECT_NEAR(means.all().efficiency, 0.98, 1e-9);
    EXPECT_EQ(means.all().periods, std::floor(0.1 / 7e-4));
    std::string names;
    EnergyBalance balance{.work = 20.0, .loss = 20.0, .energy_in = 1e3, .stored = 4.0, .samples = 100.0};
    name_notes(means, balance, names);
    EXPECT_EQ(names, "gross_slip unsteady");
    balance.loss = 0.05;  // 1e-5 of what came in are a fifth of it
    name_notes(means, balance, names);
    EXPECT_EQ(names, "gross_slip unsteady unresolved");
    std::vector<double> memory;
    means.save(memory);
    RunMeans again;
    EXPECT_TRUE(again.load(memory).empty());
    EXPECT_EQ(again.all().slip, means.all().slip);
}

/// One sample above the limit of clamping is enough.
TEST(RunMeans, SayWhereClampingWasAboveItsLimit) {
    for (const double most : {0.99, 1.01}) {
        const RunMeans means =
            means_over(1000, 1e-3, 1e-3, [&](int k, model::Observation& now, EnergySums&) { now.limit_use = k == 500 ? most : 0.5; });
        std::string names;
        name_notes(means, {}, names);
        EXPECT_EQ(names.find("clamping_limit") != std::string::npos, most > 1.0) << names;
        EXPECT_NEAR(means.all().beyond, most > 1.0 ? 1e-3 : 0.0, 2e-6);  // a sample's share of the time
    }
}

/// A ratio of 1.4 that control brings to 1.36, or to 1.39.
TEST(RunMeans, SayWhereControlMissesItsTarget) {
    for (const double ratio : {1.36, 1.39}) {
        const RunMeans means = means_over(1000, 1e-3, 1e-3, [&](int, model::Observation& now, EnergySums&) {
            now.speed = {200.0, 200.0 / ratio};
            now.control = {1.4, ratio};
        });
        const std::vector<Note> found = notes(means, {});
        const auto missed = std::ranges::find(found, "target_missed", &Note::name);
        EXPECT_EQ(missed != found.end(), ratio < 1.38) << ratio;
        if (missed == found.end()) continue;
        EXPECT_EQ(missed->text, "control misses its target by -2.86 % in the last fifth");
    }
}

/// A ratio that follows a table from 1 to 2, but for the second fifth of the run, where control is at its limit; or a constant target.
TEST(RunMeans, JudgeControlOverTheWholeRunWhereItsTargetIsATable) {
    for (const bool table : {true, false}) {
        const RunMeans means = means_over(1000, 1e-3, 1e-3, [&](int k, model::Observation& now, EnergySums&) {
            const bool misses = k >= 200 && k <= 400;
            const double target = table ? 1.0 + 1e-3 * k : 1.0;
            now.control = {target, (misses ? 1.5 : 1.0) * target};
            now.control_limited = misses;
        });
        std::string texts;
        for (const Note& note : notes(means, {})) texts += note.text + "\n";
        EXPECT_EQ(texts.find("control misses its target by 50 % in the second fifth") != std::string::npos, table) << texts;
        EXPECT_EQ(texts.find("control is at the limit of its authority (20.1 % of the run)") != std::string::npos, table) << texts;
    }
}

/// A second at the needed 100 rad/s under 10 N·m, but for a part in which shaft 2 turns at 50: half of the distance and of the work.
TEST(RunMeans, CompareACycleWithWhatShaftTwoDelivers) {
    for (const int last : {130, 150}) {  // of 1000 samples, from 100 on
        RunMeans means;
        for (int k = 0; k <= 1000; ++k) {
            model::Observation now;
            now.time = 1e-3 * k;
            now.speed = {200.0, k > 100 && k <= last ? (k == 120 ? 40.0 : 50.0) : 100.0};
            now.torque = {5.0, -10.0};
            means.add(now, {.time = now.time}, 1e-3, {}, 100.0);
        }
        const SpanMeans whole = means.all();
        const double missing = (0.5 * (last - 100) + 0.1) * 1e-3;
        EXPECT_NEAR(whole.astray, missing, 1e-9);  // sums of a thousand numbers
        EXPECT_NEAR(whole.short_of, missing, 1e-9);
        EXPECT_EQ(whole.cycle_missed(), last == 150) << "1.5 and 2.5 %";
        std::vector<double> memory;
        means.save(memory);
        RunMeans again;
        EXPECT_TRUE(again.load(memory).empty());
        const std::vector<Note> found = notes(again, {});
        const auto note = std::ranges::find(found, "cycle_missed", &Note::name);
        ASSERT_EQ(note != found.end(), last == 150);
        if (last != 150) continue;
        EXPECT_EQ(note->text,
                  "the machine misses its cycle: speed of shaft 2 is off by 2.51 % on average, its work by -2.51 %; most at t = "
                  "0.12 s, where its speed is off by -60 %");
    }
    EXPECT_FALSE(means_over(1000, 1e-3, 1e-3, [](int, model::Observation&, EnergySums&) {}).all().cycle_missed()) << "without a cycle";
}

/// A force of 20 kN that control moves: a swing, and one step, whose standard deviation over the last fifth is as large.
TEST(RunMeans, SayWhereAControlledForceSwings) {
    const auto names_with = [](const auto& force) {
        std::string names;
        const RunMeans means = means_over(5000, 2e-4, 4e-3, [&](int k, model::Observation& now, EnergySums&) {
            now.speed = {200.0, 200.0};
            now.control = {1.0, 1.0, {force(k), 0.0}};
        });
        name_notes(means, {}, names);
        return names.find("control_swing") != std::string::npos;
    };
    const auto sine = [](double amplitude) { return [=](int k) { return 20e3 + amplitude * std::sin(0.1 * k); }; };
    EXPECT_TRUE(names_with(sine(1.5e3))) << "sd 5.3 %";
    EXPECT_FALSE(names_with(sine(1.3e3))) << "sd 4.6 %";
    EXPECT_FALSE(names_with([](int k) { return k < 4500 ? 20e3 : 23e3; })) << "sd 7 % of the last fifth";
    EXPECT_FALSE(names_with([](int) { return 0.0; })) << "without control";
}

/// Where a load drives, the strand that the driving sheaves pull is the loose one.
TEST(RunMeans, SayWhereEitherStrandIsLoose) {
    for (const bool driven : {false, true}) {
        const RunMeans means = means_over(1000, 1e-3, 1e-3, [&](int, model::Observation& now, EnergySums&) {
            now.tight = driven ? 0.0 : 100.0;
            now.slack = driven ? 100.0 : 0.0;
        });
        const std::vector<Note> found = notes(means, {});
        const auto loose = std::ranges::find(found, "slack_strand", &Note::name);
        ASSERT_NE(loose, found.end());
        EXPECT_THAT(loose->text, testing::StartsWith(driven ? "the tight strand" : "the slack strand"));
    }
}

/// 1 s of a machine that carries nothing. speed of its shafts [rad/s]
std::string notes_of_idling(double speed) {
    const RunMeans means = means_over(1000, 1e-3, 1e-3, [&](int k, model::Observation& now, EnergySums& sums) {
        now.speed = {speed, -speed};
        now.slip = k % 2 == 0 ? 0.4 : -0.3;
        sums.work = {100.0 * now.time, -10.0 * now.time, 150.0 * now.time};  // clamping brings energy, what moves keeps it
        sums.loss[0] = 90.0 * now.time;
    });
    std::string names;
    name_notes(means, {.work = 240.0, .loss = 90.0, .energy_in = 250.0, .samples = 100.0}, names);
    return names;
}

TEST(RunMeans, SayWhereSlipIsNoiseAndWhereEfficiencyIsThatOfIdling) {
    EXPECT_EQ(notes_of_idling(200.0), "gross_slip unsteady no_load") << "64 % of the input are neither lost nor carried";
    EXPECT_EQ(notes_of_idling(2e-3), "standstill");
}

/// Means of a steady chain, a tenth of a second, of 100 W of losses, whose drive and load have those powers [W].
RunMeans means_once_steady(double drive, double load, double pin_period = 7e-4, double cylinder = 0.0) {
    return means_over(5000, 2e-5, pin_period, [&](int, model::Observation& now, EnergySums& sums) {
        sums.work = {drive * now.time, -load * now.time, -cylinder * now.time};
        sums.loss[0] = 100.0 * now.time;
    });
}

constexpr EnergyBalance closed_balance{.work = 10.0, .loss = 10.0, .energy_in = 1000.0, .samples = 100.0};

std::string names_of(const RunMeans& means) {
    std::string names;
    name_notes(means, closed_balance, names);
    return names;
}

TEST(RunMeans, OfAStateThatStoresOrGivesEnergyAreNotSteady) {
    EXPECT_EQ(names_of(means_once_steady(10000.0, 9900.0)), "");
    EXPECT_EQ(names_of(means_once_steady(10000.0, 9600.0)), "unsteady") << "3 % of the input are stored";
    EXPECT_EQ(names_of(means_once_steady(6000.0, 9600.0)), "unsteady") << "the load is carried by what moves";
    EXPECT_THAT(notes(means_once_steady(6000.0, 9600.0), closed_balance).front().text,
                testing::HasSubstr("the stored energy has given 61.7 % of the input"));
    EXPECT_EQ(names_of(means_once_steady(10000.0, 9900.0, 0.2)), "unsteady") << "half a pin period";
    const RunMeans coasting = means_once_steady(90.0, 20.0);
    EXPECT_TRUE(std::isnan(coasting.all().efficiency)) << "-11 %";
    EXPECT_EQ(names_of(coasting), "efficiency unsteady no_load");
    EXPECT_EQ(notes(coasting, closed_balance).front().text,
              "there is no efficiency: 100 W are lost of 90 W that come in (100 of 90 W in the last fifth), and what moves gives the rest");
}

TEST(RunMeans, WithoutLoadThereIsNoEfficiency) {
    const RunMeans means = means_once_steady(100.0, 0.0);
    EXPECT_TRUE(std::isnan(means.all().efficiency));
    EXPECT_EQ(names_of(means), "no_load");
    EXPECT_TRUE(std::isnan(means_once_steady(120.0, 0.0, 7e-4, 20.0).all().efficiency)) << "what a cylinder takes is no load";
}

/// 28 pin periods, a hundred samples in each, whose tight tension swings by a third and its mean rises by `rise` in all.
RunMeans rising_means(double rise, double noise) {
    constexpr double period = 7e-4, samples = 100.0, periods = 28.0;
    return means_over(static_cast<int>(samples * periods), period / samples, period, [&](int k, model::Observation& now, EnergySums& sums) {
        const double passed = static_cast<double>(k) / samples, share = passed / periods;
        now.slack = 2000.0;
        now.clamping = {27e3, 20e3};
        const double jitter = noise * std::sin(0.93 * std::floor(passed) * std::floor(passed));
        now.tight = 5000.0 * (1.0 + rise * share + jitter + std::sin(2.0 * std::numbers::pi * passed) / 3.0);
        sums.work = {1e4 * now.time, -9.9e3 * now.time, 0.0};
        sums.loss[0] = 100.0 * now.time;
    });
}

/// A value that moves by more than 1 % has no mean to 1 %. The swing of pins and scatter from period to period are not a movement; a mean
/// of seven values that scatter by 4 % of theirs is uncertain, as is one of a change that scatter hides.
TEST(RunMeans, AreNoResultsWhereOneMovesOrScattersByMoreThanAPerCent) {
    EXPECT_EQ(names_of(rising_means(0.0, 0.0)), "");
    EXPECT_EQ(names_of(rising_means(0.005, 0.0)), "");
    EXPECT_EQ(names_of(rising_means(0.0, 0.003)), "") << "little scatter";
    EXPECT_EQ(names_of(rising_means(0.0, 0.04)), "uncertain") << "scatter";
    EXPECT_EQ(names_of(rising_means(0.01, 0.02)), "uncertain") << "a change that scatter hides";
    EXPECT_EQ(names_of(rising_means(0.02, 0.0)), "unsteady");
    EXPECT_EQ(names_of(rising_means(-0.02, 0.0)), "unsteady");
    EXPECT_THAT(notes(rising_means(0.02, 0.0), closed_balance).front().text,
                testing::HasSubstr("change of tight tension from begin to end 1.98 %"));
}

/// 100 ms with guides that take that much of 200 W; their impacts are irregular for longer.
TEST(RunMeans, WithRailsInContactAreAsUncertainAsTheirImpacts) {
    for (const double rails : {2.0, 40.0}) {
        const RunMeans means = means_over(5000, 2e-5, 7e-4, [&](int, model::Observation& now, EnergySums& sums) {
            sums.work = {1e4 * now.time, -9.8e3 * now.time};
            sums.loss[0] = (200.0 - rails) * now.time;
            sums.loss[static_cast<std::size_t>(model::Loss::guide)] = rails * now.time;
        });
        EXPECT_NEAR(means.errors().error[6].sum(), 0.25 * rails, 0.01 * rails);        // in 0.1 s
        EXPECT_NEAR(means.errors().error[7].sum(), 0.25 * rails / 1e4, 1e-6 * rails);  // of the input
        EXPECT_EQ(names_of(means), rails > 8.0 ? "uncertain" : "");
    }
}

TEST(RunMeans, OfThreePinPeriodsDoNotShowTheirErrors) {
    EXPECT_EQ(names_of(means_once_steady(10000.0, 9900.0, 0.03)), "uncertain");
    EXPECT_EQ(names_of(means_once_steady(10000.0, 9900.0, 0.02)), "");
}

RunReport run_of_rigid_pins(const std::vector<std::string>& settings) {
    Scene scene = read_scene(find_scene("baseline"), StartState::ignored);
    apply_detail(scene, "rigid");
    std::vector<std::string> all{"start.settling_time=10 ms", "run.until=20 ms", "run.state_interval=10 ms"};
    all.insert(all.end(), settings.begin(), settings.end());
    set_values(scene, all);
    return run_scene(scene, {});
}

/// Outputs as far apart as pins pass see them in one place only: slip was 15 % off, the difference of tensions 1 %.
TEST(RunMeans, DoNotDependOnTheDistanceOfOutputs) {
    const RunReport fine = run_of_rigid_pins({"run.output_interval=10 us"});
    for (const char* interval : {"0.1 ms", "0.7145 ms", "5 ms"}) {
        const RunReport coarse = run_of_rigid_pins({std::string("run.output_interval=") + interval});
        EXPECT_NEAR(coarse.whole.slip, fine.whole.slip, 0.01 * fine.whole.slip) << interval;
        EXPECT_NEAR(coarse.whole.friction_slip, fine.whole.friction_slip, 0.01 * fine.whole.friction_slip) << interval;
        EXPECT_NEAR(coarse.whole.tight, fine.whole.tight, 1e-3 * fine.whole.tight) << interval;
        EXPECT_NEAR(coarse.whole.slack, fine.whole.slack, 1e-3 * fine.whole.slack) << interval;
        EXPECT_NEAR(coarse.whole.efficiency, fine.whole.efficiency, 1e-5) << interval;
    }
}

/// Powers, torques times speeds and losses are over one window, and what is stored closes them.
TEST(RunMeans, OfASummaryAreOverOneWindow) {
    const RunReport report = run_of_rigid_pins({"run.output_interval=20 us"});
    const SpanMeans& m = report.whole;
    EXPECT_NEAR(m.torque[0] * m.speed[0], m.input, 1e-3 * m.input);  // clamping brings and takes a little
    EXPECT_NEAR(-m.torque[1] * m.speed[1], m.taken, 1e-3 * m.input);
    EXPECT_NEAR(m.input - m.taken - m.lost, m.stored * m.input, 1e-9 * m.input);
    EXPECT_NEAR(1.0 - m.lost / m.input, m.efficiency, 1e-12);
    EXPECT_THAT(summary(report), testing::HasSubstr("lost"));
    EXPECT_THAT(summary(report), testing::HasSubstr("out/in"));
}

constexpr double period = 7e-4, pins = 80.0;  // [s], [1]
constexpr SteadyRule one_percent{0.01, 20.0 * pins, pins, 1.0};

/// A machine at 100 rad/s whose tight tension is a function of time [N]; everything else is constant.
template <class Tension>
RunMeans means_of(const Tension& tension, double until, const SteadyRule& rule = one_percent, double pin_period = period,
                  double slip_rate = 0.0, double slip = 0.003) {
    RunMeans means;
    means.seek_steady(rule);
    for (double time = 0.0; time <= until && !means.ended(); time += period / 10.3) {  // samples lie at no fixed place of a period
        model::Observation now;
        now.time = time;
        now.ratio = 1.0;
        now.speed = {100.0, 100.0};
        now.tight = tension(time);
        now.slack = 500.0;
        now.slip = now.friction_slip = slip + slip_rate * time + 0.01 * slip * std::sin(3000.0 * time);
        now.clamping = {25e3, 20e3};
        EnergySums sums;
        sums.time = time;
        sums.work = {1e4 * time, -9.8e3 * time};
        sums.loss[0] = 200.0 * time;
        means.add(now, sums, pin_period);
    }
    return means;
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
    EXPECT_NEAR(means.all().tight, 2000.0, 0.2);                       // a hundredth of the ripple's amplitude, over a sample at each end
    EXPECT_NEAR(means.all().end, 3.0 * pins * period, 16.0 * period);  // after three revolutions, at the first of checks every sixteenth
    EXPECT_NEAR(means.all().begin, 0.5 * means.all().end, 8.0 * period);
    EXPECT_NEAR(means.all().periods * period, means.all().end - means.all().begin, 1e-9);
    EXPECT_LT(means.steady().alternation, 1e-4);
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

TEST(SteadyMeans, OfAGrowingAlternationAreNotSteady) {
    const auto alternating = [](double growth) {
        return means_of(
            [=](double time) { return 2000.0 + ripple(time) + 4.0 * std::exp(growth * time) * std::sin(std::numbers::pi * time / period); },
            0.6, {0.01, 10.0 * pins, pins, 1.0});
    };
    const RunMeans constant = alternating(0.0), growing = alternating(3.0);
    EXPECT_FALSE(constant.steady_fault());
    EXPECT_NEAR(constant.steady().alternation, 4.0 / 2000.0, 0.05 * 4.0 / 2000.0);  // ten samples per period see sin x/x at pi/20
    EXPECT_TRUE(growing.ended());
    EXPECT_TRUE(growing.steady().grows);
    EXPECT_EQ(growing.steady_fault().kind, FaultKind::not_steady);
    EXPECT_THAT(growing.steady_fault().message(), testing::HasSubstr("swing from pin to pin"));
}

/// A swing that is no multiple of half the pin frequency, as two modes of a strand have. One that stays as it is has a mean.
TEST(SteadyMeans, OfAGrowingSwingAreNotSteady) {
    const auto swinging = [](double growth) {
        return means_of(
            [=](double time) {
                return 2000.0 + ripple(time) + 6.0 * std::exp(growth * time) * std::sin(0.56 * std::numbers::pi * time / period);
            },
            0.6, {0.01, 10.0 * pins, pins, 1.0});
    };
    EXPECT_FALSE(swinging(0.0).steady_fault());
    EXPECT_GT(swinging(0.0).steady().swing, 1e-3);
    const RunMeans growing = swinging(4.0);
    EXPECT_TRUE(growing.steady().grows);
    EXPECT_FALSE(growing.steady().alternation > 1e-3);
    EXPECT_THAT(growing.steady_fault().message(), testing::HasSubstr("swing from pin to pin"));
}

/// Control with an integral time of 0.2 s has 0.3 % to go: by the line through the means alone, an early end has a tenth of that left.
TEST(SteadyMeans, OfARatioThatIsHeldAreAtItsTarget) {
    const auto ending = [](bool holds) {
        RunMeans means;
        means.seek_steady({0.01, 60.0 * pins, pins, 1.0, holds});
        for (double time = 0.0; !means.ended(); time += period / 10.3) {
            model::Observation now;
            now.time = time;
            now.ratio = 1.4 * (1.0 + 0.003 * std::exp(-time / 0.2));
            now.control = {1.4, now.ratio};
            now.speed = {100.0, 100.0};
            now.tight = 2000.0;
            EnergySums sums;
            sums.time = time;
            sums.work = {1e4 * time, -9.8e3 * time};
            sums.loss[0] = 200.0 * time;
            means.add(now, sums, period);
        }
        return means;
    };
    const RunMeans free = ending(false), held = ending(true);
    EXPECT_GT(std::abs(free.all().ratio - 1.4), 0.001 * 1.4);  // steady to 1 %
    EXPECT_FALSE(held.steady_fault());
    EXPECT_LE(held.steady().error[0].sum(), 0.001 * 1.4);
    EXPECT_LE(std::abs(held.all().ratio - 1.4), held.steady().error[0].sum());
}

TEST(SteadyMeans, OfAChainThatSlidesEndEarly) {
    const SteadyRule rule{0.01, 16.0 * pins, pins, 1.0};
    const RunMeans sliding = means_of([](double) { return 2000.0; }, 10.0, rule, period, 1.0),
                   backwards = means_of([](double) { return 2000.0; }, 10.0, rule, period, -1.0),
                   creeping = means_of([](double) { return 2000.0; }, 10.0, rule, period, 0.1);
    EXPECT_GT(sliding.steady().sliding, 0.1);
    EXPECT_GT(backwards.steady().sliding, 0.1);
    EXPECT_EQ(creeping.steady().sliding, 0.0);
    const RunMeans imposed = means_of([](double) { return 2000.0; }, 10.0, rule, period, 0.0, 0.15);
    EXPECT_TRUE(imposed.steady().steady());
    const RunMeans confirming = means_of([](double) { return 2000.0; }, 0.5, {0.0, 1e9, pins, 1.0}, period, 1.0);
    EXPECT_FALSE(confirming.ended());                             // a run without a tolerance has no end of its own
    EXPECT_NEAR(sliding.all().end, 0.097 / 0.875, 9.0 * period);  // the last quarter's mean slip is a tenth; a check each eight periods
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
    EXPECT_NEAR(means.all().end, 8.0 * turn, 0.07 * 8.0 * turn);  // at the first check of those every sixteenth
}

TEST(SteadyMeans, OfAChainAtRestDoNotExist) {
    const RunMeans means = means_of([](double) { return 2000.0; }, 1.0, one_percent, 0.0);
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
            std::vector<double> memory;
            whole.save(memory);
            EXPECT_TRUE(second.load(memory).empty());
        }
        whole.add(now, {now.time, {}, {}}, period);
        if (k >= 500) second.add(now, {now.time, {}, {}}, period);
    }
    ASSERT_TRUE(whole.ended());
    EXPECT_TRUE(second.ended());
    EXPECT_EQ(whole.all().tight, second.all().tight);
    EXPECT_EQ(whole.steady().share, second.steady().share);
}

/// A point far from its limits: what a run states when it ends holds three times as long.
TEST(SteadyRun, StatesErrorsThatThreeTimesItsTimeConfirms) {
    Scene scene = read_scene(find_scene("control"), StartState::ignored);
    apply_detail(scene, "rigid");
    set_values(scene, std::vector<std::string>{"start.state=\"\"", "start.settling_time=30 ms", "run.until=steady", "run.steady=2 %",
                                               "drive.speed=3000 rpm", "run.output_interval=200 us"});
    const RunReport report = run_scene(scene, {});
    ASSERT_EQ(report.status(), "finished") << report.fault.message();
    EXPECT_GT(report.revolutions, 0.45);
    EXPECT_NEAR(report.whole.end, 2.0 * report.whole.begin, 0.1 * report.whole.end);
    EXPECT_THAT(summary(report), testing::HasSubstr("errors of means"));
    set_values(scene, std::vector<std::string>{"run.until=" + std::to_string(3.0 * report.end), "run.max_steps=0"});
    const RunReport longer = run_scene(scene, {});
    const auto& error = report.errors.error;
    const SpanMeans &is = report.whole, &late = longer.last_fifth;
    EXPECT_NEAR(is.tight, late.tight, error[2].sum());
    EXPECT_NEAR(is.slack, late.slack, error[3].sum());
    EXPECT_NEAR(is.clamping[0] / is.clamping[1], late.clamping[0] / late.clamping[1], error[1].sum());
    EXPECT_NEAR(is.friction_slip, late.friction_slip, error[5].sum());
}

}  // namespace
}  // namespace cvtflow::tasks
