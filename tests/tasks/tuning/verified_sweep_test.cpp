#include "tasks/tuning/verified_sweep.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "tasks/batch/batch.hpp"
#include "tasks/batch/results/results.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tests/tasks/tiny_fixture.hpp"
#include "tests/temporary_file_fixture.hpp"

namespace cvtflow::tasks {
namespace {

class VerifiedSweeps : public testing::Test {
protected:
    /// Four cases of tiny.
    [[nodiscard]] Sweep sweep(const std::string& accuracy,
                              const std::string& axis = "key = \"load.torque\"\nvalues = [6, 8, 10, 12]") const {
        const std::string file = (folder_ / "sweep.toml").string();
        std::ofstream(file) << "[sweep]\nscene = \"tiny\"\n[set]\nrun.until = \"1 ms\"\nrun.method = \"leapfrog-sweep\"\n"
                               "start.settling_time = \"2 ms\"\nstart.ramp_time = \"1 ms\"\n[[axes]]\n"
                            << axis << "\n[outputs]\nfrom = \"0.4 ms\"\nscalars = [\"tight_tension mean\", \"slack_tension mean\"]\n"
                            << "[start]\nmode = \"settle\"\n"
                            << accuracy;
        return read_sweep(file, find_scene);
    }
    [[nodiscard]] BatchReport run(const Sweep& of) const {
        BatchOptions options;
        options.folder = out();
        options.threads = 1;
        return run_batch(of, options);
    }
    [[nodiscard]] std::string out() const { return (folder_ / "out").string(); }
    const engine::Cancellation not_cancelled_{};
    const tests::TemporaryFolder folder_{"verified"};
};

constexpr const char* three = "[accuracy]\ntarget = \"20 %\"\nverify = 3\n";

TEST_F(VerifiedSweeps, CarryTheErrorsOfTheCasesThatWereRunAgain) {
    const Sweep asked = sweep(three);
    const TunedSweep tuned = tuned_sweep(asked, out(), not_cancelled_, {});
    ASSERT_TRUE(tuned.result);
    EXPECT_EQ(tuned.result->points, (std::vector<std::string>{"case 0", "case 3"})) << "the ends of the only axis";
    EXPECT_TRUE(run(tuned.sweep).finished);
    EXPECT_THAT(verify_sweep(asked, tuned, out(), not_cancelled_, {}), testing::IsEmpty());
    const SweepVerification verification = sweep_verification(out());
    EXPECT_EQ(verification.verified, 3);
    EXPECT_EQ(verification.missed, 0) << verification.text();
    EXPECT_TRUE(verification.held());
    EXPECT_THAT(verification.scalars, testing::ElementsAre("tight_tension_mean", "slack_tension_mean"));
    EXPECT_GT(verification.worst[0], 0.0) << "a tuned run is not the reference";
    const SweepRows all(out());
    EXPECT_EQ(all.facts().text("accuracy_target"), "0.2");
    EXPECT_EQ(all.facts().text("accuracy_choice"), tuned.kept.choice.text());
    EXPECT_EQ(all.facts().text("results_hash"), all.hash()) << "of the rows as they are now";
}

/// The detail of such a sweep is chosen, so that of its scene need not be that of the scene's state.
TEST_F(VerifiedSweeps, BeginWithAStateOfAnotherDetail) {
    const std::string file = (folder_ / "sweep.toml").string();
    std::ofstream(file)
        << "[sweep]\nscene = \"baseline\"\n[set]\ndetail.pulleys = \"rigid\"\nrun.until = \"0.4 ms\"\nstart.settling_time = \"5 "
           "ms\"\nstart.ramp_time = \"2 ms\"\n[[axes]]\nkey = "
           "\"load.torque\"\nvalues = [140, 150]\n[outputs]\nscalars = [\"tight_tension mean\"]\n"
           "[accuracy]\ntarget = \"20 %\"\nverify = 1\n";
    const Sweep asked = read_sweep(file, find_scene);
    const TunedSweep tuned = tuned_sweep(asked, out(), not_cancelled_, {});
    ASSERT_TRUE(tuned.result);
    EXPECT_THAT(tuned.result->left_out, testing::Each(testing::Not(testing::HasSubstr("case "))));
    EXPECT_TRUE(run(tuned.sweep).finished);
    EXPECT_THAT(verify_sweep(asked, tuned, out(), not_cancelled_, {}), testing::IsEmpty());
    EXPECT_EQ(sweep_verification(out()).missed, 0);
}

TEST_F(VerifiedSweeps, AreTunedOnceAndAloneDecideWhatIsRun) {
    const Sweep asked = sweep(three);
    const TunedSweep first = tuned_sweep(asked, out(), not_cancelled_, {}), second = tuned_sweep(asked, out(), not_cancelled_, {});
    EXPECT_FALSE(second.result) << "as kept in the folder of the results";
    EXPECT_EQ(second.sweep.definition(), first.sweep.definition());
    EXPECT_NE(sweep("").definition(), first.sweep.definition());
    const TunedSweep elsewhere = tuned_sweep(asked, (folder_ / "elsewhere").string(), not_cancelled_, {});
    EXPECT_TRUE(elsewhere.result);
    EXPECT_EQ(elsewhere.sweep.definition(), first.sweep.definition()) << "other machines find the same";
}

TEST_F(VerifiedSweeps, MissTheirTargetWhereMoreThanOneCaseInTwentyDoes) {
    SweepVerification verification{0.01, {"slip_mean"}, {0.02}, 20, 1};
    EXPECT_TRUE(verification.held());
    verification.missed = 2;
    EXPECT_FALSE(verification.held());
    EXPECT_EQ(verification.text(), "20 cases verified, 2 beyond 1 %; at most: slip_mean 2 %");
}

TEST_F(VerifiedSweeps, DetectATableThatMissesItsAccuracy) {
    Sweep asked = sweep(three);
    asked.scalars.resize(1);
    TunedSweep coarse{asked, {{"fine", "leapfrog-sweep"}, 0.0, 0.0}, std::nullopt};
    coarse.sweep.accuracy.target = 0.03;  // after 2 ms of settling, references of other steps differ by 0.35 %
    Sweep strict = asked;
    strict.accuracy.target = 0.03;
    coarse.sweep.scene = chosen_scene(asked.scene, coarse.kept.choice, 0.0);
    set_value(coarse.sweep.scene, "clamping.driven=7 kN");
    EXPECT_TRUE(run(coarse.sweep).finished);
    static_cast<void>(verify_sweep(strict, coarse, out(), not_cancelled_, {}));
    const SweepVerification verification = sweep_verification(out());
    EXPECT_EQ(verification.verified, 3);
    EXPECT_GE(verification.missed, 2) << verification.text() << ": with 1.3 kN too much";
    EXPECT_FALSE(verification.held());
}

TEST_F(VerifiedSweeps, DrawTheirCasesByASeed) {
    Sweep asked = sweep(three);
    const auto drawn = cases_to_verify(asked);
    EXPECT_EQ(drawn.size(), 3u);
    EXPECT_TRUE(std::is_sorted(drawn.begin(), drawn.end()));
    EXPECT_EQ(cases_to_verify(asked), drawn);
    asked.accuracy.verify = 100;
    EXPECT_THAT(cases_to_verify(asked), testing::ElementsAre(0, 1, 2, 3)) << "all there are";
}

TEST_F(VerifiedSweeps, RefuseWhatCannotBe) {
    const auto problem = [&](const std::string& accuracy, const std::string& axis = "key = \"load.torque\"\nvalues = [6, 8]") {
        return message_of([&] { return sweep(accuracy, axis); });
    };
    EXPECT_THAT(problem("[accuracy]\ntarget = \"1 mm\"\n"), testing::HasSubstr("target: not a share above 0 and up to 50 %"));
    EXPECT_THAT(problem("[accuracy]\nverify = 3\n"), testing::HasSubstr("accuracy.target: is missing"));
    EXPECT_THAT(problem(three, "key = \"detail.joint_points\"\nvalues = [2, 3]"),
                testing::HasSubstr("accuracy: detail.joint_points varies"));
    EXPECT_THAT(problem("", "key = \"detail.order\"\nvalues = [1, 3]"),
                testing::HasSubstr("(pin halves always have order 3: omit the key, "));
    EXPECT_THAT(problem("", "key = \"detail.level\"\nvalues = [\"medium\"]"),
                testing::HasSubstr("(use \"fine\", or \"rigid\" at lower cost)"));
    EXPECT_EQ(problem(three), "");
    EXPECT_EQ(sweep("[accuracy]\ntarget = 0.01\n").accuracy.verify, 10);
}

}  // namespace
}  // namespace cvtflow::tasks
