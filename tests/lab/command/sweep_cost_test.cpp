/// cvtflow-lab sweep-cost and run-cost: what a sweep and a run cost beside the bare loop of their steps.

#include <gmock/gmock.h>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;

class SweepCostCommand : public Program {};

TEST_F(SweepCostCommand, ComparesTheSweepWithItsBareSteps) {
    write("sweep.toml",
          "[sweep]\nscene = \"tiny\"\n[set]\nrun.until = \"20 us\"\nstart.settling_time = \"10 us\"\nstart.ramp_time = \"5 us\"\n"
          "[[axes]]\nkey = \"load.torque\"\nvalues = [5, 10]\n[outputs]\nscalars = [\"slip mean\"]\n");
    const Outcome outcome = run({"sweep-cost", "sweep.toml", "--rounds", "1", "--threads", "2"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("sweep: 2 cases, "), HasSubstr("\n  bare step loop "), HasSubstr("\n  2 threads ")));
    EXPECT_THAT(outcome.out, ContainsRegex("results hash +[0-9a-f]{16}\n"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "results")) << "it keeps no results";
}

class RunCostCommand : public Program {};

TEST_F(RunCostCommand, ComparesOutputsAndARecordWithBareSteps) {
    const Outcome outcome = run({"run-cost", "tiny", "--until", "20 us", "--rounds", "3", "--set", "run.output_interval=2us", "--set",
                                 "start.settling_time=10us", "--set", "start.ramp_time=5us"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out,
                AllOf(HasSubstr("tiny: outputs every 2 us, medians of 3 rounds\n"), ContainsRegex("\n  bare steps +[0-9.]+ *\n"),
                      ContainsRegex("\n  observed( +[-+0-9.]+)( +[-+0-9.]+ %){3}\n"),
                      ContainsRegex("\n  recorded( +[-+0-9.]+)( +[-+0-9.]+ %){3}\n")));
    EXPECT_TRUE(std::filesystem::is_empty(folder_)) << "it keeps no record";
}

}  // namespace
}  // namespace cvtflow::bench
