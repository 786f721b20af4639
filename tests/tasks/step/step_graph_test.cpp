/// The graph of fused tasks has no races, and every task declares what it writes; the partitions that it is made for.

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "engine/method/catalogue.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/workspace.hpp"
#include "tests/engine/graph/graph_fixture.hpp"

namespace cvtflow::tasks {
namespace {

Scene unchanged_tiny() { return read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml"); }

bool declares(const engine::Task& task, Field field, bool write) {
    for (const engine::Access& access : task.accesses) {
        if (access.field == static_cast<int>(field) && access.write == write) return true;
    }
    return false;
}

TEST(FusedGraph, HasNoRacesForAnyNumberOfSegments) {
    for (const int segments : {1, 2, 3, 5, 7, 14, 24}) {
        const Workspace workspace(unchanged_tiny().parameters, engine::StagePlan(*engine::find_method("rk4")),
                                  Partition::equal(24, segments));
        const engine::TaskGraph graph = step_graph(workspace, {});
        EXPECT_TRUE(engine::race_check(graph).empty()) << segments;
        EXPECT_EQ(graph.size(), method_cycles * segments);
        EXPECT_EQ(graph.cycles(), method_cycles);
        for (int cycle = 0; cycle < method_cycles; ++cycle) EXPECT_EQ(graph.levels(cycle), 1) << "one synchronisation per cycle";
    }
}

TEST(FusedGraph, EveryTaskDeclaresWhatItsCycleWrites) {
    const Workspace workspace(unchanged_tiny().parameters, engine::StagePlan(*engine::find_method("rk4")), Partition::equal(24, 5));
    const engine::TaskGraph graph = step_graph(workspace, {});
    const std::vector<Field> written[] = {{Field::slope_written, Field::state_kept, Field::load, Field::account, Field::window},
                                          {Field::end_state, Field::after, Field::result},
                                          {Field::result},
                                          {Field::cut_state, Field::after, Field::phase, Field::result},
                                          {Field::cut_state, Field::load, Field::account, Field::window}};
    for (int task = 0; task < graph.size(); ++task) {
        const engine::Task& one = graph.task(task);
        for (const Field field : written[one.cycle])
            EXPECT_TRUE(declares(one, field, true)) << one.name << ", field " << static_cast<int>(field);
    }
}

TEST(Partition, CoversAllLinksOnceInOrder) {
    for (const int links : {3, 24, 84, 85}) {
        for (int segments = 1; segments <= links; ++segments) {
            const Partition partition = Partition::equal(links, segments);
            ASSERT_EQ(partition.size(), segments);
            int next = 0;
            for (const Segment& segment : partition.segments()) {
                EXPECT_EQ(segment.first, next);
                EXPECT_GT(segment.size(), 0);
                next = segment.last;
            }
            EXPECT_EQ(next, links);
        }
    }
}

TEST(Partition, SegmentsDifferByOneLinkAtMost) {
    for (int segments = 1; segments <= 84; ++segments) {
        const Partition partition = Partition::equal(84, segments);
        const auto [least, most] = std::minmax_element(partition.segments().begin(), partition.segments().end(),
                                                       [](const Segment& a, const Segment& b) { return a.size() < b.size(); });
        EXPECT_LE(most->size() - least->size(), 1);
    }
}

TEST(Partition, RefusesNoSegmentsAndMoreSegmentsThanLinks) {
    EXPECT_THROW(static_cast<void>(Partition::equal(24, 0)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(Partition::equal(24, -1)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(Partition::equal(24, 25)), std::invalid_argument);
}

}  // namespace
}  // namespace cvtflow::tasks
