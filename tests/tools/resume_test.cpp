#include <gmock/gmock.h>

#include <csignal>
#include <cstring>
#include <random>

#include "engine/record/hdf5/file_seal.hpp"
#include "tasks/run/checkpoint.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class Resume : public Program {
protected:
    /// Everything that a record holds but when and how long it ran.
    void expect_same(const std::string& left, const std::string& right) const {
        const engine::RunReader a = record(left), b = record(right);
        ASSERT_EQ(a.rows(), b.rows());
        EXPECT_EQ(a.times(), b.times());
        for (const engine::ChannelInfo& channel : a.channels()) {  // bits: some have no number where no energy flows
            const std::vector<double> numbers = a.channel(channel.name), others = b.channel(channel.name);
            ASSERT_EQ(numbers.size(), others.size());
            EXPECT_EQ(std::memcmp(numbers.data(), others.data(), numbers.size() * sizeof(double)), 0) << channel.name;
        }
        EXPECT_EQ(a.state_times(), b.state_times());
        EXPECT_EQ(a.state(a.state_times().size() - 1), b.state(b.state_times().size() - 1));
        EXPECT_EQ(a.table("transitions"), b.table("transitions"));
        EXPECT_EQ(recorded_hash(folder_ / left), recorded_hash(folder_ / right));
        EXPECT_EQ(b.status(), "finished");
    }
    /// Kills a run at numbers of rows that are drawn, the first time before there is any, resumes it, and compares with an undisturbed one.
    /// @return how often there was a checkpoint
    [[nodiscard]] int killed_and_resumed(int kills) const;
};

/// A checkpoint in the middle of a mean keeps its sums.
TEST_F(Resume, ContinuesMeansOfOutputsBitForBit) {
    const Words scene{"tiny",    "-q",
                      "--set",   "run.method=auto",
                      "--until", "2 ms",
                      "--set",   "run.output_interval=0.5 ms",
                      "--set",   "run.state_interval=1 ms",
                      "--set",   "record.means=true"};
    ASSERT_EQ(run(Words{"run"} + scene + Words{"-o", "whole.h5"}).status, 0);
    const Outcome cut = run(Words{"run"} + scene + Words{"-o", "cut.h5", "--checkpoint-every", "1 h", "--set", "run.max_steps=1000"});
    ASSERT_EQ(cut.status, 4) << cut.err;
    ASSERT_EQ(run({"resume", "cut.checkpoint.h5", "-q", "--set", "run.max_steps=0"}).status, 0);
    expect_same("whole.h5", "cut.h5");
}

/// The cut is before or after the sheave is held.
TEST_F(Resume, ContinuesARunUntilItIsSteadyBitForBit) {
    const Words scene{"control", "-q",
                      "--set",   "detail.level=rigid",
                      "--set",   "start.state=",
                      "--set",   "start.settling_time=10 ms",
                      "--set",   "drive.speed=4000 rpm",
                      "--set",   "run.steady=20 %",
                      "--set",   "control.when_steady=hold",
                      "--until", "steady"};
    ASSERT_EQ(run(Words{"run"} + scene + Words{"-o", "whole.h5"}).status, 0);
    for (const std::string steps : {"2000", "3800", "9000"}) {
        const Outcome cut =
            run(Words{"run"} + scene + Words{"-o", "cut.h5", "--checkpoint-every", "1 h", "--set", "run.max_steps=" + steps});
        ASSERT_EQ(cut.status, 4) << cut.err;
        ASSERT_EQ(run({"resume", "cut.checkpoint.h5", "-q", "--set", "run.max_steps=0"}).status, 0);
        expect_same("whole.h5", "cut.h5");
        std::filesystem::remove(folder_ / "cut.h5");
    }
}

int Resume::killed_and_resumed(int kills) const {
    EXPECT_EQ(run(run_to_be_ended("whole.h5")).status, 0);
    std::mt19937 chance(7);
    int resumed = 0;
    for (int kill = 0; kill < kills; ++kill) {
        const std::size_t rows = kill == 0 ? 0 : 1 + chance() % (rows_of("whole.h5") - 1);
        Child child(run_to_be_ended("cut.h5") + Words{"--checkpoint-every", "5 ms"}, folder_);
        (void)child.ended_when([&] { return exists("cut.h5.part") && rows_of("cut.h5.part") >= rows; }, SIGKILL);
        if (exists("cut.checkpoint.h5")) {
            const Outcome outcome = run({"resume", "cut.checkpoint.h5", "-q"});
            EXPECT_EQ(outcome.status, 0) << outcome.err;
            ++resumed;
        } else if (!exists("cut.h5")) {
            EXPECT_EQ(run(run_to_be_ended("cut.h5") + Words{"--force"}).status, 0);  // killed before there was a checkpoint or record
        }
        expect_same("whole.h5", "cut.h5");
        EXPECT_FALSE(exists("cut.checkpoint.h5"));
        EXPECT_FALSE(exists("cut.h5.before"));
        std::filesystem::remove(folder_ / "cut.h5");
    }
    return resumed;
}

