/// Runs whose schedule changes on the way.

#include "tasks/schedule/schedule_runner.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "tasks/method/method.hpp"
#include "tasks/schedule/schedule.hpp"
#include "tests/claims/operating_point_fixture.hpp"
#include "tests/engine/allocation_fixture.hpp"
#include "tests/engine/executor/executor_fixture.hpp"
#include "tests/sample_fixture.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::tasks {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

/// Scene with a settled state of the full chain, and transitions.
Scene settled(const std::vector<std::string>& settings = {}, const std::string& name = "low") {
    Scene scene = claims::ready_scene(
        name, {"run.method=rk4", "run.step=50 ns", "run.until=60 us", "run.output_interval=20 us", "run.state_interval=20 us"});
    set_values(scene, settings);
    return scene;
}

/// A turn for each candidate every few steps, for ever.
ChooserOptions restless() {
    ChooserOptions options;
    options.window = 0.0;
    options.first_period = options.longest_period = 0.0;
    return options;
}

const std::string parallel = engine::test::parallel_executor;

std::vector<Schedule> mixed() {
    const Assembly other = test::assemblies().back();
    return {Schedule{},
            {parallel, {Assembly::fused}, 2, 2},
            {parallel, {Assembly::fused}, 9, 2, true},
            {test::has_laboratory() ? "barrier" : parallel, {other}, 5, 2},
            {"serial", {other}, 84, 1},
            {parallel, {other, false, false}, 3, 2, true}};
}

struct RunnerOutcome {
    std::uint64_t hash;
    Counters counters;
    long pauses, repartitions;
};

RunnerOutcome runner_outcome(const Scene& scene, const std::vector<Schedule>& candidates, const ChooserOptions& options) {
    Simulation simulation(scene, candidates, options);
    EXPECT_FALSE(go(simulation, {.until = scene.run.until}));
    return {simulation.hash(), simulation.counters(), simulation.integrator().runner().pause_count(),
            simulation.integrator().runner().repartition_count()};
}

TEST(ScheduleRunner, ChangingTheScheduleEveryFewStepsDoesNotChangeTheBits) {
    for (const std::vector<std::string>& settings : {std::vector<std::string>{}, {"detail.stick_slip=true"}}) {
        const Scene scene = settled(settings);
        const RunnerOutcome serial = runner_outcome(scene, {Schedule{}}, {});
        const RunnerOutcome changing = runner_outcome(scene, mixed(), restless());
        EXPECT_GT(serial.counters.detected, 0) << "the run should cross transitions";
        EXPECT_EQ(serial.pauses, 0);
        EXPECT_GT(changing.pauses, serial.counters.steps / 12);  // every four to eight steps
        EXPECT_EQ(changing.hash, serial.hash);
        EXPECT_EQ(changing.counters, serial.counters);
    }
}

TEST(ScheduleRunner, BordersFollowTheLinksThatTouch) {
    // The chain moves a pitch in 0.7 ms. Most numbers of segments leave the longest no shorter with other borders within 0.3 ms; nine do,
    // but for vectors of two links, with which no number does within 0.8 ms.
    Scene scene = settled({"run.until=300 us", "run.output_interval=100 us", "run.state_interval=100 us"}, "baseline");
    const std::vector<Schedule> balanced{{parallel, {Assembly::fused}, 9, 2, true}};
    ChooserOptions options;
    options.window = 0.0;
    const RunnerOutcome moved = runner_outcome(scene, balanced, options);
    EXPECT_EQ(moved.repartitions > 0, model::lanes_of(model::chosen_isa()) > 2);
    EXPECT_EQ(moved.hash, runner_outcome(scene, {Schedule{}}, {}).hash);
}

/// While tips reach the sheaves, borders also move after a step has begun.
TEST(ScheduleRunner, BordersThatMoveWhileTheChainSettlesDoNotChangeTheBits) {
    const Scene scene = scene_of("overdrive", "fine", {"drive.speed=5900 rpm", "start.settling_time=1.5 ms", "start.ramp_time=1 ms"});
    ChooserOptions options;
    options.window = 0.0;
    const std::vector<Schedule> balanced{{"serial", {Assembly::fused}, 4, 1, true}};
    Simulation moved(scene, balanced, options), serial(scene, {Schedule{}}, {});
    settle_and_go(moved, 1e-5);
    settle_and_go(serial, 1e-5);
    EXPECT_GT(moved.integrator().runner().repartition_count(), 0);
    EXPECT_EQ(moved.hash(), serial.hash());
}

