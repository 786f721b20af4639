/// cvtflow tune, run --accuracy and sweeps with an accuracy, as a user has them.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tasks/tuning/tuned_scene.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using TuneWords = std::vector<std::string>;

class Tune : public Sweeps {
protected:
    /// tiny, settled for a moment.
    const TuneWords tiny_{"tiny", "--set", "start.settling_time=1ms", "--set", "start.ramp_time=0.5ms", "--set", "run.until=1ms"};
    /// Tensions: a slip over 1 ms differs by 6 % from step to step, however short they are.
    const TuneWords brief_{"--accuracy", "20 %", "--outputs", "tight_tension, slack_tension", "--settling", "1 ms", "--average", "1 ms"};
    const std::vector<std::string> cache_{"XDG_CACHE_HOME=" + folder_.string()};
};

TEST_F(Tune, WritesASceneThatRunsWithWhatItChose) {
    const Outcome outcome = run(TuneWords{"tune"} + tiny_ + brief_ + TuneWords{"--verify", "1", "-o", "out", "-q"});
    ASSERT_EQ(outcome.status, 0) << outcome.err << outcome.out;
    EXPECT_THAT(outcome.out,
                AllOf(HasSubstr("tiny: accuracy 20 %, at 1 operating point\n"), ContainsRegex("\n  chosen  .* errors times 2 within"),
                      ContainsRegex("\n  one more digit  .* within 2 %")));
    EXPECT_THAT(read("tiny.tuned.toml"),
                AllOf(HasSubstr("# tiny for an accuracy of 20 %: "), HasSubstr("#   start: full, leapfrog-sweep at ")));
    EXPECT_THAT(read("tiny.tuned.svg"), HasSubstr("<svg"));
    const auto json = nlohmann::json::parse(read("out/tune_tiny.json"));
    const auto& chosen = json["choices"][std::size_t(json["chosen"])];
    EXPECT_EQ(chosen["standing"], "chosen");
    EXPECT_EQ(json["unseen"].size(), 1u);
    EXPECT_THAT(read("out/tune_tiny.csv"), HasSubstr("\"error tight_tension\",\"error slack_tension\""));
    const Outcome ran = run({"run", "tiny.tuned.toml", "-o", "none"});
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_THAT(ran.out, HasSubstr(std::string(chosen["method"])));
    EXPECT_THAT(ran.out, Not(HasSubstr("settled"))) << "it begins with a state of its own detail";
}

TEST_F(Tune, EndsWithItsOwnStatusWhereItsBudgetIsUsedUp) {
    const Outcome outcome = run(TuneWords{"tune"} + tiny_ + brief_ + TuneWords{"--budget", "1 us", "-q", "-o", "out"});
    EXPECT_EQ(outcome.status, 4) << outcome.err;
    EXPECT_THAT(outcome.out,
                HasSubstr("chosen              none: nothing was tried: the budget ended during: costs of levels of detail\n"));
    EXPECT_TRUE(nlohmann::json::parse(read("out/tune_tiny.json"))["budget_used_up_by"] == "costs of levels of detail");
    EXPECT_FALSE(exists("tiny.tuned.toml"));
    EXPECT_EQ(outcome.err, "cvtflow: no picture: tiny: no choice has an error\n") << "and no error of the search";
    const Outcome ran = run(TuneWords{"run"} + tiny_ + brief_ + TuneWords{"--budget", "1 us", "-q", "-o", "none", "--cache", "kept"});
    EXPECT_EQ(ran.status, 4);
    EXPECT_EQ(ran.err, "cvtflow: tiny: nothing was tried: the budget ended during: costs of levels of detail\n");
    const Outcome strict = run(TuneWords{"tune"} + tiny_ +
                               TuneWords{"--accuracy", "0.0001 %", "--outputs", "tight_tension", "--settling", "1 ms", "--average", "1 ms",
                                         "--methods", "leapfrog-sweep", "-q"});
    EXPECT_NE(strict.status, 4) << "it had all the time";
    EXPECT_NE(strict.status, 0) << strict.out;
}

