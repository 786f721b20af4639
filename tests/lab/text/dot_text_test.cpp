#include "bench/lab/text/text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/engine/graph/graph_fixture.hpp"

namespace cvtflow::bench {
namespace {

using testing::HasSubstr;

TEST(Dot, DrawsTasksByLevelsAndAllEdges) {
    EXPECT_EQ(to_dot(engine::test::diamond(), 0),
              "digraph cycle_0 {\n"
              "    rankdir=LR;\n"
              "    node [shape=box];\n"
              "    { rank=same; t0 [label=\"source\"]; }\n"
              "    { rank=same; t1 [label=\"left\"]; t2 [label=\"right\"]; }\n"
              "    { rank=same; t3 [label=\"sink\"]; }\n"
              "    t0 -> t1;\n"
              "    t0 -> t2;\n"
              "    t1 -> t3;\n"
              "    t2 -> t3;\n"
              "}\n");
}

TEST(Dot, NamesAreEscaped) {
    engine::TaskGraph graph;
    graph.add({R"(say "so" \ on)", 0, engine::test::record, 0, {}});
    graph.freeze();
    EXPECT_THAT(to_dot(graph, 0), HasSubstr(R"("say \"so\" \\ on")"));
}

}  // namespace
}  // namespace cvtflow::bench
