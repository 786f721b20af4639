/// Rows of a folder come from one program and one start, or from several knowingly.

#include <gmock/gmock.h>

#include "engine/base/provenance.hpp"
#include "engine/record/run/state_file.hpp"
#include "tests/tools/batch_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using testing::Not;
using testing::Pair;

namespace fs = std::filesystem;

constexpr const char* other_program = "0.1.0 (deadbeef)";

class BatchOrigin : public Sweeps {
protected:
    /// A state of tiny, settled for a moment with that load.
    void settle(const std::string& file, const std::string& load) const {
        const Outcome outcome = run({"settle", "tiny", "-q", "--force", "-o", file, "--time", "20us", "--set", "start.ramp_time=10us",
                                     "--set", "load.torque=" + load});
        ASSERT_EQ(outcome.status, 0) << outcome.err;
    }
    /// Two cases from that state.
    void write_from(const std::string& state, const std::string& outputs = "", const std::string& loads = "6, 12") const {
        write("sweep.toml",
              "[sweep]\nscene = \"tiny\"\n[set]\nrun.until = \"20 us\"\nrun.step = \"50 ns\"\nstart.settling_time = \"20 us\"\n"
              "start.ramp_time = \"10 us\"\nstart.state = \"" +
                  state + "\"\n[[axes]]\nkey = \"load.torque\"\nvalues = [" + loads + "]\n[outputs]\nscalars = [\"slip mean\"]\n" +
                  outputs);
    }
    void shared() const {
        write_sweep("\"6 N*m\"", "20 us", "");
        std::string text = read("sweep.toml");
        text.replace(text.find("\"settle\""), 8, "\"shared\"");
        write("sweep.toml", text);
    }
    /// As another version of the program would have left it.
    void give_to_other_program(const std::string& folder) const {
        engine::CaseTable other = table(folder);
        other.set({"program", std::string(other_program)});
        engine::write_cases(engine::Permit((folder_ / folder / "cases.h5").string(), {.force = true}), other);
    }
    void give_state_to_other_program(const fs::path& file) const {
        engine::SavedState state = engine::read_state((folder_ / file).string());
        for (engine::Attribute& attribute : state.attributes) {
            if (attribute.name == "program") attribute.value = "cvtflow " + std::string(other_program) + ", GNU";
        }
        engine::write_state((folder_ / file).string(), state);
    }
    [[nodiscard]] std::vector<fs::path> states_in(const std::string& folder) const {
        std::vector<fs::path> files;
        for (const auto& entry : fs::directory_iterator(folder_ / folder / "states"))
            files.push_back(fs::path(folder) / "states" / entry.path().filename());
        return files;
    }
};

TEST_F(BatchOrigin, IsInEveryRow) {
    settle("a.h5", "6 N*m");
    settle("b.h5", "12 N*m");
    write_from("a.h5");
    ASSERT_EQ(batch().status, 0);
    EXPECT_THAT(column("program"), Each(Pair(testing::_, engine::version_text())));
    write_from("b.h5");
    ASSERT_EQ(run({"batch", "sweep.toml", "-o", "b"}).status, 0);
    EXPECT_EQ(column("start_state").at(0), column("start_state").at(1));
    EXPECT_NE(column("start_state").at(0), column("start_state", "b").at(0));
    EXPECT_EQ(column("start_state").at(0).size(), 16u);
}

TEST_F(BatchOrigin, AnotherContentOfTheStartStateIsRefusedAndAnotherPathIsNot) {
    settle("a.h5", "6 N*m");
    write_from("a.h5");
    ASSERT_EQ(batch().status, 0);
    const std::string before = read("out/cases.h5");
    fs::rename(folder_ / "a.h5", folder_ / "c.h5");
    write_from("c.h5");
    EXPECT_EQ(batch().status, 0);
    settle("c.h5", "12 N*m");
    const std::string kept = read("out/cases.h5");
    const Outcome refused = batch();
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.err, AllOf(HasSubstr("out/cases.h5: content of start.state "), HasSubstr("--mixed"), Not(HasSubstr("program "))));
    EXPECT_EQ(read("out/cases.h5"), kept);
    EXPECT_EQ(run({"resume", "out"}).status, 1);
    EXPECT_EQ(batch({"--mixed"}).status, 0);
}

