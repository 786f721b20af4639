/// Schedules of runs: none changes a bit, whatever the executor, assembly, segments and threads; balanced borders; threads that are usable.

#include "tasks/schedule/schedule.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "engine/executor/catalogue.hpp"
#include "tests/claims/operating_point_fixture.hpp"
#include "tests/claims/rig_fixture.hpp"
#include "tests/engine/executor/executor_fixture.hpp"
#include "tests/sample_fixture.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"
#include "tests/temporary_file_fixture.hpp"

namespace cvtflow::tasks {
namespace {

struct Outcome {
    std::uint64_t hash;
    long transitions;
};

/// Hash at a time, after settling where the scene settles.
Outcome outcome(const Scene& scene, const Schedule& schedule, double until) {
    Simulation simulation(scene, schedule);
    long transitions = 0;
    if (simulation.needs_settling()) {
        EXPECT_FALSE(go(simulation, {.until = 0.0}));
        transitions = simulation.counters().detected;
    }
    EXPECT_FALSE(go(simulation, {.until = until}));
    return {simulation.hash(), transitions + simulation.counters().detected};
}
Outcome outcome(const Scene& scene, const Schedule& schedule) { return outcome(scene, schedule, scene.run.until); }

/// Scene from a settled state, long enough for transitions.
Scene settled(const std::string& until) {
    return claims::ready_scene(
        "low", {"run.method=rk4", "run.step=50 ns", "run.until=" + until, "run.output_interval=20 us", "run.state_interval=20 us"});
}

/// Two of the assemblies, segments and threads of every executor; all of them nightly.
std::vector<Schedule> of_every_executor() {
    std::vector<Schedule> drawn;
    for (const engine::ExecutorRow& row : engine::executors()) {
        if (row.name.starts_with("omp")) continue;  // a contended OpenMP team takes minutes: nightly
        if (engine::test::thread_sanitizer && row.parallel && row.name != "barrier") continue;  // it sees into neither oneTBB nor OpenMP
        std::vector<Schedule> all;
        for (const Assembly assembly : test::assemblies()) {
            for (const auto& [segments, threads] : {std::pair{1, 1}, {2, 2}, {3, 2}, {7, 4}, {28, 2}, {84, 2}})
                all.push_back({std::string(row.name), {assembly}, segments, row.parallel ? threads : 1});
        }
        for (const Schedule& schedule : cvtflow::test::sample(all, 2, std::string(row.name))) drawn.push_back(schedule);
    }
    return drawn;
}

/// Executors, assemblies, threads and segments that differ from serial.
std::vector<Schedule> of_several_threads() {
    const std::string parallel = engine::test::parallel_executor;
    std::vector<Schedule> all{{"serial", {}, 84, 1}, {parallel, {}, 3, 2}, {parallel, {}, 7, 2}};
    if (test::has_laboratory()) all.insert(all.end(), {{"barrier", {}, 84, 2}, {"barrier", {Assembly::staged}, 5, 2}});
    if (test::has_laboratory() && !engine::test::thread_sanitizer) all.push_back({"flow_messages", {}, 2, 2});
    return all;
}

std::vector<Schedule> in_segments(const std::vector<int>& counts) {
    std::vector<Schedule> all;
    for (const int segments : counts) all.push_back({"serial", {}, segments, 1});
    return all;
}

/// @return transitions
long expect_the_same_bits(const Scene& scene, double until, const std::vector<Schedule>& schedules) {
    const Outcome serial = outcome(scene, {}, until);
    for (const Schedule& schedule : schedules) EXPECT_EQ(outcome(scene, schedule, until).hash, serial.hash) << schedule.text();
    return serial.transitions;
}

TEST(SameBits, OnEveryExecutorWithEveryAssembly) {
    EXPECT_GT(expect_the_same_bits(settled("40 us"), 40e-6, of_every_executor()), 0);
    Scene with_ledger = settled("60 us");
    with_ledger.parameters.ledger = true;
    for (const Assembly assembly : test::assemblies())
        expect_the_same_bits(with_ledger, 60e-6, {{engine::test::parallel_executor, {assembly, false, false}, 5, 2, true}});
}

/// Automatic steps are long here: tips come and go within one.
TEST(SameBits, WhateverASceneHas) {
    const std::vector<std::vector<std::string>> rows{
        {},
        {"run.step=auto"},
        {"detail.stick_slip=true", "record.ledger=true"},
        {"detail.stick_slip=true", "record.ledger=true", "run.step=auto"},
        {"guide.stiffness=1e6 N/m", "guide.clearance=0", "guide.offset=-0.3 mm", "guide.friction_coefficient=0.5"},
        {"imperfection.pin_length_spread=1 um", "imperfection.unbalance=1 g*m"}};
    for (const std::vector<std::string>& row : rows) {
        SCOPED_TRACE(testing::PrintToString(row));
        const Scene scene = scene_of("tiny", "", {"start.settling_time=0.2 ms", "start.ramp_time=0.2 ms", "run.step=50 ns"}, row);
        const std::vector<Schedule> schedules = in_segments(cvtflow::test::depth(std::vector{5}, std::vector{2, 3, 5, 7, 14, 24}));
        EXPECT_GT(expect_the_same_bits(scene, 1e-5, schedules), 0);
    }
}

TEST(SameBits, OfTheLeapfrogWithFrictionInsideTheStep) {
    expect_the_same_bits(claims::ready_scene("baseline", {"run.method=leapfrog-sweep", "run.step=1.5us"}), 60e-6, of_several_threads());
}

TEST(SameBits, AtEveryLevelOfDetail) {
    std::vector<Schedule> schedules = in_segments({2, 5, 9});
    schedules.push_back({"flow", {}, 4, 2});
    for (const std::string& level : cvtflow::test::depth(std::vector{claims::levels().front()}, claims::levels())) {
        for (const auto& [method, step] : {std::pair{"rk4", "50ns"}, {"dumka3-p5", "500ns"}}) {
            SCOPED_TRACE(level + ", " + method);
            const Scene scene = claims::scene_at_level("tiny", level,
                                                       {"start.settling_time=300us", "start.ramp_time=300us", "detail.stick_slip=true",
                                                        std::string("run.method=") + method, std::string("run.step=") + step});
            EXPECT_GT(expect_the_same_bits(scene, 200e-6, schedules), 0);
        }
    }
}

class NightlySchedule : public testing::TestWithParam<engine::ExecutorRow> {};

/// All segments and threads. More threads than processors sleep and wake at every barrier: a shorter run, with transitions, too.
TEST_P(NightlySchedule, EveryAssemblySegmentsAndThreadsGiveTheSameBitsOverALongerRun) {
    const engine::ExecutorRow& row = GetParam();
    const Scene whole = settled("200 us"), brief = settled("40 us");
    const Outcome serial = outcome(whole, {}), serial_brief = outcome(brief, {});
    EXPECT_GT(serial.transitions, 3);
    EXPECT_GT(serial_brief.transitions, 0);
    for (const Assembly assembly : test::assemblies()) {
        for (const int segments : {1, 2, 3, 5, 7, 14, 28, 84}) {
            for (const int threads : {1, 2, 4, 8}) {
                if (!row.parallel && threads > 1) continue;
                const Schedule schedule{std::string(row.name), {assembly}, segments, threads};
                const bool slow = threads > usable_threads();
                EXPECT_EQ(outcome(slow ? brief : whole, schedule).hash, (slow ? serial_brief : serial).hash) << schedule.text();
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Executors, NightlySchedule, testing::ValuesIn(engine::executors()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(Schedule, BalancedSegmentsCostAboutTheSame) {
    const int links = 84;
    std::vector<model::Phase> phases(4 * links, model::Phase::free);
    for (int link = 10; link < 31; ++link) phases[static_cast<std::size_t>(4 * link)] = model::Phase::touching;
    const LinkCosts costs{1.0, 3.0};
    for (const int segments : {1, 2, 3, 7, 28, 84}) {
        std::vector<int> cuts(static_cast<std::size_t>(segments) + 1);
        balance(phases, cuts, costs);
        const Partition partition = Partition::at(cuts);
        ASSERT_EQ(partition.size(), segments);
        EXPECT_EQ(partition[segments - 1].last, links);
        double least = 1e9;
        double most = 0.0;
        for (const Segment& segment : partition.segments()) {
            double cost = 0.0;
            for (int link = segment.first; link < segment.last; ++link) cost += link >= 10 && link < 31 ? 3.0 : 1.0;
            least = std::min(least, cost);
            most = std::max(most, cost);
        }
        EXPECT_LE(most - least, 2.0 * 3.0);  // borders fall on whole links
    }
}

TEST(Schedule, BalancingIsWorthItByTheLongestSegment) {
    std::vector<model::Phase> phases(4 * 12, model::Phase::free);
    for (int link = 0; link < 4; ++link) phases[static_cast<std::size_t>(4 * link + 3)] = model::Phase::touching;
    const LinkCosts costs{1.0, 2.0};
    EXPECT_DOUBLE_EQ(longest_segment(phases, std::vector<int>{0, 6, 12}, costs), 4 * 2.0 + 2);
    std::vector<int> cuts(3);
    balance(phases, cuts, costs);
    EXPECT_EQ(cuts, (std::vector<int>{0, 4, 12}));  // 8 and 8
    EXPECT_DOUBLE_EQ(longest_segment(phases, cuts, costs), 8.0);
}

TEST(UsableThreads, AreNoMoreThanABatchSystemGrants) {
    const char* before = std::getenv("SLURM_CPUS_PER_TASK");
    const std::string kept = before != nullptr ? before : "";
    setenv("SLURM_CPUS_PER_TASK", "1", 1);
    EXPECT_EQ(usable_threads(), 1);
    setenv("SLURM_CPUS_PER_TASK", "none", 1);
    EXPECT_GE(usable_threads(), 1);
    before != nullptr ? setenv("SLURM_CPUS_PER_TASK", kept.c_str(), 1) : unsetenv("SLURM_CPUS_PER_TASK");
}

TEST(UsableThreads, AreNoMoreThanTheQuotaOfAnyGroupAround) {
    const tests::TemporaryFolder folder("quota");
    const std::filesystem::path root = folder / "";
    std::filesystem::create_directories(root / "outer" / "inner");
    const auto write = [&](const char* name, const char* text) { std::ofstream(root / name) << text << "\n"; };
    write("membership", "1:name=systemd:/elsewhere\n0::/outer/inner");
    EXPECT_GT(quota_processors(root, root / "membership"), 1000000);
    write("outer/inner/cpu.max", "max 100000");
    EXPECT_GT(quota_processors(root, root / "membership"), 1000000);
    write("outer/cpu.max", "350000 100000");
    EXPECT_EQ(quota_processors(root, root / "membership"), 3);
    write("outer/inner/cpu.max", "50000 100000");
    EXPECT_EQ(quota_processors(root, root / "membership"), 1);  // half a processor is one thread
}

TEST(Schedule, AnUnknownExecutorIsRefused) {
    RunSettings run;
    run.schedule = "flaw";
    EXPECT_THROW((void)schedule_of(run, 84), SceneError);
}

}  // namespace
}  // namespace cvtflow::tasks
