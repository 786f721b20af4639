/// Every command that compares runs shows the watch over a run, and offers automatic steps.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "bench/lab/text/text.hpp"
#include "tests/engine/graph/graph_fixture.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class WatchText : public Program {};

// The classical method is stable to 53 ns there, and at 200 ns no fault comes of it.
const std::vector<std::string> candidates{"rk4@200ns", "leapfrog-sweep@auto", "--reference", "rk4@25ns", "-o", "out"};

TEST_F(WatchText, CompareMarksWhatIsUnreliable) {
    const Outcome outcome =
        run(std::vector<std::string>{"compare", "control", "-q", "--duration", "120us", "--rounds", "1", "--pin", "first"} + candidates);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.err, testing::StartsWith("cvtflow-lab: rk4@200ns: unreliable: the residual of the energy balance is "));
    EXPECT_THAT(outcome.out, ContainsRegex("\n  rk4@200ns .* unreliable\n"));
    EXPECT_THAT(outcome.out, ContainsRegex("\n  leapfrog-sweep@auto +2\\.[0-9]+ us .* finished\n"));
    EXPECT_THAT(outcome.out, ContainsRegex("\n  too short +120 us are 0\\.17 pin periods: means of slip and efficiency require 16 "));
    EXPECT_THAT(
        read("out/compare_control.csv"),
        AllOf(HasSubstr(",status,residual,error_ratio,pin_periods,long_enough,mean_slip,efficiency\n"),
              ContainsRegex("\nrk4@200ns,.*,unreliable,"), ContainsRegex("\nleapfrog-sweep@auto,.*,finished,[^,]*,[^,]*,0\\.1[0-9]*,0,")));
    const auto json = nlohmann::json::parse(read("out/compare_control.json"));
    EXPECT_EQ(json["choices"][0]["status"], "unreliable");
    EXPECT_GT(double(json["choices"][0]["error_ratio"]), 1.0);
    EXPECT_EQ(json["reference_watch"]["long_enough"], false);
}

TEST_F(WatchText, AutomaticStepsAreChoicesWhereverAMethodAndItsStepAreRead) {
    const Outcome compare = run({"compare", "tiny", "leapfrog-sweep@auto", "rk4@auto", "--reference", "rk4@auto", "--rounds", "1", "--set",
                                 "start.settling_time=20us", "--set", "start.ramp_time=10us"});
    EXPECT_EQ(compare.status, 0) << compare.err;
    EXPECT_THAT(compare.out, ContainsRegex("\n  rk4@auto .* 0\\.0e\\+00 ")) << "the reference itself";
    EXPECT_EQ(run({"compare", "tiny", "rk4@Auto", "-q"}).err, "cvtflow-lab: rk4@Auto: 'Auto' is not a time above 0, such as 40ns\n");
}

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
