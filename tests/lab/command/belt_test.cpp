#include <gmock/gmock.h>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using testing::HasSubstr;
using testing::StartsWith;

class BeltCommand : public Program {};

TEST_F(BeltCommand, WritesPointsAndArcs) {
    const Outcome outcome = run({"belt", "control", "--ratios", "1,0.7", "--loads", "0.3,1.2", "-o", "b"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("friction cannot carry this difference of tensions"));
    EXPECT_THAT(read("b/belt.csv"), StartsWith("ratio,load,torque_Nm,growth_m_per_s,status,"));
    EXPECT_THAT(read("b/belt.csv"), HasSubstr("\n0.7,1.2,"));
    EXPECT_THAT(read("b/arcs.csv"), StartsWith("ratio,load,pulley,angle,tension_N,"));
}

/// Each part that is left out changes the result, and so do pins that vibrate.
TEST_F(BeltCommand, LeavesPartsOut) {
    const std::vector<std::string> words{"belt", "baseline", "--ratios", "0.7", "--csv", "-o", "b"};
    ASSERT_EQ(run(words).status, 0);
    const std::string whole = read("b/belt.csv");
    for (const char* part : {"tilt", "yield", "stretch", "crown"}) {
        ASSERT_EQ(run(words + std::vector<std::string>{"--without", part}).status, 0) << part;
        EXPECT_NE(read("b/belt.csv"), whole) << part;
    }
    ASSERT_EQ(run(words + std::vector<std::string>{"--vibration", "0.01"}).status, 0);
    EXPECT_NE(read("b/belt.csv"), whole);
}

TEST_F(BeltCommand, RefusesWhatItDoesNotKnow) {
    EXPECT_EQ(run({"belt", "baseline", "--without", "nothing"}).status, 2);
    const Outcome ring = run({"belt", "free_ring"});
    EXPECT_EQ(ring.status, 2);
    EXPECT_THAT(ring.err, HasSubstr("free_ring has no pulleys"));
}

}  // namespace
}  // namespace cvtflow::bench
