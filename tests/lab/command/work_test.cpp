#include <gmock/gmock.h>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class WorkCommand : public Program {};
class DrawCommand : public Program {};

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

TEST_F(DrawCommand, DrawsPicturesBelowOneAnother) {
    write("p.json", R"([{"title": "One", "x": {"label": "step [s]", "scale": "log"}, "y": {"label": "error", "from": 0, "to": 2},
                         "series": [{"name": "curve", "points": [[1e-6, 1], [1e-5, 2]], "mark": "none", "line": "dashed"}]},
                        {"title": "Two", "x": {"label": "a"}, "y": {"label": "b"}, "series": [{"points": [[0, 0], [1, 1]]}]}])");
    const Outcome outcome = run({"draw", "p.json", "-o", "p.svg"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(read("p.svg"), AllOf(HasSubstr(">One</text>"), HasSubstr(">Two</text>"), HasSubstr(">curve</text>")));
}

TEST_F(DrawCommand, NamesWhatIsWrongWithAPicture) {
    write("p.json", R"([{"title": "One", "x": {"label": "a", "scale": "cubic"}, "y": {"label": "b"}, "series": []}])");
    const Outcome cubic = run({"draw", "p.json", "-o", "p.svg"});
    EXPECT_EQ(cubic.status, 2);
    EXPECT_THAT(cubic.err, HasSubstr("cubic: no scale of a picture"));
    write("p.json", R"([{"title": "One"}])");
    EXPECT_EQ(run({"draw", "p.json", "-o", "p.svg"}).status, 2);
    EXPECT_FALSE(exists("p.svg"));
}

}  // namespace
}  // namespace cvtflow::bench