TEST_F(Resume, AfterKillsGivesTheUndisturbedRecord) { EXPECT_GE(killed_and_resumed(test::depth(3, 20)), test::depth(1, 5)); }

using NightlyResume = Resume;

TEST_F(NightlyResume, AfterAHundredKillsGivesTheUndisturbedRecord) { EXPECT_GE(killed_and_resumed(100), 25); }

TEST_F(Resume, AfterCtrlCContinuesWithTheRecord) {
    ASSERT_EQ(run(run_to_be_ended("whole.h5") + Words{"--until", "0.6 ms"}).status, 0);
    Child child(run_to_be_ended("cut.h5") + Words{"--until", "0.6 ms", "--checkpoint-every", "5 ms"}, folder_);
    ASSERT_EQ(child.ended_when([&] { return rows_of("cut.h5.part") > 0; }, SIGINT).status, 130);
    ASSERT_TRUE(exists("cut.checkpoint.h5"));
    EXPECT_GT(rows_of("cut.h5"), 0u);
    ASSERT_EQ(run({"resume", "cut.checkpoint.h5", "tiny", "-q", "--set", "start.settling_time=100us"}).status, 1);
    ASSERT_EQ(run({"resume", "cut.checkpoint.h5", "-q"}).status, 0);
    expect_same("whole.h5", "cut.h5");
}

TEST_F(Resume, RefusesAnotherSceneAndNamesTheDifference) {
    ASSERT_EQ(run(run_to_be_ended("cut.h5") + Words{"--checkpoint-every", "1 h", "--set", "run.max_steps=500"}).status, 4);
    ASSERT_TRUE(exists("cut.checkpoint.h5"));
    const std::string before = read("cut.checkpoint.h5");
    const Outcome outcome = run({"resume", "cut.checkpoint.h5", "--set", "tip.radius=2 m", "--set", "run.method=dumka3-p4"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr("cut.checkpoint.h5: not a checkpoint of this scene:\n  tip.radius = 2, the checkpoint has "));
    EXPECT_THAT(outcome.err, HasSubstr("\n  run.method = \"dumka3-p4\", the checkpoint has \"rk4\"\n"));
    EXPECT_EQ(read("cut.checkpoint.h5"), before);
    EXPECT_EQ(run({"resume", "cut.checkpoint.h5", "-q", "--set", "run.max_steps=0"}).status, 0);
    ASSERT_EQ(run(run_to_be_ended("whole.h5")).status, 0);
    expect_same("whole.h5", "cut.h5");
}

TEST_F(Resume, RefusesACheckpointOfWhichAnyByteHasChanged) {
    ASSERT_EQ(run(run_to_be_ended("cut.h5") + Words{"--checkpoint-every", "1 h", "--set", "run.max_steps=500"}).status, 4);
    const std::string good = read("cut.checkpoint.h5");
    const std::size_t count = test::depth(5, 40);
    for (std::size_t k = 0; k < count; ++k) {
        std::string bad = good;
        const std::size_t at = k * (good.size() - 1) / (count - 1);  // from the first to the last
        bad[at] = static_cast<char>(bad[at] ^ 4);
        write("bad.h5", bad);
        const Outcome outcome = run({"resume", "bad.h5", "-q", "-o", "none"});
        EXPECT_EQ(outcome.status, 1) << at;
        EXPECT_THAT(outcome.err, StartsWith("cvtflow: bad.h5: ")) << at;
    }
    ASSERT_EQ(run({"resume", "cut.checkpoint.h5", "-q", "--set", "run.max_steps=0"}).status, 0);
}

TEST_F(Resume, RefusesARecordWhoseRowsHaveChanged) {
    Child child(run_to_be_ended("cut.h5") + Words{"--until", "1 ms", "--checkpoint-every", "5 ms"}, folder_);
    // Leaves checkpoint and record at the same place.
    ASSERT_EQ(child.ended_when([&] { return exists("cut.checkpoint.h5") && rows_of("cut.h5.part") > 5; }, SIGINT).status, 130);
    const std::string left = exists("cut.h5.part") ? "cut.h5.part" : "cut.h5";
    const double time = record(left).times().back();
    std::string bytes = read(left);
    bytes.resize(bytes.size() - engine::seal_size);  // as if it had been killed
    const auto at = bytes.find(std::string_view(reinterpret_cast<const char*>(&time), sizeof time));
    ASSERT_NE(at, std::string::npos);
    bytes[at] = static_cast<char>(bytes[at] ^ 1);
    std::filesystem::remove(folder_ / left);
    write(left, bytes);
    const Outcome outcome = run({"resume", "cut.checkpoint.h5", "-q"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err,
                HasSubstr("cut.h5.before: cannot be continued: damaged: its rows differ from those written before the checkpoint"));
    EXPECT_EQ(read("cut.h5.before"), bytes);  // nothing is lost
}

TEST_F(Resume, LeavesNoHalfWrittenCheckpointBehind) {
    ASSERT_EQ(run({"settle", "tiny", "-q", "-o", "state.h5", "--time", "20us", "--set", "start.ramp_time=10us"}).status, 0);
    write("cut.checkpoint.h5.part", read("state.h5").substr(0, 4000));  // what a kill left
    ASSERT_EQ(run(run_to_be_ended("cut.h5") + Words{"--checkpoint-every", "1 h"}).status, 0);
    EXPECT_FALSE(exists("cut.checkpoint.h5.part"));
}

TEST_F(Resume, ReportsWhatIsWrongWithTheFile) {
    EXPECT_EQ(run({"resume", "nothing.h5"}).err, "cvtflow: nothing.h5: No such file or directory\n");
    ASSERT_EQ(run({"settle", "tiny", "-q", "-o", "state.h5", "--time", "20us", "--set", "start.ramp_time=10us"}).status, 0);
    EXPECT_EQ(run({"resume", "state.h5"}).err, "cvtflow: state.h5: a state file, not a checkpoint: it has no integration_scalars\n");
    std::filesystem::create_directory(folder_ / "empty");
    EXPECT_EQ(run({"resume", "empty"}).err, "cvtflow: empty: contains no sweep\n");
}

/// A checkpoint of a run that stopped while it settled (its record has no row yet), sent by another user: its name and the record that it
/// names are the sender's.
class ForeignCheckpoint : public Resume {
protected:
    ForeignCheckpoint() {
        std::filesystem::create_directory(folder_ / "theirs");
        const Words settling{"--checkpoint-every", "1 h", "--set", "run.max_steps=500"};
        EXPECT_EQ(run(run_to_be_ended("theirs/sent.h5") + settling).status, 4);
        std::filesystem::rename(folder_ / "theirs/sent.checkpoint.h5", folder_ / "mine.checkpoint.h5");
    }
    /// Puts a path into the checkpoint, as its writer could have.
    void name_record(const std::string& path) const {
        const std::string file = (folder_ / "mine.checkpoint.h5").string();
        tasks::Checkpoint checkpoint = tasks::read_checkpoint(file);
        checkpoint.record = path;
        tasks::write_checkpoint(file, checkpoint);
    }
};

TEST_F(ForeignCheckpoint, DecidesAboutNoFile) {
    write("notes.txt", "mine");
    for (const char* named : {"notes.txt", "theirs/sent.h5", ".bash_profile", "mine.h5/../notes.txt"}) {
        name_record((folder_ / named).string());
        const std::size_t files = std::distance(std::filesystem::directory_iterator(folder_), {});
        const Outcome outcome = run({"resume", "mine.checkpoint.h5", "-q"});
        EXPECT_EQ(outcome.status, 1) << named;
        EXPECT_THAT(outcome.err, HasSubstr("which is not NAME.h5 beside the checkpoint; -o FILE names the record to continue")) << named;
        EXPECT_EQ(read("notes.txt"), "mine") << named;
        EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), files) << named;
    }
}

