#include "bench/study/profile/profile.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <limits>
#include <stdexcept>

#include "bench/count/instructions.hpp"
#include "bench/study/profile/bare_barrier.hpp"
#include "bench/study/profile/counted_work.hpp"
#include "bench/study/profile/measure.hpp"
#include "bench/study/profile/statistics.hpp"
#include "engine/base/provenance.hpp"
#include "engine/executor/catalogue.hpp"
#include "tasks/step/control/energy_ledger.hpp"
#include "tests/claims/operating_point_fixture.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

std::vector<std::string> names(const ScheduleChoice& choice) {
    std::vector<std::string> result;
    for (const Schedule& schedule : chosen_schedules(ready_tiny(), choice)) result.push_back(schedule_name(schedule));
    return result;
}

TEST(ChosenSchedules, BeginWithSerialAndHaveNoneTwice) {
    EXPECT_THAT(names({.names = {"flow:staged", "serial", "flow:staged"}, .threads = {2}}),
                testing::ElementsAre("serial:fused", "flow:staged"));
}

TEST(ChosenSchedules, AreAllExecutorsInBothAssembliesIfNoneIsNamed) {
    EXPECT_EQ(names({.threads = {2}}).size(), 2 * engine::executors().size());
}

TEST(ChosenSchedules, CombineThreadsAndSegments) {
    const auto list = chosen_schedules(ready_tiny(), {.names = {"barrier:fused"}, .threads = {1, 2}, .segments = {0, 6}});
    ASSERT_EQ(list.size(), 5u);
    EXPECT_EQ(list[1].segments, 1);  // as many as threads
    EXPECT_EQ(list[4].threads, 2);
    EXPECT_EQ(list[4].segments, 6);
}

TEST(ChosenSchedules, WaitAndPinAsAsked) {
    const auto list = chosen_schedules(ready_tiny(), {.names = {"barrier"}, .threads = {2}, .wait = engine::Wait::spin, .pin = true});
    EXPECT_EQ(list[0], Schedule{});  // serial has no waiting
    EXPECT_EQ(list[1].wait, engine::Wait::spin);
    EXPECT_TRUE(list[1].pin);
}

TEST(ChosenSchedules, RefuseWhatDoesNotExist) {
    EXPECT_THROW(names({.names = {"flaw"}}), SceneError);
    EXPECT_THROW(names({.names = {"flow:stages"}}), SceneError);
    EXPECT_THROW(names({.names = {"flow"}, .threads = {2}, .segments = {25}}), SceneError);
}

TEST(Profile, IsCrowdedIfNoScheduleGotItsProcessors) {
    Profile profile;
    profile.results.resize(2);
    profile.results[0].loads = {{0, {}, 0.0, 1.0, 1.0, 5, ""}};
    profile.results[1].loads = {{0, {}, 0.0, 0.7, 1.0, 5, ""}};
    EXPECT_FALSE(profile.crowded());  // one thread each, and one processor
    profile.results[0].loads[0].cpu_per_wall = 0.8;
    EXPECT_TRUE(profile.crowded());
}

TEST(Profile, IsCrowdedIfItsCalibrationGotLessThanNineTenths) {
    Profile profile;
    profile.results.resize(1);
    profile.results[0].loads = {{0, {}, 0.0, 1.0, 1.0, 5, ""}};
    for (const auto& [calibrated, crowded] : {std::pair{-1.0, false}, {0.91, false}, {0.89, true}}) {
        profile.calibrated = calibrated;
        EXPECT_EQ(profile.crowded(), crowded) << calibrated;
    }
}

/// The first turns, before those that count, are samples only where they were slow.
TEST(PairedGain, ComparesTurnsOfTheSameRound) {
    const PairedGain gain = paired_gain({9.0, 4.0, 5.0, 8.0}, {2.0, 2.0, 2.0}, {1e-7, 5e-7, 1e-7}, 3);
    EXPECT_EQ(gain.near_rounds, 2);
    EXPECT_DOUBLE_EQ(gain.near.median, 3.0) << "of 4 over 2 and 8 over 2";
    EXPECT_EQ(gain.far_rounds, 1);
    EXPECT_DOUBLE_EQ(gain.far.median, 2.5);
    EXPECT_EQ(paired_gain({1.0}, {}, {}, 1).near_rounds, 0) << "dropped before the first round that counts";
}

