/// The commands about methods: method, compare, spectrum, stability.

#include <gmock/gmock.h>

#include <cmath>
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

class StabilityCommands : public Program {};

TEST_F(StabilityCommands, SpectrumReportsExtentBandsAndTheLongestStep) {
    const Outcome outcome = run(std::vector<std::string>{"spectrum", "tiny", "--extremal", "-q", "-o", "s"} + brief_settling);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, StartsWith("tiny: eigenvalues of the Jacobian at t = 0 s, piecewise friction, "));
    EXPECT_THAT(outcome.out, testing::ContainsRegex("\n  fastest decay       max -Re = [0-9.]+e\\+06 1/s\n"));
    EXPECT_THAT(outcome.out, testing::ContainsRegex("\n  largest stable step [0-9.]+ ns predicted \\(by .* 1/s\\), [0-9.]+ ns measured"));
    EXPECT_THAT(outcome.out, HasSubstr("\n  growth              not checked: extreme eigenvalues only\n"));
    const auto json = nlohmann::json::parse(read("s/spectrum.json"));
    EXPECT_EQ(json["unknowns"], 1032);
    EXPECT_NEAR(double(json["extent"]["max_oscillation"]), 9.95e5, 3e3) << "158 kHz, of pin halves of order 3";
    EXPECT_EQ(json["eigenvalues"].size(), std::size_t(json["extent"]["below_1e6"]) + 2);  // and the pair that oscillates fastest
    EXPECT_NEAR(double(json["stable_step"]["measured"]) / double(json["stable_step"]["predicted"]), 1.0, 0.15);  // barely settled, it moves
    EXPECT_THAT(read("s/spectrum.csv"), StartsWith("real,imaginary,share_joints,share_plates,share_tips\n-"));
    EXPECT_FALSE(exists("s/spectrum-linear.svg")) << "a line and two points in an empty plane";
    EXPECT_THAT(read("s/spectrum-edge.svg"),
                AllOf(HasSubstr(">-Re λ [1/s]</text>"), HasSubstr("; the extreme "), HasSubstr("; fastest oscillation 9.9")));
}

TEST_F(StabilityCommands, SpectrumOfAllEigenvaluesIsDrawnInThePlane) {
    const Outcome outcome =
        run(std::vector<std::string>{"spectrum", "tiny", "--detail", "rigid", "-q", "-o", "s", "--svg"} + brief_settling);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(exists("s/spectrum-linear.svg"));
    EXPECT_THAT(read("s/spectrum-symlog.svg"), HasSubstr(">Re λ [1/s]</text>"));
    EXPECT_FALSE(exists("s/spectrum-edge.svg"));
}

TEST_F(StabilityCommands, StabilityNeedsNoScene) {
    const Outcome outcome = run({"stability", "rk4", "dumka3-p2", "-q", "-o", "maps", "--svg"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, testing::ContainsRegex("\n  rk4 +4 +2\\.785 +2\\.828 "));
    EXPECT_THAT(outcome.out, HasSubstr("\n  written             maps/stability-rk4.svg, maps/stability-dumka3-p2.svg\n"));
    EXPECT_THAT(read("maps/stability-rk4.svg"), HasSubstr("<g id=\"PathCollection"));
    EXPECT_FALSE(exists("maps/stability.csv"));
}

TEST_F(StabilityCommands, StabilityOfATableOnASceneIsPredictedAndMeasured) {
    const Outcome outcome = run(std::vector<std::string>{"stability", "rk4", "--scene", "tiny", "-q", "-o", "maps"} + brief_settling);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, testing::ContainsRegex(" [0-9.]+ ns predicted \\(by .* 1/s\\), [0-9.]+ ns measured \\([-+][0-9.]+ %\\)\n"));
    EXPECT_THAT(read("maps/stability-rk4.svg"), HasSubstr(">eigenvalues of tiny times h = "));
    EXPECT_THAT(read("maps/stability.csv"), testing::ContainsRegex("\nrk4,4,2\\.785[0-9]*,2\\.828"));
    EXPECT_THAT(run({"stability", "leapfrog-sweep"}).err, HasSubstr("leapfrog-sweep is no table of stages"));
}

TEST_F(StabilityCommands, SpectrumKnowsTheLongestStepOfMethodsThatAreNoTables) {
    const Outcome outcome =
        run(std::vector<std::string>{"spectrum", "tiny", "--method", "leapfrog-sweep", "--extremal", "-q", "-o", "s", "--json"} +
            brief_settling);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, testing::ContainsRegex("\n  largest stable step [0-9.]+ us \\(damping of oscillations up to .* kHz\\)\n"));
    const auto json = nlohmann::json::parse(read("s/spectrum.json"));
    EXPECT_FALSE(json["stable_step"].contains("measured")) << "one answer";
    EXPECT_GT(double(json["stable_step"]["stated"]), 1e-6);
    EXPECT_GT(double(json["stable_step"]["rate"]), 1e5);
}

}  // namespace
}  // namespace cvtflow::bench
