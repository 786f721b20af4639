#include "engine/graph/task_graph.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "tests/engine/graph/graph_fixture.hpp"

namespace cvtflow::engine {
namespace {

using test::record;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

Task task(const char* name, int cycle) { return {name, cycle, record, 0, {}}; }

TEST(TaskGraph, OrdersTasksByLevelsThenNumbers) {
    TaskGraph graph;
    for (const char* name : {"last", "first", "middle", "free"}) graph.add(task(name, 0));
    graph.order(2, 0);
    graph.order(1, 2);
    graph.order(1, 0);
    graph.freeze();
    EXPECT_THAT(graph.topological(0), ElementsAre(1, 3, 2, 0));
    ASSERT_EQ(graph.levels(0), 3);
    EXPECT_THAT(graph.level(0, 0), ElementsAre(1, 3));
    EXPECT_THAT(graph.level(0, 1), ElementsAre(2));
    EXPECT_THAT(graph.level(0, 2), ElementsAre(0));
}

TEST(TaskGraph, SuccessorsAndPredecessorCountsMatchTheEdges) {
    const TaskGraph graph = test::diamond();  // whose edges are kept once
    EXPECT_THAT(graph.successors(0), ElementsAre(1, 2));
    EXPECT_THAT(graph.successors(1), ElementsAre(3));
    EXPECT_THAT(graph.successors(3), IsEmpty());
    EXPECT_EQ(graph.predecessor_count(0), 0);
    EXPECT_EQ(graph.predecessor_count(2), 1);
    EXPECT_EQ(graph.predecessor_count(3), 2);
}

TEST(TaskGraph, CyclesAreKeptApartAndMayBeEmpty) {
    TaskGraph graph;
    for (const int cycle : {2, 0, 2, 0}) graph.add(task("t", cycle));
    graph.order(2, 0);
    graph.freeze();
    ASSERT_EQ(graph.cycles(), 3);
    EXPECT_THAT(graph.topological(0), ElementsAre(1, 3));
    EXPECT_THAT(graph.topological(1), IsEmpty());
    EXPECT_THAT(graph.topological(2), ElementsAre(2, 0));
    EXPECT_EQ(graph.levels(0), 1);
    EXPECT_EQ(graph.levels(1), 0);
    EXPECT_EQ(graph.levels(2), 2);
    EXPECT_THAT(graph.level(2, 1), ElementsAre(0));
}

TEST(TaskGraph, RingsAreRejected) {
    TaskGraph graph;
    for (const char* name : {"a", "b", "c", "d"}) graph.add(task(name, 0));
    for (const auto& [before, after] : {std::pair{0, 1}, {0, 1}, {1, 2}, {2, 1}, {2, 3}}) graph.order(before, after);
    EXPECT_THAT([&] { graph.freeze(); }, ThrowsMessage<std::invalid_argument>(HasSubstr("task b")));
    EXPECT_FALSE(graph.frozen());
}

TEST(TaskGraph, UnsoundTasksAndEdgesAndChangesOfAFrozenGraphAreRejected) {
    TaskGraph graph, frozen = test::diamond();
    EXPECT_THROW(graph.add({"bodiless", 0, nullptr, 0, {}}), std::invalid_argument);
    EXPECT_THROW(graph.add(task("nowhere", -1)), std::invalid_argument);
    EXPECT_THROW(graph.add({"empty", 0, record, 0, {{0, 4, 4, true}}}), std::invalid_argument);
    graph.add(task("a", 0));
    graph.add(task("b", 1));
    EXPECT_THAT([&] { graph.order(0, 1); }, ThrowsMessage<std::invalid_argument>(HasSubstr("leaves its cycle")));
    for (const auto& [before, after] : {std::pair{0, 2}, {-1, 0}, {0, 0}}) EXPECT_THROW(graph.order(before, after), std::invalid_argument);
    EXPECT_THROW(frozen.add(task("late", 0)), std::logic_error);
    EXPECT_THROW(frozen.order(0, 3), std::logic_error);
    EXPECT_THROW(frozen.freeze(), std::logic_error);
}

TEST(RaceCheck, EveryRemovedEdgeIsFound) {
    for (int skip = 0; skip < static_cast<int>(test::diamond_edges.size()); ++skip) {
        const auto [before, after] = test::diamond_edges[static_cast<std::size_t>(skip)];
        const std::vector<Conflict> conflicts = race_check(test::diamond(skip));
        const auto of_edge = [before = before, after = after](const Conflict& c) { return c.first == before && c.second == after; };
        EXPECT_TRUE(std::any_of(conflicts.begin(), conflicts.end(), of_edge)) << "edge " << skip;
    }
}

TEST(RaceCheck, NamesTheClashingRange) {
    EXPECT_THAT(race_check(test::diamond(1)), ElementsAre(Conflict{0, 2, 0, 4, 8}));
    EXPECT_EQ(describe(test::diamond(1), {0, 2, 0, 4, 8}), "source and right clash on field 0, elements 4…7");
}

/// Graph of unordered tasks with one access each.
TaskGraph unordered(const std::vector<std::pair<int, Access>>& tasks) {
    TaskGraph graph;
    for (const auto& [cycle, access] : tasks) graph.add({"t", cycle, test::record, 0, {access}});
    graph.freeze();
    return graph;
}

TEST(RaceCheck, FindsWritersBesideReadersAndWritersAndNothingElse) {
    EXPECT_THAT(race_check(test::diamond()), IsEmpty());
    EXPECT_THAT(race_check(unordered({{0, {0, 0, 9, false}}, {0, {0, 0, 9, false}}})), IsEmpty()) << "two readers";
    EXPECT_THAT(race_check(unordered({{0, {0, 0, 5, true}}, {0, {0, 5, 9, true}}})), IsEmpty()) << "half-open ranges that touch";
    EXPECT_THAT(race_check(unordered({{0, {0, 0, 9, true}}, {0, {1, 0, 9, true}}})), IsEmpty()) << "different fields";
    EXPECT_THAT(race_check(unordered({{0, {0, 0, 9, true}}, {1, {0, 0, 9, true}}})), IsEmpty()) << "different cycles";
    EXPECT_THAT(race_check(unordered({{0, {0, 0, 6, false}}, {0, {0, 5, 9, true}}})), ElementsAre(Conflict{0, 1, 0, 5, 6}));
    EXPECT_THAT(race_check(unordered({{1, {3, 0, 6, true}}, {1, {3, 2, 4, true}}})), ElementsAre(Conflict{0, 1, 3, 2, 4}));
    TaskGraph path;
    for (int i = 0; i < 5; ++i) path.add({"t", 0, test::record, i, {{0, 0, 1, true}}});
    for (const auto& [before, after] : {std::pair{4, 2}, {2, 0}, {0, 3}, {3, 1}}) path.order(before, after);
    path.freeze();
    EXPECT_THAT(race_check(path), IsEmpty()) << "long paths are an order";
}

}  // namespace
}  // namespace cvtflow::engine
