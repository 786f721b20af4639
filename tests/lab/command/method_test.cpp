/// The commands about methods: method, compare.

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "engine/method/catalogue.hpp"
#include "tasks/method/method.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class MethodCommands : public Program {};

TEST_F(MethodCommands, MethodShowsWhatTheTableImplies) {
    const Outcome rk4 = run({"method", "rk4"});
    EXPECT_EQ(rk4.status, 0);
    EXPECT_THAT(rk4.out,
                AllOf(HasSubstr("4 evaluations a step"), HasSubstr("order               4\n"), HasSubstr("stable to h|lambda| = 2.785"),
                      HasSubstr("stable to 2.828"), HasSubstr("error estimate      none"),
                      HasSubstr("y(t + h) = Y0 + 0.166666666667 h K0 + 0.333333333333 h K1 + 0.333333333333 h K2 + 0.166666666667 h K3")));
    const Outcome dumka = run({"method", "dumka3-p5", "--real", "200"});
    EXPECT_THAT(dumka.out, AllOf(HasSubstr("28 evaluations, the last one is reused by the next step: 27 per step"),
                                 HasSubstr("order               3(2)"), HasSubstr("to 4.66"), HasSubstr("by 567"),
                                 HasSubstr("--table prints the 28 stages")));
    EXPECT_THAT(run({"method", "dumka3-p5", "--table"}).out, HasSubstr("\n   27  K4 = f(t + 1 h, "));
    EXPECT_THAT(run({"method", "fitted-l100-w1"}).out, HasSubstr("order               3 to "));
    EXPECT_THAT(run({"method", "dumka3"}).out, AllOf(HasSubstr("depends on the step"), HasSubstr("stable to 5.067e+04 in h|lambda|")));
    EXPECT_THAT(run({"method", "leapfrog-sweep"}).out,
                AllOf(HasSubstr("1 per step\n"), HasSubstr("one per contact and sweep, for friction"),
                      HasSubstr("stable to 2 in h omega\n"), HasSubstr("stable without limit in h|lambda|")));
    EXPECT_THAT(run({"method", "ros34pw2"}).out,
                AllOf(HasSubstr("4 a step, for the whole state"), HasSubstr("oscillations        stable without limit")));
}

TEST_F(MethodCommands, UnknownNamesAreExplained) {
    const std::vector<std::pair<std::string, std::string>> mistakes{
        {"rkc-s1",
         "cvtflow-lab: no method 'rkc-s1': rkc-s<stages>[-e<damping>] takes 2 to 400 stages, damping 0 to 100 (2/13 if absent)\n"},
        {"serk2-s15", "cvtflow-lab: no method 'serk2-s15': serk2-s<stages> takes 10, 20, ... 250 stages\n"},
        {"fitted-l200",
         "cvtflow-lab: no method 'fitted-l200': fitted-l<real>-w<imaginary>[-s<stages>][-p<order>][-r<ripple>] takes real 5 to 8000, "
         "imaginary "
         "up to 50, 4 to 150 stages (the fewest if absent), order 2 or 3, ripple up to 1 (0.2 if absent)\n"},
        {"dumka3-p15", "cvtflow-lab: no method 'dumka3-p15' (did you mean 'dumka3-p1'?)\n"},
        {"magic", "cvtflow-lab: no method 'magic' (cvtflow list methods)\n"}};
    for (const auto& [name, message] : mistakes) {
        const Outcome outcome = run({"method", name});
        EXPECT_EQ(outcome.status, 2) << name;
        EXPECT_EQ(outcome.err, message);
        const std::string reason = std::string(message).substr(std::string("cvtflow-lab: ").size());
        const char* program = tasks::belongs_to_laboratory(name) ? "cvtflow-lab" : "cvtflow";
        EXPECT_EQ(run({"run", "tiny", "--method", name}).err, program + (": --method " + name) + ": " + reason);
    }
}

TEST_F(MethodCommands, ListShowsFamiliesAndMethodsThatFollowTheSpectrum) {
    const std::string list = run({laboratory, "list", "methods", "--all"}).out;
    for (const engine::MethodFamily& family : engine::method_families()) EXPECT_THAT(list, HasSubstr(std::string(family.form)));
    for (const char* name : {"\ndumka3 ", "\nrkc ", "\nfitted "}) EXPECT_THAT(list, HasSubstr(name));
}

TEST_F(MethodCommands, CompareMeasuresErrorsAndCost) {
    const Outcome compare = run({"compare", "baseline", "rk4@50ns", "dumka3-p5@2us", "dopri54@100ns~1", "--duration", "12us"});
    EXPECT_EQ(compare.status, 0) << compare.err;
    EXPECT_THAT(compare.out, AllOf(HasSubstr("\n  rk4@50ns "), HasSubstr("\n  dumka3-p5@2us "), HasSubstr("\n  dopri54@100ns~1 ")));
    EXPECT_EQ(run({"compare", "baseline", "dumka3"}).err,
              "cvtflow-lab: dumka3: write METHOD@STEP, METHOD@auto, or METHOD@LONGEST~TOLERANCE for steps by error\n");
    EXPECT_EQ(run({"compare", "baseline", "rk4@2m"}).err, "cvtflow-lab: rk4@2m: '2m' is not a time above 0, such as 40ns\n");
}

TEST_F(MethodCommands, ToleranceMakesTheErrorDecide) {
    const Outcome outcome = run(
        {"run", "baseline", "-o", "none", "--method", "dumka3", "--step", "5us", "--tolerance", "1", "--until", "0.1ms", "--threads", "1"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out,
                AllOf(HasSubstr("local error         largest "), HasSubstr("tolerance 1.00e+00"), HasSubstr("steps rejected")));
}

}  // namespace
}  // namespace cvtflow::bench
