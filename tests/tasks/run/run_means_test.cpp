#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "bench/study/run_watch.hpp"
#include "tasks/run/run.hpp"
#include "tasks/run/run_means.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tests/tasks/settled_tiny_fixture.hpp"

namespace cvtflow::tasks {

namespace {

TEST(RunMeans, AreOverWholePinPeriodsAndSayWhatIsOdd) {
    RunMeans means;
    for (int k = 0; k <= 5000; ++k) {  // more outputs than bins: 100 ms of a chain that begins to slide
        model::Observation now;
        now.time = 2e-5 * k;
        now.ratio = 1.0;
        now.speed = {200.0, 200.0};
        now.slip = k < 2500 ? 0.002 : 0.1;
        now.slack = 100.0;
        EnergySums sums;
        sums.time = now.time;
        sums.work[0] = 1e4 * now.time;
        sums.work[1] = -9.8e3 * now.time;
        sums.loss[0] = 200.0 * now.time;
        means.add(now, sums, 7e-4);
    }
    const SpanMeans whole = means.all();  // of the last 142 pin periods
    EXPECT_NEAR(whole.end - whole.begin, 142 * 7e-4, 1e-12);
    EXPECT_NEAR(whole.slip, (0.002 * (0.05 - whole.begin) + 0.1 * 0.05) / (0.1 - whole.begin), 1e-4);  // a sample is 1e-4 of it
    EXPECT_NEAR(means.last_fifth().slip, 0.1, 1e-12);                                                  // rounding of sums of thousands
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
        RunMeans means;
        for (int k = 0; k <= 1000; ++k) {
            model::Observation now;
            now.time = 1e-3 * k;
            now.limit_use = k == 500 ? most : 0.5;
            means.add(now, {}, 1e-3);
        }
        std::string names;
        name_notes(means, {}, names);
        EXPECT_EQ(names.find("clamping_limit") != std::string::npos, most > 1.0) << names;
        EXPECT_NEAR(means.all().beyond, most > 1.0 ? 1e-3 : 0.0, 2e-6);  // a sample's share of the time
    }
}

/// A ratio of 1.4 that control brings to 1.36, or to 1.39.
TEST(RunMeans, SayWhereControlMissesItsTarget) {
    for (const double ratio : {1.36, 1.39}) {
        RunMeans means;
        for (int k = 0; k <= 1000; ++k) {
            model::Observation now;
            now.time = 1e-3 * k;
            now.speed = {200.0, 200.0 / ratio};
            now.control = {1.4, ratio};
            means.add(now, {}, 1e-3);
        }
        const std::vector<Note> found = notes(means, {});
        const auto missed = std::ranges::find(found, "target_missed", &Note::name);
        EXPECT_EQ(missed != found.end(), ratio < 1.38) << ratio;
        if (missed == found.end()) continue;
        EXPECT_EQ(missed->text, "control misses its target by -2.86 % in the last fifth");
    }
}

/// 1 s of a machine that carries nothing. speed of its shafts [rad/s]
std::string notes_of_idling(double speed) {
    RunMeans means;
    for (int k = 0; k <= 1000; ++k) {
        model::Observation now;
        now.time = 1e-3 * k;
        now.ratio = 1.0;
        now.speed = {speed, -speed};
        now.slip = k % 2 == 0 ? 0.4 : -0.3;
        now.slack = 100.0;
        EnergySums sums;
        sums.time = now.time;
        sums.work = {100.0 * now.time, -10.0 * now.time, 150.0 * now.time};  // clamping brings energy, what moves keeps it
        sums.loss[0] = 90.0 * now.time;
        means.add(now, sums, 1e-3);
    }
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
    RunMeans means;
    for (int k = 0; k <= 5000; ++k) {
        model::Observation now;
        now.time = 2e-5 * k;
        now.ratio = 1.0;
        now.speed = {200.0, -200.0};
        now.slack = 100.0;
        EnergySums sums;
        sums.time = now.time;
        sums.work[0] = drive * now.time;
        sums.work[1] = -load * now.time;
        sums.work[2] = -cylinder * now.time;
        sums.loss[0] = 100.0 * now.time;
        means.add(now, sums, pin_period);
    }
    return means;
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
}

TEST(RunMeans, WithoutLoadThereIsNoEfficiency) {
    const RunMeans means = means_once_steady(100.0, 0.0);
    EXPECT_TRUE(std::isnan(means.all().efficiency));
    EXPECT_EQ(names_of(means), "no_load");
    EXPECT_TRUE(std::isnan(means_once_steady(120.0, 0.0, 7e-4, 20.0).all().efficiency)) << "what a cylinder takes is no load";
}

/// 28 pin periods, a hundred samples in each, whose tight tension swings by a third and its mean rises by `rise` in all.
RunMeans rising_means(double rise, double noise) {
    RunMeans means;
    constexpr double period = 7e-4, samples = 100.0, periods = 28.0;
    for (int k = 0; k <= static_cast<int>(samples * periods); ++k) {
        model::Observation now;
        const double passed = static_cast<double>(k) / samples, share = passed / periods;
        now.time = passed * period;
        now.ratio = 1.0;
        now.speed = {200.0, -200.0};
        now.slack = 2000.0;
        now.clamping = {27e3, 20e3};
        const double jitter = noise * std::sin(0.93 * std::floor(passed) * std::floor(passed));
        now.tight = 5000.0 * (1.0 + rise * share + jitter + std::sin(2.0 * std::numbers::pi * passed) / 3.0);
        EnergySums sums;
        sums.time = now.time;
        sums.work = {1e4 * now.time, -9.9e3 * now.time, 0.0};
        sums.loss[0] = 100.0 * now.time;
        means.add(now, sums, period);
    }
    return means;
}

/// A value that moves by more than 1 % has no mean to 1 %. The swing of pins and scatter from period to period are not a movement.
TEST(RunMeans, AreUnsteadyWhereOneStillMovesByMoreThanAPerCent) {
    EXPECT_EQ(names_of(rising_means(0.0, 0.0)), "");
    EXPECT_EQ(names_of(rising_means(0.005, 0.0)), "");
    EXPECT_EQ(names_of(rising_means(0.0, 0.02)), "") << "scatter";
    EXPECT_EQ(names_of(rising_means(0.02, 0.0)), "unsteady");
    EXPECT_EQ(names_of(rising_means(-0.02, 0.0)), "unsteady");
    EXPECT_THAT(notes(rising_means(0.02, 0.0), closed_balance).front().text,
                testing::HasSubstr("change of tight tension from begin to end 1.98 %"));
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

class Watching final : public RunObserver {
public:
    explicit Watching(const Simulation& simulation) : observer_(simulation.workspace().variator) {}
    void output(double time, const Workspace& workspace, const Counters&) override {
        watch.add(workspace.observed_by(observer_, time), workspace);
    }
    void transition(const TransitionRecord&) override {}
    bench::RunWatch watch;

private:
    model::Observer observer_;
};

bench::WatchResult watched(const std::vector<std::string>& settings, double duration) {
    Simulation simulation(test::settled_tiny(settings));
    Watching observer(simulation);
    const engine::Cancellation never;
    EXPECT_FALSE(simulation.advance({.until = simulation.time() + duration}, observer, never));
    return observer.watch.result(simulation.workspace().energy, simulation.balance_error_ratio());
}

TEST(RunWatch, KnowsHowLongARunWasInPinPeriods) {
    const bench::WatchResult brief = watched({}, 100e-6);
    EXPECT_NEAR(brief.duration, 100e-6, 1e-12);
    ASSERT_GT(brief.pin_period, 0.0);
    EXPECT_DOUBLE_EQ(brief.pin_periods(), brief.duration / brief.pin_period);
    EXPECT_FALSE(brief.long_enough());
    bench::WatchResult longer = brief;
    longer.duration = bench::enough_pin_periods * brief.pin_period;
    EXPECT_TRUE(longer.long_enough());
}

TEST(RunWatch, NothingThatPassesAPulleyNeedsNoPinPeriods) {
    const bench::WatchResult none;
    EXPECT_EQ(none.pin_periods(), 0.0);
    EXPECT_TRUE(none.long_enough());
}

/// At this state the classical method is stable up to 0.7 us.
TEST(RunWatch, CallsAStepBeyondStabilityUnreliable) {
    EXPECT_EQ(watched({"run.step=50ns"}, 600e-6).status({}), "finished");
    const bench::WatchResult wrong = watched({"run.method=rk4", "run.step=2us"}, 600e-6);
    EXPECT_FALSE(wrong.reliable());
    EXPECT_EQ(wrong.status({}), "unreliable");
    EXPECT_EQ(wrong.status({FaultKind::penetration, 0.0, 0, 0.0, 0.0}), "penetration") << "a fault is more specific";
}

TEST(RunWatch, LossesDoNotDependOnWhereTheLastSampleLay) {
    // Samples lie 16 steps apart: at 25 ns and 200 ns they end at most 3.2 us before the run, a thirtieth of it.
    const double fine = watched({"run.step=25ns"}, 100e-6).loss, coarse = watched({"run.step=200ns"}, 100e-6).loss;
    EXPECT_NEAR(coarse / fine, 1.0, 2e-3);
}

}  // namespace

}  // namespace cvtflow::tasks
