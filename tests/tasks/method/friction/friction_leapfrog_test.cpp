/// Leapfrog with friction inside the step: the same bits for every schedule, its graph free of races, its limits named.

#include <gtest/gtest.h>

#include "engine/graph/race_check.hpp"
#include "tasks/method/friction/kick_tables.hpp"
#include "tasks/method/method_choice.hpp"
#include "tasks/run/simulation.hpp"
#include "tests/claims/operating_point_fixture.hpp"
#include "tests/engine/executor/executor_fixture.hpp"

namespace cvtflow::tasks {
namespace {

const engine::Cancellation uncancelled;

std::uint64_t leapfrog_hash(const std::vector<std::string>& settings) {
    Simulation simulation(claims::ready_scene("baseline", settings));
    SilentObserver nobody;
    EXPECT_FALSE(simulation.advance({.until = 60e-6}, nobody, uncancelled)) << settings.back();
    EXPECT_GT(simulation.counters().steps, 29);
    return simulation.hash();
}

TEST(FrictionLeapfrog, GivesTheSameBitsForEverySchedule) {
    for (const std::string method : {"run.method=leapfrog-rkc", "run.method=leapfrog-chebyshev"}) {
        const std::vector<std::string> common{method, "run.step=2us"};
        const auto with = [&](std::vector<std::string> more) {
            more.insert(more.begin(), common.begin(), common.end());
            return leapfrog_hash(more);
        };
        const std::uint64_t serial = with({"run.schedule=serial"});
        EXPECT_EQ(with({"run.schedule=barrier", "run.threads=2", "run.segments=3"}), serial);
        EXPECT_EQ(with({"run.schedule=barrier", "run.assembly=staged", "run.threads=2", "run.segments=5"}), serial);
        if (engine::test::thread_sanitizer) continue;  // it sees into neither oneTBB nor OpenMP
        EXPECT_EQ(with({"run.schedule=flow", "run.threads=2", "run.segments=7"}), serial);
        EXPECT_EQ(with({"run.schedule=flow_messages", "run.threads=2", "run.segments=2"}), serial);
        EXPECT_EQ(with({"run.schedule=serial", "run.segments=84"}), serial);
    }
}

TEST(FrictionLeapfrog, ItsGraphHasNoRaces) {
    const Scene scene = claims::ready_scene("baseline", {"run.method=leapfrog-rkc"});
    for (const int segments : {1, 2, 5, 84}) {
        Workspace workspace(scene.parameters, *plan_for("leapfrog-rkc"), Partition::equal(84, segments));
        const auto method = make_step_method("leapfrog-rkc", workspace);
        for (const Assembly assembly : {Assembly::fused, Assembly::staged}) {
            EXPECT_TRUE(engine::race_check(step_graph(workspace, {.kind = assembly}, method.get())).empty()) << segments;
        }
    }
}

TEST(FrictionLeapfrog, FrictionTooStiffForItIsAFaultThatSaysSo) {
    Simulation simulation(
        claims::ready_scene("baseline", {"run.method=leapfrog-rkc", "run.step=2us", "run.schedule=serial", "joint.saturation_speed=1e-6"}));
    SilentObserver nobody;
    const Fault fault = simulation.advance({.until = 1e-5}, nobody, uncancelled);
    EXPECT_EQ(fault.kind, FaultKind::too_stiff);
    EXPECT_GT(fault.value, fault.limit);
    EXPECT_NE(fault.message().find("friction is too stiff for the step at t = "), std::string::npos) << fault.message();
}

TEST(KickTables, ReachFurtherTheMoreStagesTheyHaveAndTheCheapestIsTaken) {
    for (const Kick kick : {Kick::chebyshev, Kick::rkc}) {
        const KickTables tables(kick);
        int stages = 0;
        for (const double z : {1.0, 10.0, 100.0, 1000.0, 10000.0}) {
            const KickTable* table = tables.reaching(z);
            ASSERT_NE(table, nullptr) << z;
            EXPECT_GE(table->reach, z);
            EXPECT_GT(table->plan.stages(), stages);
            stages = table->plan.stages();
            double sum = 0.0;
            for (const double weight : table->weights) sum += weight;
            EXPECT_NEAR(sum, 1.0, 1e-12);  // the impulse of a constant force is exact
        }
        EXPECT_EQ(tables.reaching(1.01 * tables.longest_reach()), nullptr);
    }
}

}  // namespace
}  // namespace cvtflow::tasks
