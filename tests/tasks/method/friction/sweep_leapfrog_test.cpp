/// Leapfrog with friction by sweeps: the same bits for every schedule, its graph free of races, its forces part of the state.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tasks/method/friction/sweep_leapfrog.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/step/step_graph.hpp"
#include "tests/claims/operating_point_fixture.hpp"
#include "tests/engine/executor/executor_fixture.hpp"
#include "tests/engine/graph/race_check_fixture.hpp"

namespace cvtflow::tasks {
namespace {

const engine::Cancellation unstopped;

std::uint64_t hash_after(std::vector<std::string> settings, const std::vector<std::string>& more) {
    settings.insert(settings.end(), more.begin(), more.end());
    Simulation simulation(claims::ready_scene("baseline", settings));
    SilentObserver silent;
    EXPECT_FALSE(simulation.advance({.until = 60e-6}, silent, unstopped)) << settings.back();
    EXPECT_GT(simulation.counters().steps, 29);
    return simulation.hash();
}

class SweepLeapfrogBits : public testing::TestWithParam<const char*> {};

TEST_P(SweepLeapfrogBits, AreTheSameForEverySchedule) {
    const std::vector<std::string> common{std::string("run.method=") + GetParam(), "run.step=1.8us"};
    const std::uint64_t serial = hash_after(common, {"run.schedule=serial"});
    EXPECT_EQ(hash_after(common, {"run.schedule=barrier", "run.threads=2", "run.segments=3"}), serial);
    EXPECT_EQ(hash_after(common, {"run.schedule=barrier", "run.assembly=staged", "run.threads=2", "run.segments=5"}), serial);
    if (engine::test::thread_sanitizer) return;  // it sees into neither oneTBB nor OpenMP
    EXPECT_EQ(hash_after(common, {"run.schedule=flow", "run.threads=2", "run.segments=7"}), serial);
    EXPECT_EQ(hash_after(common, {"run.schedule=flow_messages", "run.threads=2", "run.segments=2"}), serial);
    EXPECT_EQ(hash_after(common, {"run.schedule=serial", "run.segments=84"}), serial);
}

/// Tips that have never touched lie in every lane beside those that stick or slip.
TEST_P(SweepLeapfrogBits, AreTheSameWithTipsThatStickOrSlip) {
    const std::vector<std::string> common{std::string("run.method=") + GetParam(), "run.step=1.5us", "detail.stick_slip=true"};
    const std::uint64_t serial = hash_after(common, {"run.schedule=serial"});
    EXPECT_EQ(hash_after(common, {"run.schedule=serial", "run.segments=5"}), serial);
    EXPECT_EQ(hash_after(common, {"run.schedule=barrier", "run.threads=2", "run.segments=84"}), serial);
}

INSTANTIATE_TEST_SUITE_P(SweepLeapfrog, SweepLeapfrogBits, testing::Values("leapfrog-sweep", "leapfrog-sweep-double"),
                         [](const auto& instance) { return std::string(instance.index == 0 ? "InSingle" : "InDouble"); });

TEST(SweepLeapfrog, ItsGraphHasNoRaces) {
    const Scene scene = claims::ready_scene("baseline", {"run.method=leapfrog-sweep"});
    for (const int segments : {1, 2, 5, 84}) {
        Workspace workspace(scene.parameters, Method("leapfrog-sweep").plan(), Partition::equal(84, segments));
        const auto method = Method("leapfrog-sweep").make(workspace);
        for (const Assembly assembly : {Assembly::fused, Assembly::staged})
            EXPECT_TRUE(engine::race_check(step_graph(workspace, {.kind = assembly}, method.get())).empty()) << segments;
    }
}

/// The record finds transitions in the middle of a step: at its end only a tip within a micrometre of its sheave can be in another phase.
TEST(SweepLeapfrog, TipsThatTouchAreThoseThatPenetrate) {
    struct Seen final : RunObserver {
        long transitions = 0;
        void output(double, const Workspace&, const Counters&) override {}
        void transition(const TransitionRecord&) override { ++transitions; }
    };
    for (const char* scene : {"baseline", "overdrive"}) {
        Simulation simulation(claims::ready_scene(scene, {"run.method=leapfrog-sweep", "run.step=1us"}));
        Seen seen;
        for (int span = 1; span <= 20; ++span) {
            ASSERT_FALSE(simulation.advance({.until = 20e-6 * span}, seen, unstopped));
            const Workspace& w = simulation.workspace();
            model::SheaveMotion sheaves[4];
            w.variator.pulleys().motions(w.tail(), sheaves);
            for (int link = 0; link < w.layout().links; ++link) {
                model::TipProbe probe;
                w.variator.chain().probe(w.state() + w.layout().link_begin(link), sheaves, false, probe);
                for (int corner = 0; corner < model::tips_per_link; ++corner) {
                    if (std::abs(probe.depth[corner]) < 1e-6) continue;
                    const bool touches = w.tips.phases[at(model::tips_per_link * link + corner)] == model::Phase::touching;
                    EXPECT_EQ(touches, probe.depth[corner] > 0.0) << scene << ", link " << link << ": " << probe.depth[corner];
                }
            }
        }
        EXPECT_EQ(seen.transitions, simulation.counters().detected);
        EXPECT_GT(seen.transitions, 2) << "tips arrive and leave";
        EXPECT_EQ(simulation.counters().truncated, 0);
    }
}

/// Where friction saturates at a tenth of the usual speeds forces lag behind the law at their velocities most.
TEST(SweepLeapfrog, BooksTheLossesOfItsForcesAndNotOfTheLaw) {
    Simulation simulation(claims::ready_scene("baseline", {"run.method=leapfrog-sweep", "run.step=2us", "tip.saturation_speed=1e-3",
                                                           "joint.saturation_speed=5e-4", "plate.saturation_speed=1e-3"}));
    SilentObserver silent;
    ASSERT_FALSE(simulation.advance({.until = 2e-3}, silent, unstopped));
    EXPECT_LT(std::abs(simulation.workspace().energy.balance().relative()), 3e-3);
}

TEST(SweepLeapfrog, LeavesRunOutThatMovesFlanksFarToOtherMethods) {
    model::Parameters parameters;
    EXPECT_TRUE(sweeps_suit(parameters));
    parameters.imperfection.runout = 1e-3;
    EXPECT_TRUE(sweeps_suit(parameters)) << "0.2 mm across a flank of 11 degrees";
    parameters.tip.angle = 0.5;
    EXPECT_FALSE(sweeps_suit(parameters)) << "0.5 mm";
}

TEST(SweepLeapfrog, RefusesARoundedCornerOfTheLaw) {
    try {
        (void)claims::ready_scene("tiny", {"run.method=leapfrog-sweep", "detail.friction=smoothed"});
        FAIL() << "not refused";
    } catch (const SceneError& refused) {
        EXPECT_THAT(refused.what(), testing::HasSubstr("leapfrog-sweep' requires detail.friction = \"piecewise\""));
    }
}

}  // namespace
}  // namespace cvtflow::tasks
