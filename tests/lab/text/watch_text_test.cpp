/// Every command that compares runs shows the watch over a run, and offers automatic steps.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

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
const std::vector<std::string> candidates{"rk4@200ns", "leapfrog-chebyshev@auto", "--reference", "rk4@25ns", "-o", "out"};

TEST_F(WatchText, CompareMarksWhatIsUnreliable) {
    const Outcome outcome =
        run(std::vector<std::string>{"compare", "control", "-q", "--duration", "120us", "--rounds", "1", "--pin", "first"} + candidates);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.err, testing::StartsWith("cvtflow-lab: rk4@200ns: unreliable: the residual of the energy balance is "));
    EXPECT_THAT(outcome.out, ContainsRegex("\n  rk4@200ns .* unreliable\n"));
    EXPECT_THAT(outcome.out, ContainsRegex("\n  leapfrog-chebyshev@auto +1\\.[0-9]+ us .* finished\n"));
    EXPECT_THAT(outcome.out, ContainsRegex("\n  too short +120 us are 0\\.17 pin periods: means of slip and efficiency require 16 "));
    EXPECT_THAT(read("out/compare_control.csv"),
                AllOf(HasSubstr(",status,residual,suspicion,pin_periods,long_enough,mean_slip,efficiency\n"),
                      ContainsRegex("\nrk4@200ns,.*,unreliable,"),
                      ContainsRegex("\nleapfrog-chebyshev@auto,.*,finished,[^,]*,[^,]*,0\\.1[0-9]*,0,")));
    const auto json = nlohmann::json::parse(read("out/compare_control.json"));
    EXPECT_EQ(json["choices"][0]["status"], "unreliable");
    EXPECT_GT(double(json["choices"][0]["suspicion"]), 1.0);
    EXPECT_EQ(json["reference_watch"]["long_enough"], false);
}

TEST_F(WatchText, DetailHasAStatusAndNoFiguresForWhatIsUnreliable) {
    // Twenty outputs in a window as short as this one, and the shorter steps between them: it begins with the shock of a start.
    const std::vector<std::string> brief{"detail", "baseline", "--settle",  "200us", "--average", "200us",
                                         "-o",     "out",      "--control", "0 s",   "--set",     "run.output_interval=10us"};
    const Outcome all = run(brief + std::vector<std::string>{"--method", "rk4", "--step", "200ns"});
    EXPECT_EQ(all.status, 1);
    EXPECT_THAT(all.err, testing::StartsWith(
                             "cvtflow-lab: baseline: the reference, full detail, is unreliable: the residual of the energy balance is "));
    EXPECT_EQ(all.out, "");
    const Outcome good = run(brief);
    EXPECT_EQ(good.status, 0) << good.err;
    EXPECT_THAT(good.out, ContainsRegex("\n  lumped 1 pt rigid .* finished\n"));
    EXPECT_THAT(good.out, ContainsRegex("\n  too short +200 us are 0\\.28 pin periods: "));
    EXPECT_THAT(read("out/detail_baseline.csv"), AllOf(HasSubstr(",drift,status,residual,"), Not(HasSubstr("unreliable"))));
    EXPECT_EQ(nlohmann::json::parse(read("out/detail_baseline.json"))["variants"][0]["status"], "finished");
}

TEST_F(WatchText, DetailLeavesOutOneVariantThatIsUnreliable) {
    // Euler's method makes energy in the jolt that rigid sheaves come with.
    const Outcome outcome = run({"detail", "baseline", "--method", "euler", "--step", "20ns", "--settle", "1us", "--average", "1us",
                                 "--control", "0 s", "-o", "out"});
    EXPECT_EQ(outcome.status, 5);
    EXPECT_THAT(outcome.err, HasSubstr("cvtflow-lab: baseline: each   8 pt rigid: unreliable: the residual of the energy balance is "));
    EXPECT_THAT(outcome.out, ContainsRegex("\n  each   8 pt rigid +1684 +- +- +- +- +- +- +- +- +- +- +unreliable\n"));
    EXPECT_THAT(read("out/detail_baseline.csv"), HasSubstr("\nhalves,each,8,rigid,1,1684,,,,,,,,,,unreliable,,,,,,\n"));
    EXPECT_THAT(read("out/detail_baseline.json"), HasSubstr("\"status\": \"unreliable\""));
}

TEST_F(WatchText, AutomaticStepsAreChoicesWhereverAMethodAndItsStepAreRead) {
    const Outcome compare = run({"compare", "tiny", "leapfrog-rkc@auto", "rk4@auto", "--reference", "rk4@auto", "--rounds", "1", "--set",
                                 "start.settling_time=20us", "--set", "start.ramp_time=10us"});
    EXPECT_EQ(compare.status, 0) << compare.err;
    EXPECT_THAT(compare.out, ContainsRegex("\n  rk4@auto .* 0\\.0e\\+00 ")) << "the reference itself";
    EXPECT_EQ(run({"compare", "tiny", "rk4@Auto", "-q"}).err, "cvtflow-lab: rk4@Auto: 'Auto' is not a time above 0, such as 40ns\n");
}

}  // namespace
}  // namespace cvtflow::bench