TEST_F(BatchOrigin, OfShardsMustAgree) {
    settle("a.h5", "6 N*m");
    write_from("a.h5");
    ASSERT_EQ(run({"batch", "sweep.toml", "-o", "cut", "--shard", "1/2"}).status, 0);
    settle("a.h5", "12 N*m");
    ASSERT_EQ(run({"batch", "sweep.toml", "-o", "cut", "--shard", "2/2"}).status, 0);
    const Outcome starts = run({"merge", "cut"});
    EXPECT_EQ(starts.status, 1);
    EXPECT_THAT(starts.err, HasSubstr("cut/shard-0002-of-0002/cases.h5: content of start.state "));
    EXPECT_FALSE(exists("cut/cases.h5"));
    give_to_other_program("cut/shard-0001-of-0002");
    EXPECT_THAT(run({"merge", "cut"}).err, HasSubstr("program 0.1.0 (deadbeef) there, "));
    EXPECT_EQ(run({"merge", "cut", "--mixed"}).status, 0);
    EXPECT_EQ(table("cut").attribute("program"), other_program + std::string("; ") + engine::version_text());
}

TEST_F(BatchOrigin, OfAnotherVersionOfTheProgramIsContinuedOnlyKnowingly) {
    write_sweep();
    ASSERT_EQ(batch().status, 0);
    give_to_other_program("out");
    const std::string kept = read("out/cases.h5");
    for (const Words& command : {Words{"batch", "sweep.toml", "-o", "out"}, Words{"resume", "out"}}) {
        const Outcome refused = run(command);
        EXPECT_EQ(refused.status, 1);
        EXPECT_THAT(refused.err, HasSubstr("out/cases.h5: program 0.1.0 (deadbeef) there, " + engine::version_text() + " here; "));
    }
    EXPECT_EQ(read("out/cases.h5"), kept);
    EXPECT_EQ(run({"resume", "out", "--mixed"}).status, 0);
    EXPECT_EQ(table().attribute("program"), other_program + std::string("; ") + engine::version_text());
    EXPECT_EQ(batch().status, 1) << "it stays mixed";
}

TEST_F(BatchOrigin, RecordsThatAreAskedForLaterAreRefused) {
    settle("a.h5", "6 N*m");
    write_from("a.h5");
    ASSERT_EQ(batch().status, 0);
    write_from("a.h5", "records = true\n");
    const Outcome refused = batch();
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.err, HasSubstr("out/cases.h5: outputs.records false there, true here; "));
    EXPECT_FALSE(exists("out/records"));
}

TEST_F(BatchOrigin, OfSharedStatesIsCompared) {
    shared();
    ASSERT_EQ(batch().status, 0);
    ASSERT_EQ(states_in("out").size(), 1u);
    const fs::path state = states_in("out").front();
    fs::create_directories(folder_ / "other" / "states");
    fs::copy_file(folder_ / state, folder_ / "other" / "states" / state.filename());
    give_state_to_other_program(fs::path("other") / "states" / state.filename());
    const Outcome version = run({"batch", "sweep.toml", "-o", "other"});
    EXPECT_EQ(version.status, 1);
    EXPECT_THAT(version.err, AllOf(HasSubstr("a shared start state settled by cvtflow "), HasSubstr("deadbeef"), HasSubstr("--mixed")));
    EXPECT_EQ(run({"batch", "sweep.toml", "-o", "other", "--mixed"}).status, 0);
    settle("stranger.h5", "3 N*m");
    fs::create_directories(folder_ / "third" / "states");
    fs::copy_file(folder_ / "stranger.h5", folder_ / "third" / "states" / state.filename());
    const Outcome scene = run({"batch", "sweep.toml", "-o", "third", "--mixed"});
    EXPECT_EQ(scene.status, 1);
    EXPECT_THAT(scene.err, HasSubstr("a shared start state of another scene than its name promises"));
}

TEST_F(BatchOrigin, OfACheckpointIsCompared) {
    const Words brief{"run",
                      "tiny",
                      "-o",
                      "r.h5",
                      "--until",
                      "1 ms",
                      "--set",
                      "run.max_steps=400",
                      "--settle",
                      "--set",
                      "start.settling_time=10us",
                      "--set",
                      "start.ramp_time=5us",
                      "--checkpoint-every",
                      "1 s"};
    ASSERT_EQ(run(brief).status, 4);
    ASSERT_TRUE(exists("r.checkpoint.h5"));
    give_state_to_other_program("r.checkpoint.h5");
    const Outcome refused = run({"resume", "r.checkpoint.h5", "--set", "run.max_steps=0", "--until", "40 us"});
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.err,
                AllOf(HasSubstr("r.checkpoint.h5: written by cvtflow 0.1.0 (deadbeef), GNU, this is cvtflow "), HasSubstr("--mixed")));
    EXPECT_NE(run({"resume", "r.checkpoint.h5", "--mixed", "--set", "run.max_steps=0"}).status, 1);
}

}  // namespace
}  // namespace cvtflow::tools
