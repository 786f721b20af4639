/// Leapfrog with friction inside the step: the same bits for every schedule, its graph free of races, its limits named.

#include <gtest/gtest.h>

#include "bench/method/stability/friction_stability.hpp"
#include "tasks/method/friction/kick_tables.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/simulation.hpp"
#include "tests/claims/operating_point_fixture.hpp"
#include "tests/engine/executor/executor_fixture.hpp"
#include "tests/engine/graph/race_check_fixture.hpp"

namespace cvtflow::tasks {
namespace {

const engine::Cancellation uncancelled;

std::uint64_t leapfrog_hash(const std::vector<std::string>& settings) {
    Simulation simulation(claims::ready_scene("baseline", settings));
    SilentObserver silent;
    EXPECT_FALSE(simulation.advance({.until = 60e-6}, silent, uncancelled)) << settings.back();
    EXPECT_GT(simulation.counters().steps, 29);
    return simulation.hash();
}

TEST(FrictionLeapfrog, GivesTheSameBitsForEverySchedule) {
    for (const std::string method : {"run.method=leapfrog-rkc", "run.method=leapfrog-chebyshev", "run.method=leapfrog-chebyshev-double"}) {
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

/// Tips that have never touched lie in every lane beside those that stick or slip.
TEST(FrictionLeapfrog, TakesTipsThatStickOrSlip) {
    for (const std::string method : {"run.method=leapfrog-chebyshev", "run.method=leapfrog-chebyshev-double"}) {
        const std::vector<std::string> common{method, "run.step=1.5us", "detail.stick_slip=true"};
        const auto with = [&](std::vector<std::string> more) {
            more.insert(more.begin(), common.begin(), common.end());
            return leapfrog_hash(more);
        };
        const std::uint64_t serial = with({"run.schedule=serial"});
        EXPECT_EQ(with({"run.schedule=serial", "run.segments=5"}), serial);
        EXPECT_EQ(with({"run.schedule=barrier", "run.threads=2", "run.segments=84"}), serial);
    }
}

TEST(FrictionLeapfrog, ItsGraphHasNoRaces) {
    for (const char* name : {"leapfrog-rkc", "leapfrog-rkc-double"}) {
        const Scene scene = claims::ready_scene("baseline", {std::string("run.method=") + name});
        for (const int segments : {1, 2, 5, 84}) {
            Workspace workspace(scene.parameters, Method(name).plan(), Partition::equal(84, segments));
            const auto method = Method(name).make(workspace);
            for (const Assembly assembly : {Assembly::fused, Assembly::staged}) {
                EXPECT_TRUE(engine::race_check(step_graph(workspace, {.kind = assembly}, method.get())).empty()) << name << " " << segments;
            }
        }
    }
}

/// Several stages are one cycle: eight levels, in which a segment waits for itself and for the two beside it.
TEST(FrictionLeapfrog, StagesOfACycleWaitForNeighboursOnly) {
    const Scene scene = claims::ready_scene("baseline", {"run.method=leapfrog-chebyshev"});
    Workspace workspace(scene.parameters, Method("leapfrog-chebyshev").plan(), Partition::equal(84, 5));
    const auto method = Method("leapfrog-chebyshev").make(workspace);
    const engine::TaskGraph graph = step_graph(workspace, {}, method.get());
    const int cycle = graph.cycles() - 2;  // the last is the step's end
    ASSERT_EQ(graph.levels(cycle), 8);
    for (int level = 0; level < 8; ++level) {
        ASSERT_EQ(graph.level(cycle, level).size(), 5u);
        for (const int task : graph.level(cycle, level)) {
            EXPECT_EQ(graph.task(task).stage_name(), "friction");
            EXPECT_EQ(graph.predecessor_count(task), level == 0 ? 0 : 3) << graph.task(task).name;
        }
    }
}

/// Velocities change by rounding of what the stages add, 6e-8 of it each: after 30 steps they differ, and by less than 1e-6 of the fastest.
TEST(FrictionLeapfrog, StagesInSinglePrecisionDifferFromDoubleByRoundingAlone) {
    const auto state_after = [](const std::string& method) {
        Simulation simulation(claims::ready_scene("baseline", {"run.method=" + method, "run.step=2us", "run.schedule=serial"}));
        SilentObserver silent;
        EXPECT_FALSE(simulation.advance({.until = 60e-6}, silent, uncancelled)) << method;
        const Workspace& w = simulation.workspace();
        return std::vector<double>(w.state(), w.state() + w.layout().size());
    };
    for (const std::string method : {"leapfrog-rkc", "leapfrog-chebyshev"}) {
        const std::vector<double> single = state_after(method), twice = state_after(method + "-double");
        double largest = 0.0, difference = 0.0;
        for (std::size_t k = 0; k < single.size(); ++k) {
            largest = std::max(largest, std::abs(twice[k]));
            difference = std::max(difference, std::abs(single[k] - twice[k]));
        }
        EXPECT_GT(difference, 0.0) << method;
        EXPECT_LT(difference, 1e-6 * largest) << method;
    }
}

TEST(FrictionLeapfrog, FrictionTooStiffForItIsAFaultThatReportsIt) {
    Simulation simulation(
        claims::ready_scene("baseline", {"run.method=leapfrog-rkc", "run.step=2us", "run.schedule=serial", "joint.saturation_speed=1e-6"}));
    SilentObserver silent;
    const Fault fault = simulation.advance({.until = 1e-5}, silent, uncancelled);
    EXPECT_EQ(fault.kind, FaultKind::too_stiff);
    EXPECT_GT(fault.value, fault.limit);
    EXPECT_NE(fault.message().find("friction is too stiff for the step at t = "), std::string::npos) << fault.message();
}

TEST(KickTables, ReachFurtherTheMoreStagesTheyHaveAndTheCheapestIsTaken) {
    for (const Kick& kick : {chebyshev_kick, bench::rkc_kick}) {
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
            for (int stage = 0; stage < stages; ++stage) {
                const int here = std::max(0, table->row(stage).here.keep);
                EXPECT_NE(table->row(stage).next.keep, here) << "neighbours read it in this stage: " << stage << " of " << stages;
            }
        }
        EXPECT_EQ(tables.reaching(1.01 * tables.longest_reach()), nullptr);
    }
}

}  // namespace
}  // namespace cvtflow::tasks
