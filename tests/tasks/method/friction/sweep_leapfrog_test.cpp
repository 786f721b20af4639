/// The leapfrog with friction in sweeps: its limits named, its forces part of the state; and the columns of segments.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tasks/method/friction/sweep_leapfrog.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/run.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/step/step_graph.hpp"
#include "tests/claims/operating_point_fixture.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::tasks {
namespace {

const engine::Cancellation uncancelled;

/// The passes of a step are one cycle: four levels, in which a segment waits for itself and for the two beside it.
TEST(SweepLeapfrog, PassesOfACycleWaitForNeighboursOnly) {
    const Scene scene = claims::ready_scene("baseline", {"run.method=leapfrog-sweep"});
    Workspace workspace(scene.parameters, Method("leapfrog-sweep").plan(), Partition::equal(84, 5));
    const auto method = Method("leapfrog-sweep").make(workspace);
    const engine::TaskGraph graph = step_graph(workspace, {}, method.get());
    int cycle = method_cycles;
    while (graph.levels(cycle) != 4) ASSERT_LT(++cycle, graph.cycles());
    for (int level = 0; level < 4; ++level) {
        ASSERT_EQ(graph.level(cycle, level).size(), 5u);
        for (const int task : graph.level(cycle, level)) {
            EXPECT_EQ(graph.task(task).stage_name(), "friction");
            EXPECT_EQ(graph.predecessor_count(task), level == 0 ? 0 : 3) << graph.task(task).name;
        }
    }
}

/// The record finds transitions in the middle of a step: at its end only a tip within a micrometre of its sheave can be in another phase.
TEST(SweepLeapfrog, TipsThatTouchAreThoseThatPenetrate) {
    for (const char* scene : {"baseline", "overdrive"}) {
        Simulation simulation(claims::ready_scene(scene, {"run.method=leapfrog-sweep", "run.step=1us"}));
        long transitions = 0;
        Outputs seen({}, [&](const TransitionRecord&) { ++transitions; });
        for (int span = 1; span <= 20; ++span) {
            ASSERT_FALSE(simulation.advance({.until = 20e-6 * span}, seen, uncancelled));
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
        EXPECT_EQ(transitions, simulation.counters().detected);
        EXPECT_GT(transitions, 2) << "tips arrive and leave";
        EXPECT_EQ(simulation.counters().truncated, 0);
    }
}

/// Where friction saturates at a tenth of the usual speeds forces lag behind the law at their velocities most.
TEST(SweepLeapfrog, BooksTheLossesOfItsForcesAndNotOfTheLaw) {
    Simulation simulation(claims::ready_scene("baseline", {"run.method=leapfrog-sweep", "run.step=2us", "tip.saturation_speed=1e-3",
                                                           "joint.saturation_speed=5e-4", "plate.saturation_speed=1e-3"}));
    SilentObserver silent;
    ASSERT_FALSE(simulation.advance({.until = 2e-3}, silent, uncancelled));
    EXPECT_LT(std::abs(simulation.workspace().energy.balance().relative()), 3e-3);
}

/// Strands of held links and filtered waves have the forces of steps that hold and filter a sixty-fourth as much. If a link's turning
/// accelerated its stretch, they would carry 1e-3 more.
TEST(SweepLeapfrog, StrandsCarryWhatTheyCarryInShortSteps) {
    const auto tight = [](const char* step) {
        Scene scene = claims::ready_scene("baseline", {"run.method=leapfrog-sweep", std::string("run.step=") + step, "run.until=10 ms",
                                                       "run.output_interval=25 us", "run.schedule=serial"});
        return run_scene(scene, {}).whole.tight;
    };
    const double force = tight("5 us"), in_short_steps = tight("0.625 us");
    EXPECT_GT(force, 4000.0);
    EXPECT_NEAR(force / in_short_steps, 1.0, 1e-4);
}

TEST(SweepLeapfrog, LeavesRunOutThatMovesFlanksFarToOtherMethods) {
    model::Parameters parameters;
    EXPECT_TRUE(sweeps_suit(parameters));
    parameters.imperfection.runout = 1e-3;
    EXPECT_TRUE(sweeps_suit(parameters)) << "0.2 mm across a flank of 11 degrees";
    parameters.tip.angle = 0.5;
    EXPECT_FALSE(sweeps_suit(parameters)) << "0.5 mm";
}

TEST(SweepLeapfrog, RefusesStickAndSlip) {
    EXPECT_THAT(message_of_settings(ready_tiny(), {"run.method=leapfrog-sweep", "detail.stick_slip=true"}),
                testing::HasSubstr("leapfrog-sweep' requires detail.stick_slip = false"));
}

TEST(SegmentColumns, GhostColumnsRepeatTheLinksBesideASegment) {
    constexpr int rows = 5;
    const auto number = [](int row, int link) { return static_cast<float>(1000 * row + link + 1); };
    for (const std::vector<int>& cuts : {std::vector{0, 84}, {0, 40, 84}, {0, 1, 2, 3}, {0, 1, 2, 3, 4, 5, 6, 7}, {0, 7, 9, 10, 30}}) {
        SCOPED_TRACE(testing::PrintToString(cuts));
        const int links = cuts.back();
        SegmentColumns columns;
        columns.lay_out(Partition::at(cuts));
        std::vector<model::FloatColumns> fields;
        SegmentEdges edges(rows);
        edges.make_room(columns.segments());
        for (int s = 0; s < columns.segments(); ++s) {
            model::FloatColumns& field = fields.emplace_back(rows, columns.count(s));
            for (int link = columns.segment(s).first; link < columns.segment(s).last; ++link) {
                for (int row = 0; row < rows; ++row) *field.at(row, link + columns.shift(s)) = number(row, link);
            }
            edges.give(columns, field, s);
        }
        for (int s = 0; s < columns.segments(); ++s) {
            model::FloatColumns& field = fields[at(s)];
            edges.take(columns, field, s);
            for (int link = columns.segment(s).first - 1; link <= columns.segment(s).last; ++link) {
                for (int row = 0; row < rows; ++row)
                    EXPECT_EQ(*field.at(row, link + columns.shift(s)), number(row, (link + 10 * links) % links)) << "segment " << s;
            }
        }
    }
}

TEST(SegmentColumns, OfOneSegmentAreLinksSideBySide) {
    SegmentColumns columns;
    columns.lay_out(Partition::equal(84, 1));
    EXPECT_EQ(columns.shift(0), 1);
    EXPECT_EQ(columns.count(0), 86);
}

}  // namespace
}  // namespace cvtflow::tasks
