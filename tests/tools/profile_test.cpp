#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ProfileCommand : public Program {};

TEST_F(ProfileCommand, MeasuresAndWritesItsFiles) {
    const Outcome outcome = run({"profile", "tiny", "--schedules", "serial:staged,flow:fused,flow:staged", "--threads", "2", "--steps", "4", "--rounds", "1",
                                 "--neighbours", "0,1", "--csv", "p.csv", "--json", "p.json", "--trace", "t.json", "-q"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("tiny: 4 schedules"), HasSubstr("\nflow:staged "), HasSubstr("\nStages by thread:"), HasSubstr("\nBeside busy neighbours"),
                                   HasSubstr("\nWhere sequential time goes (serial:staged)"), HasSubstr("\nCritical path")));
    EXPECT_THAT(read("p.csv"), testing::StartsWith("scene,schedule,"));
    EXPECT_EQ(nlohmann::json::parse(read("p.json"))["schedules"].size(), 4u);
    EXPECT_GT(nlohmann::json::parse(read("t.json"))["traceEvents"].size(), 20u);
}

TEST_F(ProfileCommand, SaysWhatItDoesNotKnow) {
    const Outcome outcome = run({"profile", "tiny", "--schedules", "flaw"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr("there is no executor 'flaw' (did you mean \"flow\"?)"));
}

}  // namespace
}  // namespace cvtflow::tools