/// Other segments between steps leave the bits of these methods as they are.
void expect_bits_with_changing_segments(const std::vector<std::string>& methods) {
    for (const std::string& method : methods) {
        Scene scene = ready_tiny();
        if (!objection_to(method, scene.parameters).empty()) continue;  // rigid pins, which are one segment
        scene.run.method = method;
        scene.run.step = 1e-8;  // within every method's stability
        std::uint64_t expected = 0;
        for (const std::vector<Schedule>& candidates :
             {std::vector{Schedule{}}, std::vector{Schedule{}, Schedule{parallel, {test::assemblies().back()}, 5, 2},
                                                   Schedule{"serial", {Assembly::fused}, 24, 1}}}) {
            Simulation simulation(scene, candidates, restless());
            EXPECT_EQ(go(simulation, {.steps = 30}).kind, FaultKind::max_steps) << method;
            if (candidates.size() == 1) expected = simulation.hash();
            EXPECT_EQ(simulation.hash(), expected) << method;
            EXPECT_EQ(simulation.integrator().runner().pause_count() > 0, candidates.size() > 1);
        }
    }
}

TEST(ScheduleRunner, ChangingSegmentsBetweenStepsLeavesTheBitsOfAMethod) {
    expect_bits_with_changing_segments(cvtflow::test::sample(method_names(), cvtflow::test::depth(3, 10), "changing segments"));
}

TEST(NightlyScheduleRunner, ChangingSegmentsBetweenStepsLeavesTheBitsOfEveryMethod) { expect_bits_with_changing_segments(method_names()); }

TEST(ScheduleRunner, AllocatesNothingBetweenRests) {
    if (engine::test::allocation_count() < 0) GTEST_SKIP() << "a sanitizer owns malloc";
    Scene scene = settled({"run.until=150 us"});
    scene.run.output_interval = 8.0 * scene.run.step;
    ChooserOptions options = restless();
    options.window = 2e-3;  // some outputs
    Simulation simulation(scene, std::vector<Schedule>{Schedule{}, {parallel, {test::assemblies().back()}, 5, 2}}, options);
    long outputs = 0, rests = 0, before = 0, quiet = 0, allocations = 0;
    Outputs counter([&](double, const Workspace&, const Counters&) {  // between outputs between which the run did not rest
        const long rests_now = simulation.integrator().runner().pause_count(), now = engine::test::allocation_count();
        if (++outputs > 2 && rests_now == rests) {
            ++quiet;
            allocations += now - before;
        }
        rests = rests_now;
        before = engine::test::allocation_count();
    });
    settle_and_go(simulation, scene.run.until, counter);
    EXPECT_GT(simulation.integrator().runner().pause_count(), 3);
    EXPECT_GT(quiet, 10);
    EXPECT_EQ(allocations, 0);
}

TEST(ScheduleRunner, ReportsItsChoice) {
    const Scene scene = settled();
    Simulation brief(scene, std::vector<Schedule>{Schedule{}, {parallel, {Assembly::fused}, 2, 2}}, {});
    EXPECT_EQ(go(brief, {.steps = 3, .new_part = true}).kind, FaultKind::max_steps);
    EXPECT_EQ(brief.integrator().runner().text(), "serial (auto; the run was too short to try others)");
    EXPECT_EQ(Simulation(scene, Schedule{parallel, {}, 5, 2}).integrator().runner().text(), parallel + ", fused, 5 segments, 2 threads");
    ChooserOptions options = restless();
    options.gain = 1e9;  // nothing can bring that
    Simulation longer(scene, std::vector<Schedule>{Schedule{}, {parallel, {Assembly::fused}, 2, 2}}, options);
    EXPECT_EQ(go(longer, {.steps = 200, .new_part = true}).kind, FaultKind::max_steps);
    EXPECT_THAT(longer.integrator().runner().text(),
                AllOf(StartsWith("serial (auto: "), HasSubstr(" us per cycle, " + parallel + ", fused, 2 segments, 2 threads "),
                      HasSubstr("0 changes)")));
}

TEST(AutoSchedule, RespectsWhatTheSceneFixes) {
    Scene scene = settled();
    scene.run.threads = 1;
    EXPECT_EQ(schedules_for(scene), std::vector<Schedule>{Schedule{}});
    scene.run.threads = 2;
    scene.run.segments = 6;
    scene.run.assembly = Assembly::staged;
    std::vector<Schedule> list = schedules_for(scene);
    EXPECT_GE(list.size(), 2u);
    EXPECT_EQ(list.front().executor, "serial");
    EXPECT_TRUE(std::all_of(list.begin(), list.end(),
                            [](const Schedule& each) { return each.segments == 6 && each.assembly.kind == Assembly::staged; }));
    EXPECT_TRUE(
        std::all_of(list.begin() + 1, list.end(), [](const Schedule& each) { return each.executor == "flow" && each.threads == 2; }));
    scene.run.schedule = "flow";
    EXPECT_EQ(schedules_for(scene), (std::vector<Schedule>{{"flow", {Assembly::staged}, 6, 2}}));
}

TEST(AutoSchedule, TriesFlowOnHalvesOfTheThreads) {
    Scene scene = settled();
    scene.run.threads = 8;
    const Schedule two{"flow", {}, 2, 2}, four{"flow", {}, 4, 4}, eight{"flow", {}, 8, 8};
    EXPECT_EQ(schedules_for(scene), (std::vector<Schedule>{Schedule{}, two, four, eight}));
}

}  // namespace
}  // namespace cvtflow::tasks
