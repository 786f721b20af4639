#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <regex>
#include <string>
#include <vector>

#include "tasks/run/run.hpp"
#include "tasks/run/run_means.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

/// Means over the outputs 0 … `last`, an interval apart [s], of a machine at a ratio of one; `fill` sets what they have besides.
template <class Fill>
RunMeans means_over(int last, double interval, double pin_period, const Fill& fill) {
    RunMeans means;
    for (int k = 0; k <= last; ++k) {
        model::Observation now;
        now.time = interval * k;
        now.speed = {200.0, 200.0};
        now.tight = now.slack = 100.0;
        EnergySums sums;
        sums.time = now.time;
        fill(k, now, sums);
        means.add(now, sums, pin_period);
    }
    return means;
}

std::string names_of(const RunMeans& means, const EnergyBalance& balance = {}) {
    std::string names;
    name_notes(means, balance, names);
    return names;
}

/// Text of a note; empty if there is none.
std::string note_of(const RunMeans& means, const char* name) {
    const std::vector<Note> found = notes(means, {});
    const auto note = std::ranges::find(found, name, &Note::name);
    return note == found.end() ? "" : note->text;
}

TEST(RunMeans, AreOverWholePinPeriodsAndSayWhatIsOdd) {
    // More outputs than bins: 100 ms of a chain that begins to slide.
    RunMeans means = means_over(5000, 2e-5, 7e-4, [](int k, model::Observation& now, EnergySums& sums) {
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
    EnergyBalance balance{.work = 20.0, .loss = 20.0, .energy_in = 1e3, .stored = 4.0, .samples = 100.0};
    EXPECT_EQ(names_of(means, balance), "gross_slip unsteady");
    balance.loss = 0.05;  // 1e-5 of what came in are a fifth of it
    EXPECT_EQ(names_of(means, balance), "gross_slip unsteady unresolved");
    std::vector<std::byte> memory;
    engine::write_fields(memory, [&](auto& archive) { means.visit(archive); });
    RunMeans again;
    engine::read_fields(memory, [&](auto& archive) { again.visit(archive); });
    EXPECT_EQ(again.all().slip, means.all().slip);
}

/// One sample above the limit of clamping is enough.
TEST(RunMeans, SayWhereClampingWasAboveItsLimit) {
    for (const double most : {0.99, 1.01}) {
        const RunMeans means =
            means_over(1000, 1e-3, 1e-3, [&](int k, model::Observation& now, EnergySums&) { now.limit_use = k == 500 ? most : 0.5; });
        EXPECT_EQ(note_of(means, "clamping_limit").empty(), most < 1.0);
        EXPECT_NEAR(means.all().beyond, most > 1.0 ? 1e-3 : 0.0, 2e-6);  // a sample's share of the time
    }
}

/// A second that begins to drive away: 5 % for a tenth of it. Half of that is no more than a chain that is loaded well.
TEST(RunMeans, SayWhereTheChainSlippedAtAnyTime) {
    for (const double slip : {0.05, 0.025}) {
        const RunMeans means =
            means_over(1000, 1e-3, 1e-3, [&](int k, model::Observation& now, EnergySums&) { now.slip = k < 100 ? slip : 0.002; });
        EXPECT_EQ(note_of(means, "gross_slip"), slip > 0.03 ? "the chain slips by 5 % from 0.02 to 0.04 s" : "") << slip;
    }
}

/// A ratio of 1.4 that control changes to 1.36, or to 1.39.
TEST(RunMeans, SayWhereControlMissesItsTarget) {
    for (const double ratio : {1.36, 1.39}) {
        const RunMeans means = means_over(1000, 1e-3, 1e-3, [&](int, model::Observation& now, EnergySums&) {
            now.speed = {200.0, 200.0 / ratio};
            now.control = {1.4, ratio};
        });
        EXPECT_EQ(note_of(means, "target_missed"), ratio < 1.38 ? "control misses its target by -2.86 % in the last fifth" : "") << ratio;
    }
}

/// Shaft 2 is at rest, then turns half as fast as shaft 1: four turns to one, where the ratio of most instants is infinite.
TEST(RunMeans, HaveARatioWhereAShaftIsAtRestAtFirst) {
    const RunMeans means = means_over(1000, 1e-3, 1e-3, [](int k, model::Observation& now, EnergySums&) {
        now.speed = {200.0, k < 500 ? 0.0 : 100.0};
        now.ratio = now.speed[0] / now.speed[1];
    });
    EXPECT_NEAR(means.all().ratio, 4.0, 4.0 * 2e-3);  // a sample is 2e-3 of the time in which it turns
    EXPECT_NEAR(means.fifth(4).ratio, 2.0, 1e-12);
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
        std::vector<std::byte> memory;
        engine::write_fields(memory, [&](auto& archive) { means.visit(archive); });
        RunMeans again;
        engine::read_fields(memory, [&](auto& archive) { again.visit(archive); });
        EXPECT_EQ(note_of(again, "cycle_missed"),
                  last == 130
                      ? ""
                      : "the machine misses its cycle: speed of shaft 2 is off by 2.51 % on average, its work by -2.51 %; most at t = "
                        "0.12 s, where its speed is off by -60 %");
    }
    EXPECT_FALSE(means_over(1000, 1e-3, 1e-3, [](int, model::Observation&, EnergySums&) {}).all().cycle_missed()) << "without a cycle";
}

/// A force of 20 kN that control moves: a swing, and one step, whose standard deviation over the last fifth is as large.
TEST(RunMeans, SayWhereAControlledForceSwings) {
    const auto swings = [](const auto& force) {
        const RunMeans means = means_over(5000, 2e-4, 4e-3, [&](int k, model::Observation& now, EnergySums&) {
            now.control = {1.0, 1.0, {force(k), 0.0}};
        });
        return !note_of(means, "control_swing").empty();
    };
    const auto sine = [](double amplitude) { return [=](int k) { return 20e3 + amplitude * std::sin(0.1 * k); }; };
    EXPECT_TRUE(swings(sine(1.5e3))) << "sd 5.3 %";
    EXPECT_FALSE(swings(sine(1.3e3))) << "sd 4.6 %";
    EXPECT_FALSE(swings([](int k) { return k < 4500 ? 20e3 : 23e3; })) << "sd 7 % of the last fifth";
    EXPECT_FALSE(swings([](int) { return 0.0; })) << "without control";
}

/// Where a load drives, the strand that the driving sheaves pull is the loose one.
TEST(RunMeans, SayWhereEitherStrandIsLoose) {
    for (const bool driven : {false, true}) {
        const RunMeans means = means_over(1000, 1e-3, 1e-3, [&](int, model::Observation& now, EnergySums&) {
            now.tight = driven ? 0.0 : 100.0;
            now.slack = driven ? 100.0 : 0.0;
        });
        EXPECT_THAT(note_of(means, "slack_strand"), testing::StartsWith(driven ? "the tight strand" : "the slack strand"));
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
    return names_of(means, {.work = 240.0, .loss = 90.0, .energy_in = 250.0, .samples = 100.0});
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

std::string names_when_closed(const RunMeans& means) { return names_of(means, closed_balance); }

TEST(RunMeans, OfAStateThatStoresOrGivesEnergyAreNotSteady) {
    EXPECT_EQ(names_when_closed(means_once_steady(10000.0, 9900.0)), "");
    EXPECT_EQ(names_when_closed(means_once_steady(10000.0, 9600.0)), "unsteady") << "3 % of the input are stored";
    EXPECT_EQ(names_when_closed(means_once_steady(6000.0, 9600.0)), "unsteady") << "the load is carried by what moves";
    EXPECT_THAT(notes(means_once_steady(6000.0, 9600.0), closed_balance).front().text,
                testing::HasSubstr("the stored energy has given 61.7 % of the input"));
    EXPECT_EQ(names_when_closed(means_once_steady(10000.0, 9900.0, 0.2)), "unsteady") << "half a pin period";
    const RunMeans coasting = means_once_steady(90.0, 20.0);
    EXPECT_TRUE(std::isnan(coasting.all().efficiency)) << "-11 %";
    EXPECT_EQ(names_when_closed(coasting), "efficiency unsteady no_load");
    EXPECT_EQ(notes(coasting, closed_balance).front().text,
              "there is no efficiency: 100 W are lost of 90 W that come in (100 of 90 W in the last fifth), and what moves gives the rest");
}

TEST(RunMeans, WithoutLoadThereIsNoEfficiency) {
    const RunMeans means = means_once_steady(100.0, 0.0);
    EXPECT_TRUE(std::isnan(means.all().efficiency));
    EXPECT_EQ(names_when_closed(means), "no_load");
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
    EXPECT_EQ(names_when_closed(rising_means(0.0, 0.0)), "");
    EXPECT_EQ(names_when_closed(rising_means(0.005, 0.0)), "");
    EXPECT_EQ(names_when_closed(rising_means(0.0, 0.003)), "") << "little scatter";
    EXPECT_EQ(names_when_closed(rising_means(0.0, 0.04)), "uncertain") << "scatter";
    EXPECT_EQ(names_when_closed(rising_means(0.01, 0.02)), "uncertain") << "a change that scatter hides";
    EXPECT_EQ(names_when_closed(rising_means(0.02, 0.0)), "unsteady");
    EXPECT_EQ(names_when_closed(rising_means(-0.02, 0.0)), "unsteady");
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
        EXPECT_EQ(names_when_closed(means), rails > 8.0 ? "uncertain" : "");
    }
}

TEST(RunMeans, OfThreePinPeriodsDoNotShowTheirErrors) {
    EXPECT_EQ(names_when_closed(means_once_steady(10000.0, 9900.0, 0.03)), "uncertain");
    EXPECT_EQ(names_when_closed(means_once_steady(10000.0, 9900.0, 0.02)), "");
}

RunReport run_of_rigid_pins(const std::vector<std::string>& settings) {
    return run_scene(scene_of("baseline", "rigid", {"start.settling_time=10 ms", "run.until=20 ms", "run.state_interval=10 ms"}, settings),
                     {});
}

/// Advice of notes: settings "key=value" in their texts.
std::vector<std::string> advice_of(const RunReport& report, std::string_view of = "") {
    static const std::regex setting(R"([a-z]+\.[a-z_]+=\w+)");
    std::vector<std::string> advice;
    for (const Note& note : report.notes)
        for (std::sregex_iterator found(note.text.begin(), note.text.end(), setting); found != std::sregex_iterator(); ++found)
            if (of.empty() || note.name == of) advice.push_back(found->str());
    return advice;
}

bool has_note(const RunReport& report, std::string_view name) {
    return std::ranges::any_of(report.notes, [&](const Note& note) { return note.name == name; });
}

/// A note with advice is gone where the advice is followed, also near the limit of what the clamping forces carry, where slip is least
/// known; a run that ends once it is steady, or whose inputs change, gets none of the kind that it cannot follow.
TEST(RunMeans, GiveAdviceThatRemovesTheirNotes) {
    const auto run = [](std::vector<std::string> settings, const std::vector<std::string>& more) {
        settings.insert(settings.end(), more.begin(), more.end());
        return run_scene(
            scene_of("control", "rigid", {"control.gains=found", "control.authority=30 kN", "start.settling_time=20 ms"}, settings), {});
    };
    for (const auto& [name, settings] : {std::pair{"uncertain", std::vector<std::string>{"load.torque=165", "run.until=2 ms"}},
                                         {"clamping_floor", {"clamping.safety=1.2", "run.until=10 ms"}}}) {
        const RunReport report = run(settings, {});
        const std::vector<std::string> advice = advice_of(report, name);
        ASSERT_EQ(advice.size(), 1U) << name << "\n" << summary(report);
        const RunReport followed = run(settings, advice);
        EXPECT_FALSE(followed.fault || has_note(followed, name)) << advice[0] << "\n" << summary(followed);
        EXPECT_EQ(advice_of(followed, "uncertain").size(), 0U) << summary(followed);
    }
    const RunReport changes = run({"run.until=2 ms", "load.torque=[[0, 165], [\"2 ms\", 165.1]]"}, {});
    EXPECT_TRUE(has_note(changes, "uncertain")) << summary(changes);
    EXPECT_EQ(advice_of(changes).size(), 0U) << summary(changes);
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
    EXPECT_THAT(summary(report), testing::HasSubstr("errors of means"));
}

}  // namespace
}  // namespace cvtflow::tasks
