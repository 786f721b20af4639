#include "tasks/schedule/schedule.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "engine/executor/catalogue.hpp"
#include "engine/method/catalogue.hpp"
#include "tasks/run/simulation.hpp"
#include "tests/engine/executor/executor_fixture.hpp"
#include "tests/engine/graph/graph_fixture.hpp"
#include "tests/sample_fixture.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

Scene scheduled_scene(const std::string& name, const std::vector<std::string>& settings) {
    Scene scene = read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/" + name + ".toml");
    set_values(scene, settings);
    return scene;
}

struct Outcome {
    std::uint64_t hash;
    long transitions;
};

Outcome outcome(const Scene& scene, const Schedule& schedule) {
    SilentObserver quiet;
    const engine::Cancellation never;
    Simulation simulation(scene, schedule);
    EXPECT_FALSE(simulation.advance({.until = scene.run.until}, quiet, never));
    return {simulation.hash(), simulation.counters().detected};
}

/// Scene from a settled state, long enough for transitions.
Scene settled(const std::string& until) {
    return scheduled_scene(
        "low", {"run.method=rk4", "run.step=50 ns", "run.until=" + until, "run.output_interval=20 us", "run.state_interval=20 us"});
}

/// Assemblies, segments and threads of an executor that differ.
std::vector<Schedule> schedules_of(const engine::ExecutorRow& row) {
    std::vector<Schedule> schedules;
    for (const Assembly assembly : test::assemblies()) {
        for (const auto& [segments, threads] : {std::pair{1, 1}, {2, 2}, {3, 2}, {7, 4}, {28, 2}, {84, 2}})
            schedules.push_back({std::string(row.name), {assembly}, segments, row.parallel ? threads : 1});
    }
    return schedules;
}

/// Two schedules of every executor; all of them nightly.
TEST(Schedule, EveryExecutorGivesTheSameBitsWithAnyAssemblySegmentsAndThreads) {
    const Scene scene = settled("40 us");
    const Outcome serial = outcome(scene, {});
    EXPECT_GT(serial.transitions, 0) << "the run should cross transitions";
    for (const engine::ExecutorRow& row : engine::executors()) {
        if (row.name.starts_with("omp")) continue;  // a contended OpenMP team takes minutes: nightly
        if (engine::test::thread_sanitizer && row.parallel && row.name != "barrier") continue;  // it sees into neither oneTBB nor OpenMP
        for (const Schedule& schedule : cvtflow::test::sample(schedules_of(row), 2, std::string(row.name)))
            EXPECT_EQ(outcome(scene, schedule).hash, serial.hash) << schedule.text();
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

TEST(Schedule, PartitionLedgerAndSerialPartsDoNotChangeTheBits) {
    Scene scene = settled("60 us");
    scene.parameters.ledger = true;
    const Outcome serial = outcome(scene, {});
    for (const Assembly assembly : test::assemblies()) {
        const Schedule balanced{engine::test::parallel_executor, {assembly, false, false}, 5, 2, true};
        EXPECT_EQ(outcome(scene, balanced).hash, serial.hash);
    }
}

TEST(StepGraph, NoAssemblyRaces) {
    const Scene scene = settled("60 us");
    for (const int segments : {1, 2, 3, 7, 84}) {
        const Workspace workspace(scene.parameters, *engine::find_method("rk4"), Partition::equal(84, segments));
        for (const Assembly assembly : test::assemblies()) {
            EXPECT_TRUE(engine::race_check(step_graph(workspace, {assembly})).empty());
            EXPECT_TRUE(engine::race_check(step_graph(workspace, {assembly, false, true})).empty());
        }
    }
}

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
    const std::filesystem::path root = testing::TempDir() + "quota";
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
    std::filesystem::remove_all(root);
}

TEST(Schedule, AnUnknownExecutorIsRefused) {
    RunSettings run;
    run.schedule = "flaw";
    EXPECT_THROW((void)schedule_of(run, 84), SceneError);
}

}  // namespace
}  // namespace cvtflow::tasks
