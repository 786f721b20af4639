#include <gmock/gmock.h>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class WorkCommand : public Program {};

TEST_F(WorkCommand, CountsInstructionsByStageAndByThreads) {
    const Outcome outcome =
        run({"work", "tiny", "--method", "rk4", "--step", "50 ns", "--segments", "2", "-q", "-o", "w", "--set", "scene.name=a,b;=1+1"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_THAT(outcome.out, AllOf(StartsWith("a,b;=1+1: work of a step of rk4, 50 ns long, kernels "),
                                   HasSubstr("\n  all forces (fused) "), HasSubstr(" 2 ")));
    EXPECT_THAT(read("w/work.csv"), StartsWith("scene,method,kernels,threads,links,even,segments,instructions,fixed,claimed,"));
    EXPECT_THAT(read("w/stages.csv"), StartsWith("scene,method,kernels,step_s,stage,instructions,share,commit\n\"a,b;=1+1\",rk4,"));
    EXPECT_THAT(read("w/work.svg"), HasSubstr("Speed-up of a,b;=1+1 by counted instructions"));
}

TEST_F(WorkCommand, RefusesMoreSegmentsThanLinks) {
    const Outcome outcome = run({"work", "tiny", "--segments", "1000"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr("--segments 1000: the chain has "));
}

TEST_F(WorkCommand, CountsTheTasksOfALeapfrog) {
    const Outcome outcome = run({"work", "tiny", "--method", "leapfrog-sweep", "--step", "500 ns", "--segments", "1", "-q"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    for (const char* task : {"observe", "record", "friction"}) EXPECT_THAT(outcome.out, HasSubstr(task));
}

TEST_F(WorkCommand, CountsTheTasksOfRigidPins) {
    const Outcome outcome = run({"work", "tiny", "--detail", "rigid", "--method", "auto", "--segments", "1", "-q"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    for (const char* task : {"links", "plates", "tips", "kick"}) EXPECT_THAT(outcome.out, HasSubstr(task));
}

}  // namespace
}  // namespace cvtflow::bench
