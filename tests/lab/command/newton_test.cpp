#include <gmock/gmock.h>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class NewtonCommand : public Program {};

const std::vector<std::string> brief{"--set",  "start.settling_time=20us", "--set", "start.ramp_time=10us", "--duration", "4us", "--steps",
                                     "1us,2us"};

TEST_F(NewtonCommand, TriesVariantsAndLinearlyImplicitMethods) {
    std::vector<std::string> words{"newton", "tiny", "--methods", "trapezoidal-analytic,sw2"};
    words.insert(words.end(), brief.begin(), brief.end());
    const Outcome outcome = run(words);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "cvtflow-lab: settling 20 us first\n");
    EXPECT_THAT(outcome.out, AllOf(StartsWith("tiny: 4 us against rk4 with 12.5 ns, with transitions ("), HasSubstr("unconverged"),
                                   HasSubstr("\n  trapezoidal-analytic  1 us "), HasSubstr("\n  trapezoidal-analytic  2 us "),
                                   HasSubstr("\n  sw2                   2 us ")));
}

TEST_F(NewtonCommand, SaysWhatItDoesNotKnow) {
    std::vector<std::string> words{"newton", "tiny", "--methods", "trapezium"};
    words.insert(words.end(), brief.begin(), brief.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr("no method 'trapezium' (cvtflow list methods)"));
    EXPECT_THAT(run({"newton", "tiny", "--duration", "3mm"}).err, HasSubstr("--duration 3mm: not a time above 0, such as 2us"));
}

TEST_F(NewtonCommand, KeepsFaultsOutOfItsTable) {
    const Outcome outcome = run({"newton", "tiny", "--methods", "euler", "--steps", "4us", "--duration", "400us", "--set",
                                 "start.settling_time=20us", "--set", "start.ramp_time=10us"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.err, HasSubstr("\ncvtflow-lab: euler with 4 us: "));
    EXPECT_THAT(outcome.out, testing::ContainsRegex("\n  euler +4 us .* - +-\n"));
}

TEST_F(NewtonCommand, ARunSaysHowNewtonFared) {
    const Outcome outcome =
        run({"run", "tiny", "--method", "trapezoidal-frozen", "--step", "1us", "--until", "10us", "--set", "start.settling_time=20us",
             "--set", "start.ramp_time=10us", "--set", "run.output_interval=10us", "--set", "run.schedule=serial", "-o", "t.h5"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("trapezoidal-frozen, step 1e-06 s"), HasSubstr(" iterations per step (max ")));
}

}  // namespace
}  // namespace cvtflow::bench
