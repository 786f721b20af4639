#include "tests/engine/graph/race_check_fixture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "graph_fixture.hpp"

namespace cvtflow::engine {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(RaceCheck, ACompleteGraphHasNoConflicts) { EXPECT_THAT(race_check(test::diamond()), IsEmpty()); }

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

TEST(RaceCheck, ReadersTouchingRangesFieldsAndCyclesDoNotClash) {
    EXPECT_THAT(race_check(unordered({{0, {0, 0, 9, false}}, {0, {0, 0, 9, false}}})), IsEmpty()) << "two readers";
    EXPECT_THAT(race_check(unordered({{0, {0, 0, 5, true}}, {0, {0, 5, 9, true}}})), IsEmpty()) << "half-open ranges that touch";
    EXPECT_THAT(race_check(unordered({{0, {0, 0, 9, true}}, {0, {1, 0, 9, true}}})), IsEmpty()) << "different fields";
    EXPECT_THAT(race_check(unordered({{0, {0, 0, 9, true}}, {1, {0, 0, 9, true}}})), IsEmpty()) << "different cycles";
}

TEST(RaceCheck, WritersClashWithReadersAndWriters) {
    EXPECT_THAT(race_check(unordered({{0, {0, 0, 6, false}}, {0, {0, 5, 9, true}}})), ElementsAre(Conflict{0, 1, 0, 5, 6}));
    EXPECT_THAT(race_check(unordered({{1, {3, 0, 6, true}}, {1, {3, 2, 4, true}}})), ElementsAre(Conflict{0, 1, 3, 2, 4}));
}

TEST(RaceCheck, LongPathsCountAsOrder) {
    TaskGraph graph;
    for (int i = 0; i < 5; ++i) graph.add({"t", 0, test::record, i, {{0, 0, 1, true}}});
    for (const auto& [before, after] : {std::pair{4, 2}, {2, 0}, {0, 3}, {3, 1}}) graph.order(before, after);
    graph.freeze();
    EXPECT_THAT(race_check(graph), IsEmpty());
}

}  // namespace
}  // namespace cvtflow::engine
