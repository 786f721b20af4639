#include <gmock/gmock.h>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class CompareNewton : public Program {};

const std::vector<std::string> brief{
    "--set",   "start.settling_time=20us", "--set", "start.ramp_time=10us", "--duration", "4us", "--interval", "4us", "--rounds", "1",
    "--newton"};

TEST_F(CompareNewton, ShowsIterationsOfVariantsAndNoneOfLinearlyImplicitMethods) {
    std::vector<std::string> words{"compare", "tiny", "trapezoidal-analytic@1us", "trapezoidal-analytic@2us", "sw2@2us"};
    words.insert(words.end(), brief.begin(), brief.end());
    const Outcome outcome = run(words);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.err, StartsWith("cvtflow-lab: settling 20 us first\n"));
    EXPECT_THAT(outcome.out, AllOf(HasSubstr(" iterations  most  Jacobians  halvings  fell back  unconverged "),
                                   testing::ContainsRegex("\n  trapezoidal-analytic@1us +[0-9.]+ [nu]s .* [1-9][0-9.]* +[1-9][0-9]* "),
                                   HasSubstr("\n  trapezoidal-analytic@2us "), HasSubstr("\n  sw2@2us ")));
}

TEST_F(CompareNewton, KeepsFaultsInTheirRow) {
    const Outcome outcome = run({"compare", "tiny", "euler@4us", "--newton", "--duration", "400us", "--interval", "4us", "--rounds", "1",
                                 "-q", "--reference", "rk4@50ns", "--set", "start.settling_time=20us", "--set", "start.ramp_time=10us"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.err, HasSubstr("cvtflow-lab: euler@4us: "));
    EXPECT_THAT(outcome.out, testing::ContainsRegex("\n  euler@4us .* lost +lost "));
}

TEST_F(CompareNewton, ARunReportsHowNewtonFared) {
    const Outcome outcome =
        run({"run", "tiny", "--method", "trapezoidal-frozen", "--step", "1us", "--until", "10us", "--set", "start.settling_time=20us",
             "--set", "start.ramp_time=10us", "--set", "run.output_interval=10us", "--set", "run.schedule=serial", "-o", "t.h5"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("trapezoidal-frozen, step 1e-06 s"), HasSubstr(" iterations per step (max ")));
}

}  // namespace
}  // namespace cvtflow::bench
