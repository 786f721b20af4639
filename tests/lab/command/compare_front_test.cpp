/// cvtflow-lab compare --front: what is recommended is right over times that results are read of, too.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class CompareFront : public Program {
protected:
    /// `control` is stable to 1.91 us: at 2 us the leapfrog is exact over 240 us and wrong over 20 ms.
    /// Which of the others is recommended is a question of wall time.
    [[nodiscard]] nlohmann::json judged(const std::string& scene, const std::vector<std::string>& words) const {
        const Outcome outcome = run(std::vector<std::string>{"compare", scene, "--front", "-q", "--json", "--csv", "-o", "out"} + words);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_THAT(outcome.out, ContainsRegex("\n  leapfrog-chebyshev@2us .* beyond stability\n"));
        EXPECT_THAT(outcome.out, Not(HasSubstr("use leapfrog-chebyshev@2us")));
        EXPECT_THAT(outcome.out, HasSubstr("Recommendations were confirmed over "));
        const auto json = nlohmann::json::parse(read("out/compare_" + scene + ".json"));
        EXPECT_FALSE(json["recommended"][0]["method"].is_null()) << "a hundredth is met";
        for (const auto& best : json["recommended"]) {
            if (!best["method"].is_null()) expect_confirmed(row(json, best["method"]));
        }
        for (const auto& choice : json["choices"])
            EXPECT_TRUE(choice["front"] == false || choice["standing"] == "confirmed") << choice["method"];
        return json;
    }
    static const nlohmann::json& row(const nlohmann::json& json, const std::string& method) {
        for (const auto& choice : json["choices"]) {
            if (choice["method"] == method) return choice;
        }
        throw std::out_of_range(method);
    }
    static void expect_confirmed(const nlohmann::json& choice) {
        EXPECT_EQ(choice["standing"], "confirmed") << choice["method"];
        EXPECT_LE(double(choice["long_slip_off"]), 0.01) << choice["method"];
        EXPECT_LE(double(choice["long_losses_off"]), 0.01) << choice["method"];
        EXPECT_EQ(choice["long_status"], "finished") << choice["method"];
        EXPECT_EQ(choice["long_long_enough"], true) << choice["method"];
    }
};
class NightlyCompareFront : public CompareFront {};

const std::vector<std::string> few{
    "leapfrog-chebyshev@auto", "leapfrog-chebyshev@2us", "leapfrog-chebyshev@1us", "--reference", "rk4@25ns", "--rounds", "1"};

TEST_F(CompareFront, NeverRecommendsAStepBeyondStabilityHoweverExactItIsOverAShortTime) {
    const auto json = judged("control", few);
    const auto& beyond = row(json, "leapfrog-chebyshev@2us");
    EXPECT_LT(double(beyond["error_axial_force"]), 1e-3) << "that is what misled it";
    EXPECT_LT(double(beyond["stable_step"]), 2e-6);
    EXPECT_EQ(beyond["front"], false);
    EXPECT_EQ(beyond["standing"], "beyond stability");
    EXPECT_THAT(read("out/compare_control.csv"), HasSubstr("\nleapfrog-chebyshev@2us,"));
    EXPECT_THAT(read("out/compare_control.csv"), ContainsRegex("\nleapfrog-chebyshev@2us,.*,beyond stability\n"));
}

TEST_F(CompareFront, LeavesOutWhatTheWatchRejects) {
    // dopri54 controls the error of its steps and not stability, so a loose tolerance is not detected beforehand.
    const Outcome outcome = run({"compare", "control", "--front", "leapfrog-chebyshev@auto", "dopri54@auto~1", "-q", "--reference",
                                 "rk4@25ns", "--rounds", "1", "--confirm", "2ms"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, ContainsRegex("\n  dopri54@auto~1 .* unreliable\n"));
    EXPECT_THAT(outcome.out, Not(HasSubstr("use dopri54")));
    EXPECT_THAT(
        outcome.out,
        ContainsRegex("\nConfirmed over too short a time: 2 ms are 2\\.[0-9] pin periods: means of slip and efficiency require 16 "));
}

TEST_F(CompareFront, NamesAReferenceThatIsWrongItself) {
    const std::vector<std::string> brief{"compare", "control",   "--front", "leapfrog-chebyshev@auto", "-q", "--rounds",
                                         "1",       "--confirm", "1ms"};
    const Outcome coarse = run(brief + std::vector<std::string>{"--reference", "rk4@200ns"});
    EXPECT_EQ(coarse.status, 1);
    EXPECT_THAT(coarse.err, testing::StartsWith("cvtflow-lab: control: the reference rk4@200ns is unreliable: "));
    const Outcome confirmed = run(brief + std::vector<std::string>{"--reference", "rk4@25ns", "--confirm-against", "rk4@200ns"});
    EXPECT_EQ(confirmed.status, 1);
    EXPECT_THAT(confirmed.err,
                HasSubstr("cvtflow-lab: control: the reference of the confirmation is unreliable: its energy balance does not close\n"));
    EXPECT_EQ(run({"compare", "control", "--front", "--confirm", "0 s"}).err,
              "cvtflow-lab: --confirm: '0 s' is not a time above 0, such as 40ns\n");
}

TEST_F(CompareFront, RefusesAConfirmationWithoutAFront) {
    for (const auto& words : {std::vector<std::string>{"--confirm", "1ms"}, {"--confirm-against", "rk4@50ns"}}) {
        const Outcome outcome = run(std::vector<std::string>{"compare", "control"} + words);
        EXPECT_NE(outcome.status, 0);
        EXPECT_THAT(outcome.err, HasSubstr(words.front() + " requires --front"));
    }
}

TEST_F(NightlyCompareFront, RecommendsNothingWrongOfAllItsChoices) {
    for (const std::string scene : {"control", "shift"}) EXPECT_EQ(row(judged(scene, {}), "leapfrog-chebyshev@2us")["front"], false);
}

}  // namespace
}  // namespace cvtflow::bench