TEST(Profile, MeasuresAndFindsEqualStates) {
    MeasureOptions options;
    options.rounds = 2;
    options.steps = 5;
    options.neighbours = {0, 1};
    const auto schedules = chosen_schedules(ready_tiny(), {.names = {"serial:staged", "flow:fused", "flow:staged"}, .threads = {2}});
    const Profile profile = profile_schedules(ready_tiny(), schedules, options);
    EXPECT_THAT(profile.differences, testing::IsEmpty());
    ASSERT_EQ(profile.results.size(), 4u);
    ASSERT_EQ(profile.copies.size(), usable_threads() > 1 ? 1u : 0u);
    for (const CopiesGain& copies : profile.copies) {
        EXPECT_EQ(copies.threads, 2);
        EXPECT_EQ(copies.paired.near_rounds + copies.paired.far_rounds, options.rounds);
        EXPECT_GT(std::max(copies.paired.near.median, copies.paired.far.median), 0.0);
    }
    for (const ScheduleResult& result : profile.results) {
        ASSERT_EQ(result.loads.size(), 2u) << result.name;
        EXPECT_GT(result.loads[0].step.median, 0.0);
        EXPECT_GE(result.loads[0].step.median,
                  3.9 * result.loads[0].evaluation);  // four stages, sometimes a fifth evaluation: time per step ≥ 4 of them
        EXPECT_EQ(result.recording.lost, 0);
        EXPECT_NEAR(result.recording.pass.cycles, 25.0, 15.0);  // five steps of five cycles, and transitions
    }
    EXPECT_EQ(profile.results[0].loads[0].speed_up, 1.0);
    EXPECT_GT(profile.results[2].loads[0].cpu,
              0.0);                      // with a neighbour it is a difference, which half a millisecond of stepping does not resolve
    EXPECT_EQ(profile.bare.size(), 2u);  // of one and of two threads
}

/// A run searches for its automatic step with a hundred evaluations or more, and once more after 1, 2, 4 … ms: here once, after 1 ms.
TEST(Trial, SearchesForItsAutomaticStepOnceAsARunDoes) {
    Trial trial(claims::ready_scene("baseline", {"run.method=leapfrog-sweep"}), Schedule{});
    const auto evaluations = [&] { return trial.simulation().part().step_choice()->evaluations(); };
    EXPECT_EQ(trial.run(50).steps, 50);
    const long first = evaluations();
    EXPECT_GT(first, 100);
    const TrialSample second = trial.run(300);
    EXPECT_EQ(second.steps, 300);
    EXPECT_GE(second.evaluations, 300);
    EXPECT_GT(evaluations(), first) << "began again";
    EXPECT_LT(evaluations(), 3 * first) << "each of its steps is tried anew";
}

TEST(Trial, CountsEveryCallsStepsBeforeAStartHasSettledToo) {
    Trial trial(claims::ready_scene("baseline", {"run.method=leapfrog-sweep", "start.state="}), Schedule{});
    ASSERT_TRUE(trial.simulation().needs_settling());
    for (int call = 0; call < 3; ++call) EXPECT_EQ(trial.run(20).steps, 20) << call;
}

constexpr auto idle = [](void*, int) noexcept {};

/// Three tasks side by side, then one that waits for all of them.
engine::TaskGraph three_and_one() {
    engine::TaskGraph graph;
    for (int item = 0; item < 3; ++item) graph.add({.name = "part", .cycle = 0, .code = idle, .item = item, .accesses = {}});
    graph.add({.name = "close", .cycle = 0, .code = idle, .item = 0, .accesses = {}});
    for (int part = 0; part < 3; ++part) graph.order(part, 3);
    graph.freeze();
    return graph;
}

TEST(CountedWork, ThreadsTakeTheNextTaskThatIsReady) {
    const engine::TaskGraph graph = three_and_one();
    const std::array work{3.0, 4.0, 2.0, 1.0};
    EXPECT_DOUBLE_EQ(makespan(graph, 0, work, 1), 10.0);
    EXPECT_DOUBLE_EQ(makespan(graph, 0, work, 2), 6.0);  // 3 + 2 beside 4, then 1
    EXPECT_DOUBLE_EQ(makespan(graph, 0, work, 3), 5.0);
    EXPECT_DOUBLE_EQ(makespan(graph, 0, work, 9), 5.0) << "threads without a task";
}

TEST(CountedWork, EvenSpeedUpCountsTheLongestSegment) {
    EXPECT_DOUBLE_EQ(even_speed_up(84, 7), 7.0);
    EXPECT_DOUBLE_EQ(even_speed_up(84, 8), 84.0 / 11.0);  // 10 or 11 links each
    EXPECT_DOUBLE_EQ(even_speed_up(84, 64), 42.0);        // some segments have two links
}

/// The numbers of threads at which the published speed-up of the forces rises.
TEST(CountedWork, SegmentsShortenAtThePublishedNumbers) {
    const std::vector<int> numbers = shortening_segments(84);
    EXPECT_EQ(numbers, (std::vector<int>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 17, 21, 28, 42, 84}));
    EXPECT_EQ(shortening_segments(1), std::vector<int>{1});
}