TEST_F(ForeignCheckpoint, ReplacesNoFileBesideItWithoutForce) {
    name_record((folder_ / "mine.h5").string());
    for (const char* there : {"mine.h5", "mine.h5.part", "mine.h5.before"}) {
        write(there, "mine");
        const Outcome outcome = run({"resume", "mine.checkpoint.h5", "-q"});
        EXPECT_EQ(outcome.status, 1) << there;
        EXPECT_THAT(outcome.err, StartsWith(std::string("cvtflow: ") + there + ": ")) << there;
        EXPECT_EQ(read(there), "mine");
        std::filesystem::remove(folder_ / there);
    }
    EXPECT_EQ(run({"resume", "mine.checkpoint.h5", "-q", "--set", "run.max_steps=0"}).status, 0);  // nothing is in its way
    EXPECT_EQ(record("mine.h5").status(), "finished");
}

TEST_F(ForeignCheckpoint, ReplacesTheFinishedRecordOfAnotherRunOnlyWithForce) {
    ASSERT_EQ(run(run_to_be_ended("other.h5")).status, 0);
    const std::string other = read("other.h5");
    const Words resume{"resume", "mine.checkpoint.h5", "-q", "-o", "other.h5", "--set", "run.max_steps=0"};
    const Outcome outcome = run(resume);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.err, "cvtflow: other.h5: cannot be continued: not the record of this run; --force replaces it\n");
    EXPECT_TRUE(read("other.h5") == other);
    EXPECT_EQ(run(resume + Words{"--force"}).status, 0);
    EXPECT_FALSE(read("other.h5") == other);
}

TEST_F(Resume, ContinuesWithARunThatWasToReplaceAnother) {
    ASSERT_EQ(run(run_to_be_ended("whole.h5")).status, 0);
    ASSERT_EQ(run(run_to_be_ended("cut.h5") + Words{"--until", "20 us"}).status, 0);
    ASSERT_EQ(run(run_to_be_ended("cut.h5") + Words{"--force", "--checkpoint-every", "1 h", "--set", "run.max_steps=500"}).status, 4);
    const Outcome outcome = run({"resume", "cut.checkpoint.h5", "--set", "run.max_steps=0"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    expect_same("whole.h5", "cut.h5");
}

}  // namespace
}  // namespace cvtflow::tools
