/// The published schedule: every edge of its graph on which data flow is needed.

#include <gtest/gtest.h>

#include "engine/method/catalogue.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/step/step_graph.hpp"
#include "tests/engine/graph/graph_fixture.hpp"

namespace cvtflow::tasks {
namespace {

/// Whether two tasks touch the same elements and one of them writes.
bool share_data(const engine::Task& a, const engine::Task& b) {
    for (const engine::Access& x : a.accesses) {
        for (const engine::Access& y : b.accesses) {
            if (x.field == y.field && x.begin < y.end && y.begin < x.end && (x.write || y.write)) return true;
        }
    }
    return false;
}

TEST(StepGraph, RemovingAnyEdgeOnWhichDataFlowIsFoundByTheRaceCheck) {
    const Scene scene = read_scene(CVTFLOW_SOURCE_DIR "/scenes/shift.toml");
    const Workspace workspace(scene.parameters, *engine::find_method("rk4"), Partition::equal(84, 5));
    const engine::TaskGraph graph = step_graph(workspace, {Assembly::staged});
    int with_data = 0;
    int barriers = 0;
    for (int before = 0; before < graph.size(); ++before) {
        for (const int after : graph.successors(before)) {
            // No stage is skipped, so a removed edge leaves no other path between its ends.
            const bool matters = share_data(graph.task(before), graph.task(after));
            EXPECT_EQ(!engine::race_check(engine::test::without_edge(graph, before, after)).empty(), matters)
                << graph.task(before).name << " -> " << graph.task(after).name;
            ++(matters ? with_data : barriers);
        }
    }
    EXPECT_GE(with_data, 5 * 5);  // contact reads the stage state of all segments
    EXPECT_GT(barriers, 0);       // the published barriers order more than the data ask for
}

TEST(StagedAssembly, IsRefusedToRigidPins) {
    try {
        (void)parse_scene("[detail]\nlevel = \"rigid\"\n[run]\nassembly = \"staged\"\n", "scene.toml");
        FAIL() << "accepted";
    } catch (const SceneError& refused) {
        EXPECT_STREQ(refused.what(),
                     "scene.toml:4:12: run.assembly: \"staged\" requires detail.pins = \"halves\": rigid pins have no separate joints");
    }
}

}  // namespace
}  // namespace cvtflow::tasks