#if defined(__linux__) && defined(__x86_64__)
TEST(CountedWork, CountsInstructionsOneByOne) {
    const std::array<std::function<void()>, 3> bodies{[] { asm volatile("nop"); }, [] { asm volatile("nop; nop; nop; nop"); }, [] {}};
    const std::vector<Counted> counted = count_each(bodies);
    ASSERT_EQ(counted.size(), 3u);
    EXPECT_EQ(counted[1].instructions - counted[0].instructions, 3);
    EXPECT_EQ(counted[2].instructions, 0) << "the call itself does not count";
    const std::array<std::function<void()>, 1> fatal{[] { _exit(3); }};
    EXPECT_TRUE(count_each(fatal).empty());
    const std::array<std::function<void()>, 1> broken{[] { std::raise(SIGSEGV); }};
    EXPECT_THROW((void)count_each(broken), std::runtime_error) << "no property of the system";
}

/// A step counted as a whole is the oracle: a task that runs elsewhere finds other states, other contacts, and has other work.
TEST(CountedWork, OfTasksIsThatOfTheStepTheyAreIn) {
    const Scene scene = claims::ready_scene("tiny", {"run.method=leapfrog-sweep", "run.step=500ns"});
    double tasks = 0.0;
    for (const StageWork& stage : count_work(scene, {1}).stages)
        if (stage.stage == "record" || stage.stage == "friction") tasks += stage.instructions;
    Trial trial(scene, {});
    trial.settle();
    while (trial.simulation().time() < EnergyLedger::dense_time) trial.run(256);
    auto& integrator = const_cast<Integrator&>(trial.simulation().integrator());
    const engine::TaskGraph& graph = integrator.runner().graph();
    const auto step = [&](bool runs) {
        CycleSequence sequence = integrator.method().step();
        for (int cycle = sequence.next(); cycle != engine::Controller::stop; cycle = sequence.next())
            for (const int task : graph.topological(cycle))
                if (runs) graph.call(task)(&integrator.workspace());
    };
    const std::array<std::function<void()>, 2> bodies{[&] { step(true); }, [&] { step(false); }};
    const std::vector<Counted> counted = count_each(bodies);
    ASSERT_EQ(counted.size(), 2u);
    EXPECT_NEAR(tasks / static_cast<double>(counted[0].instructions - counted[1].instructions), 1.0, 0.02)
        << "counted between steps 0.79: the record finds every tip free";
}

/// A smaller share of the work for every segment, and no more than there is.
TEST(CountedWork, OfAStepShrinksWithTheSegments) {
    const CountedWork counted = count_work(claims::ready_scene("tiny", {"run.method=rk4", "run.step=50ns"}), {1, 2});
    ASSERT_GE(counted.rows.size(), 3u);
    EXPECT_DOUBLE_EQ(counted.step, 50e-9);
    EXPECT_DOUBLE_EQ(counted.rows[0].fixed, 1.0);
    EXPECT_GT(counted.rows[1].fixed, 1.3);
    EXPECT_LE(counted.rows[1].fixed, 2.0);
    EXPECT_EQ(counted.rows[2].segments, 2) << "not counted: the next lower number";
    EXPECT_DOUBLE_EQ(counted.rows[2].claimed, counted.rows[1].claimed);
    EXPECT_LE(counted.rows[1].step_fixed, counted.rows[1].fixed) << "sequential tasks do not shrink";
    double evaluation = 0.0;
    for (const StageWork& stage : counted.stages) evaluation = std::max(evaluation, stage.instructions);
    EXPECT_GE(evaluation, counted.rows[1].longest / 2.0);
}
#endif

TEST(Statistics, MedianIsTheMiddleOrTheMeanOfTheMiddleTwo) {
    EXPECT_EQ(median({}), 0.0);
    EXPECT_EQ(median({3.0}), 3.0);
    EXPECT_EQ(median({9.0, 1.0, 2.0}), 2.0);
    EXPECT_EQ(median({4.0, 1.0, 100.0, 2.0}), 3.0);
}

TEST(Statistics, QuartilesEncloseTheMedian) {
    const Spread five = spread({5.0, 1.0, 4.0, 2.0, 3.0});
    EXPECT_EQ(five.lower_quartile, 2.0);
    EXPECT_EQ(five.median, 3.0);
    EXPECT_EQ(five.upper_quartile, 4.0);
    EXPECT_EQ(spread({}).median, 0.0);
    EXPECT_EQ(spread({7.0}).upper_quartile, 7.0);
}

TEST(BareBarrier, TakesTimeAndIsGivenUpWhereAThreadKeepsTheCallerWaiting) {
    EXPECT_GT(bare_barrier_cycle(1, 1e-3, 1.0), 0.0);
    const double two = bare_barrier_cycle(2, 1e-3, 10.0);
    EXPECT_GT(two, 1e-9);
    EXPECT_LT(two, 10.0);
    const int crowd = 2 * engine::usable_processors() + 2;  // one of them always waits for a processor
    EXPECT_EQ(bare_barrier_cycle(crowd, 1e-3, 0.2e-3), std::numeric_limits<double>::infinity());
}

}  // namespace

}  // namespace cvtflow::bench
