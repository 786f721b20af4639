/// The graph of fused tasks has no races, and every task declares what it writes; the partitions that it is made for.

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "engine/method/catalogue.hpp"
#include "tasks/method/method.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/workspace.hpp"
#include "tests/engine/graph/graph_fixture.hpp"
#include "tests/sample_fixture.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

bool declares(const engine::Task& task, Field field, bool write) {
    for (const engine::Access& access : task.accesses) {
        if (access.field == static_cast<int>(field) && access.write == write) return true;
    }
    return false;
}

TEST(StepGraph, HasNoRaces) {
    const Scene scene = read_scene(scene_file("baseline"));
    for (const std::string name : {"rk4", "leapfrog-sweep"}) {
        const std::vector<int> all{1, 2, 3, 5, 7, 84};
        for (const int segments : name == "rk4" ? all : cvtflow::test::depth(std::vector{1, 5}, all)) {
            Workspace workspace(scene.parameters, Method(name).plan(), Partition::equal(84, segments));
            const auto method = Method(name).make(workspace);
            for (const Assembly kind : test::assemblies()) {
                for (const AssemblyOptions& options : {AssemblyOptions{kind}, {kind, false, true}})
                    EXPECT_TRUE(engine::race_check(step_graph(workspace, options, method.get())).empty()) << name << " " << segments;
            }
        }
    }
}

TEST(FusedGraph, HasOneSynchronisationPerCycle) {
    for (const int segments : {1, 2, 3, 5, 7, 14, 24}) {
        const Workspace workspace(tiny_parameters(), engine::StagePlan(*engine::find_method("rk4")), Partition::equal(24, segments));
        const engine::TaskGraph graph = step_graph(workspace, {});
        EXPECT_EQ(graph.size(), method_cycles * segments);
        EXPECT_EQ(graph.cycles(), method_cycles);
        for (int cycle = 0; cycle < method_cycles; ++cycle) EXPECT_EQ(graph.levels(cycle), 1);
    }
}

TEST(FusedGraph, EveryTaskDeclaresWhatItsCycleWrites) {
    const Workspace workspace(tiny_parameters(), engine::StagePlan(*engine::find_method("rk4")), Partition::equal(24, 5));
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

TEST(Partition, CoversAllLinksOnceInOrderBySegmentsThatDifferByOneLinkAtMost) {
    for (const int links : {3, 24, 84, 85}) {
        for (int segments = 1; segments <= links; ++segments) {
            const Partition partition = Partition::equal(links, segments);
            ASSERT_EQ(partition.size(), segments);
            int next = 0;
            for (const Segment& segment : partition.segments()) {
                EXPECT_EQ(segment.first, next);
                EXPECT_TRUE(segment.size() == links / segments || segment.size() == (links + segments - 1) / segments);
                next = segment.last;
            }
            EXPECT_EQ(next, links);
        }
    }
}

TEST(Partition, RefusesNoSegmentsAndMoreSegmentsThanLinks) {
    for (const int segments : {0, -1, 25})
        EXPECT_THROW(static_cast<void>(Partition::equal(24, segments)), std::invalid_argument) << segments;
}

}  // namespace
}  // namespace cvtflow::tasks
