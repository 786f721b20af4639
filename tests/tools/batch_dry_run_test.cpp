#include <gmock/gmock.h>

#include "tests/tools/batch_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

using BatchDryRun = Sweeps;

/// 12 um are reached 1.6 us after the settling: a case of 0.2 us knows nothing of that.
TEST_F(BatchDryRun, MeasuresNoStepBeyondACasesEnd) {
    write_sweep("\"12 N*m\"", "0.2 us", "");
    std::string sweep = read("sweep.toml");
    sweep.replace(sweep.find("start.settling_time = \"20 us\"\nstart.ramp_time = \"10 us\""), 0,
                  "tip.deepest = \"12 um\"\nrun.output_interval = \"50 ns\"\nrun.state_interval = \"100 ns\"\n");
    sweep.replace(sweep.find("\"ratio at 20 us\""), 16, "\"ratio at 0.2 us\"");
    write("sweep.toml", sweep);
    const Outcome dry = batch({"--dry-run"});
    EXPECT_THAT(dry.out, HasSubstr("(measured on 3 cases, ")) << dry.err;
    EXPECT_EQ(batch().status, 0);
}

TEST_F(BatchDryRun, ReportsWhyNoCaseCouldBeTried) {
    write_sweep("\"12 N*m\"", "40 us", "");
    std::string sweep = read("sweep.toml");
    sweep.replace(sweep.find("run.until"), 0, "run.method = \"leapfrog-chebyshev\"\ndetail.pins = \"rigid\"\n");
    write("sweep.toml", sweep);
    const Outcome dry = batch({"--dry-run"});
    EXPECT_THAT(dry.out, HasSubstr("estimate            none: every case has inconsistent parameters"));
    EXPECT_EQ(dry.status, 5) << "nothing can run";
}

TEST_F(BatchDryRun, PrintsCasesAndAnEstimate) {
    write_sweep();
    const Outcome outcome = batch({"--dry-run"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.out, AllOf(StartsWith("sweep: 12 cases\n"), HasSubstr("load.torque [N*m]"),
                                   testing::ContainsRegex("  estimate            [a-z0-9. ]+ s on one thread, "),
                                   testing::ContainsRegex("  disk                [0-9.]+ kB of results")));
    EXPECT_FALSE(exists("out"));
}

}  // namespace
}  // namespace cvtflow::tools
