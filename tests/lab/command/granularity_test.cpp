#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using testing::AllOf;
using testing::HasSubstr;

class GranularityCommand : public Program {};

TEST_F(GranularityCommand, ComparesExecutorsAndLeavesFiles) {
    const Outcome outcome = run({"granularity", "--executors", "serial,barrier", "--threads", "2", "--tasks", "1,4", "--lengths", "20,1",
                                 "--rounds", "1", "-o", "out", "-q"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("METG(50 %) [us]"), HasSubstr("M = 1"), HasSubstr("M = 4"), HasSubstr("\n  barrier "),
                                   HasSubstr("calibration got"), HasSubstr("oneTBB 20")));
    const std::string csv = read("out/granularity.csv");
    EXPECT_THAT(csv, testing::StartsWith("executor,threads,tasks,length_us,efficiency,"));
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 2 * 2 * 2);
    EXPECT_LT(csv.find("serial,1,1,1,"), csv.find("serial,1,1,20,")) << "lengths ascend";
    const auto json = nlohmann::json::parse(read("out/granularity.json"));
    EXPECT_EQ(json["curves"].size(), 4u);
    for (const char* key : {"compiler", "flags", "runtimes", "cores", "commit"}) EXPECT_TRUE(json["provenance"].contains(key)) << key;
    EXPECT_THAT(read("out/efficiency.svg"), AllOf(HasSubstr("1 task per level"), HasSubstr("4 tasks per level"), HasSubstr(">barrier<")));
    EXPECT_THAT(read("out/granularity.svg"), HasSubstr("METG(50 %) [us]"));
}

TEST_F(GranularityCommand, ReportsWhatItDoesNotKnow) {
    const Outcome unknown = run({"granularity", "--executors", "flaw"});
    EXPECT_EQ(unknown.status, 1);
    EXPECT_THAT(unknown.err, HasSubstr("there is no executor 'flaw' (did you mean \"flow\"?)"));
    EXPECT_EQ(run({"granularity", "--lengths", "-1"}).status, 2);
    EXPECT_EQ(run({"granularity", "--tasks", "0"}).status, 2);
}

}  // namespace
}  // namespace cvtflow::bench
