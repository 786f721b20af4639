#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

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
