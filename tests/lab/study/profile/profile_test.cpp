#include "bench/study/profile/profile.hpp"

#include <gmock/gmock.h>

#include "engine/executor/catalogue.hpp"
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
    EXPECT_FALSE(profile.predicts()) << "no model was made";
}

TEST(Trial, EndsAtItsTimeout) {
    Trial trial(ready_tiny(), Schedule{});
    const TrialSample sample = trial.run(1000000, 0.001);
    EXPECT_LT(sample.steps, 1000000);
    EXPECT_GT(sample.wall, 0.001);
    EXPECT_EQ(trial.run(3).steps, 3);  // and can continue
}

TEST(Profile, MeasuresAndFindsEqualStates) {
    MeasureOptions options;
    options.rounds = 2;
    options.steps = 5;
    options.neighbours = {0, 1};
    options.predict_crowded = true;  // whatever else runs here
    const auto schedules = chosen_schedules(ready_tiny(), {.names = {"serial:staged", "flow:fused", "flow:staged"}, .threads = {2}});
    const Profile profile = profile_schedules(ready_tiny(), schedules, options);
    EXPECT_THAT(profile.differences, testing::IsEmpty());
    ASSERT_EQ(profile.results.size(), 4u);
    for (const ScheduleResult& result : profile.results) {
        ASSERT_EQ(result.loads.size(), 2u) << result.name;
        EXPECT_GT(result.loads[0].step.median, 0.0);
        EXPECT_GE(result.loads[0].step.median,
                  3.9 * result.loads[0].evaluation);  // four stages, sometimes a fifth evaluation: time per step ≥ 4 of them
        EXPECT_EQ(result.recording.lost, 0);
        EXPECT_NEAR(result.recording.pass.cycles, 25.0, 15.0);  // five steps of five cycles, and transitions
    }
    EXPECT_EQ(profile.results[0].loads[0].speed_up, 1.0);
    for (const ScheduleResult& result : profile.results)
        EXPECT_GT(result.predicted, 0.0) << result.name;    // staged ones too: serial:staged is there
    EXPECT_NEAR(profile.results[0].predicted, 1.0, 1e-12);  // serial by definition
    EXPECT_GT(profile.results[2].loads[0].cpu,
              0.0);                      // with a neighbour it is a difference, which half a millisecond of stepping does not resolve
    EXPECT_EQ(profile.bare.size(), 2u);  // of one and of two threads
    EXPECT_GT(profile.model.costs.free, 0.0);
    EXPECT_GT(profile.model.serial_step, 0.0);
    EXPECT_EQ(profile.model.curves.size(), 24u);
}

}  // namespace
}  // namespace cvtflow::bench