TEST_F(Tune, ReportsWhatIsWrongWithItsArguments) {
    EXPECT_THAT(run({"tune", "tiny"}).err, HasSubstr("--accuracy is required"));
    const Outcome share = run({"tune", "tiny", "--accuracy", "80 %"});
    EXPECT_EQ(share.status, 2);
    EXPECT_EQ(share.err, "cvtflow: --accuracy 80 %: expected a share above 0 and up to 50 %, such as \"1 %\"\n");
    const Outcome output = run({"tune", "tiny", "--accuracy", "1 %", "--outputs", "slipp", "-q"});
    EXPECT_EQ(output.status, 1);
    EXPECT_THAT(output.err, HasSubstr("outputs: slipp is not one of slip, "));
    EXPECT_EQ(run({"run", "tiny", "--accuracy", "1 %", "--method", "rk4"}).status, 2) << "the method is what is found";
    EXPECT_EQ(run({"run", "tiny", "--budget", "1 s"}).status, 2) << "of what?";
}

TEST_F(Tune, RunFindsWhatItNeedsOnceAndBeginsAtOnceTheSecondTime) {
    const TuneWords words = TuneWords{"run"} + tiny_ + brief_ + TuneWords{"-o", "none"};
    const Outcome first = run(words, cache_), second = run(words, cache_);
    ASSERT_EQ(first.status, 0) << first.err;
    EXPECT_THAT(first.err, ContainsRegex("cvtflow: tiny: .* for 20 % \\(largest error measured: .* %\\), found in "));
    EXPECT_THAT(second.err, HasSubstr(", from the cache"));
    EXPECT_THAT(second.err, Not(HasSubstr("reference at start")));
    const auto hash = [](const Outcome& outcome) { return outcome.out.substr(outcome.out.find("state hash"), 36); };
    EXPECT_EQ(hash(second), hash(first));
    if (!test::is_deep()) return;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "cvtflow"))
        std::filesystem::resize_file(entry.path(), std::filesystem::file_size(entry.path()) / 2);
    const Outcome third = run(words, cache_);
    EXPECT_EQ(third.status, 0) << third.err;
    EXPECT_THAT(third.err, HasSubstr("found in ")) << "what is damaged is made anew";
}

TEST_F(Tune, SweepsWithAnAccuracyCarryTheirErrorsAndSayWhereTheyMissIt) {
    write("sweep.toml",
          "[sweep]\nscene = \"tiny\"\n[set]\nrun.until = \"1 ms\"\nrun.method = \"leapfrog-chebyshev\"\nstart.settling_time = \"2 ms\"\n"
          "start.ramp_time = \"1 ms\"\n[[axes]]\nkey = \"load.torque\"\nvalues = [6, 9, 12]\n[outputs]\nfrom = \"0.4 ms\"\n"
          "scalars = [\"tight_tension mean\"]\n[start]\nmode = \"settle\"\n[accuracy]\ntarget = \"3 %\"\nverify = 2\n");
    const Outcome outcome = batch();
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.err, ContainsRegex("cvtflow: sweep: 2 cases verified, 0 beyond 3 %; at most: tight_tension_mean "));
    EXPECT_EQ(hash_in(outcome.out), table().attribute("results_hash"));
    EXPECT_THAT(run({"table", "out"}).out,
                HasSubstr("\naccuracy 3e-2: " + table().attribute("accuracy_choice") + " (largest error at the corners "));
    const Outcome again = run({"resume", "out"});
    EXPECT_EQ(again.status, 0) << again.err;
    EXPECT_THAT(again.err, HasSubstr(", from the cache"));
    EXPECT_EQ(hash_in(again.out), hash_in(outcome.out));
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "out")) {  // as if the corners had misled it
        if (entry.path().extension() == ".tuning")
            tasks::keep_tuning(folder_ / "out", entry.path().stem().string(), {{"", "leapfrog-chebyshev"}, 0.0, 0.001});
    }
    std::filesystem::remove(folder_ / "out" / "cases.h5");
    const Outcome missed = batch({"-q"});
    EXPECT_EQ(missed.status, 7) << missed.err;
    EXPECT_THAT(missed.err, HasSubstr("cvtflow: sweep: misses its target: 2 cases verified, 2 beyond 3 %; at most: "));
}

}  // namespace
}  // namespace cvtflow::tools
