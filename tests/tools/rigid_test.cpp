/// Every command on a scene of rigid pins.

#include <gmock/gmock.h>

#include <csignal>
#include <random>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class RigidPins : public Program {
protected:
    static inline const Words level{"--detail", "rigid", "--set", "run.method=leapfrog-rigid", "--set", "run.step=2 us"};
    static inline const Words brief{"--until", "2 ms", "--set", "start.settling_time=1 ms", "--set", "start.ramp_time=1 ms"};

    /// Value of a channel in the last row.
    [[nodiscard]] double last(const std::string& file, const std::string& channel) const { return record(file).channel(channel).back(); }
};

TEST_F(RigidPins, AreCheckedWithTimeAndBytes) {
    const Outcome outcome = run(Words{"check", "baseline"} + level);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("rigid (lumped plates, rigid pins, elastic pulleys)"));
    EXPECT_THAT(run({"list", "detail"}).out, HasSubstr("\nrigid "));
    EXPECT_THAT(run({"explain", "detail.pins"}).out, HasSubstr("rigid"));
    EXPECT_THAT(run({"schema"}).out, HasSubstr("\"rigid\""));
}

TEST_F(RigidPins, RunSettleAndAreReportedPlottedAndExported) {
    const Outcome outcome = run(Words{"run", "tiny", "-o", "rigid.h5"} + level + brief);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("leapfrog-rigid"), HasSubstr("energy balance"), Not(HasSubstr("unreliable"))));
    EXPECT_EQ(record("rigid.h5").status(), "finished");
    EXPECT_THAT(run({"info", "rigid.h5"}).out, HasSubstr("rigid"));
    EXPECT_EQ(run({"report", "rigid.h5"}).status, 0);
    EXPECT_EQ(run({"plot", "rigid.h5", "-o", "rigid.svg"}).status, 0);
    EXPECT_EQ(run({"export", "rigid.h5", "--vtk", "solids.pvd"}).status, 0);
    const Outcome settled = run(Words{"settle", "tiny", "-q", "-o", "state.h5", "--time", "1 ms", "--set", "start.ramp_time=1 ms"} + level);
    EXPECT_EQ(settled.status, 0) << settled.err;
    EXPECT_EQ(run(Words{"run", "tiny", "-q", "-o", "again.h5", "--set", "start.state=state.h5"} + level + brief).status, 0);
}

/// A start that settles begins with a jolt which steps of 5 us do not resolve, and which is no reason to call the run unreliable.
TEST_F(RigidPins, AreReliableAtTheAutomaticStepOfASmallMachine) {
    const Outcome outcome = run({"run", "tiny", "--detail", "rigid", "--method", "auto", "-o", "tiny.h5"});
    EXPECT_EQ(outcome.status, 0) << outcome.out;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("step 5e-06 s (auto"), Not(HasSubstr("unreliable"))));
}

TEST_F(RigidPins, ResumeBitForBitAfterKills) {
    const Words all = Words{"run", "tiny", "-q", "--until", "200 ms", "-o"};
    ASSERT_EQ(run(all + Words{"whole.h5"} + level).status, 0);
    std::mt19937 chance(3);
    for (int kill = 0; kill < test::depth(1, 4); ++kill) {
        const std::uintmax_t bytes = chance() % (std::filesystem::file_size(folder_ / "whole.h5") / 4);  // rows are too many to be read
        Child child(all + Words{"cut.h5", "--checkpoint-every", "100 ms"} + level, folder_);
        const auto is_far = [&] { return exists("cut.checkpoint.h5") && std::filesystem::file_size(folder_ / "cut.h5.part") >= bytes; };
        ASSERT_EQ(child.ended_when(is_far, SIGKILL).status, 128 + SIGKILL);
        ASSERT_EQ(run({"resume", "cut.checkpoint.h5", "-q"}).status, 0);
        EXPECT_EQ(recorded_hash(folder_ / "whole.h5"), recorded_hash(folder_ / "cut.h5"));
        EXPECT_EQ(record("whole.h5").channel("tight_tension"), record("cut.h5").channel("tight_tension"));
        std::filesystem::remove(folder_ / "cut.h5");
    }
}

TEST_F(RigidPins, SweepIntoATable) {
    write("sweep.toml",
          "[sweep]\nscene = \"tiny\"\n[set]\ndetail.pins = \"rigid\"\nrun.method = \"leapfrog-rigid\"\nrun.step = \"2 "
          "us\"\nrun.until = "
          "\"1 ms\"\nstart.settling_time = \"1 ms\"\nstart.ramp_time = \"1 ms\"\n[[axes]]\nkey = \"load.torque\"\nvalues = [\"6 N*m\", "
          "\"12 N*m\"]\n[outputs]\nscalars = [\"slip mean\", \"tight_tension max\"]\n[start]\nmode = \"settle\"\n");
    const Outcome outcome = run({"batch", "sweep.toml", "-o", "out"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(run({"table", "out"}).out, HasSubstr("finished"));
}

TEST_F(RigidPins, DriveFromAFile) {
    const Outcome outcome = run({"run", "drive", "-q", "-o", "drive.h5", "--until", "2 ms"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(record("drive.h5").status(), "finished");
    EXPECT_NEAR(last("drive.h5", "ratio"), 2.2, 0.01);  // the file's target; control settles within half a per cent
}

TEST_F(RigidPins, RefuseWhatTheyDoNotHave) {
    const auto refusal = [&](const Words& more) {
        const Outcome outcome = run(Words{"run", "tiny"} + level + more);
        EXPECT_EQ(outcome.status, 2);
        return outcome.err;
    };
    EXPECT_THAT(refusal({"--set", "run.method=leapfrog-sweep"}), HasSubstr("method 'leapfrog-sweep' requires detail.pins = \"halves\""));
    EXPECT_THAT(refusal({"--set", "detail.plates=each"}), HasSubstr("has \"lumped\" plates"));
    EXPECT_THAT(refusal({"--set", "detail.stick_slip=true"}), HasSubstr("no phases stick and slip"));
    EXPECT_THAT(refusal({"--set", "joint.law=palmgren"}), HasSubstr("joints of law \"linear\""));
    EXPECT_THAT(refusal({"--set", "run.schedule=flow"}), HasSubstr("runs on one thread"));
    EXPECT_THAT(refusal({"--set", "run.segments=2"}), HasSubstr("is one segment"));
}

/// Friction counts in the steps of tables, which a start changes faster than 20 ms: estimates as for other pins.
TEST_F(RigidPins, AreReliableAtTheAutomaticStepOfATable) {
    const Outcome outcome = run({"run", "tiny", "--detail", "rigid", "--method", "rk4", "-o", "tiny.h5"});
    EXPECT_EQ(outcome.status, 0) << outcome.out;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("(auto"), Not(HasSubstr("unreliable"))));
}

/// Any table integrates the same forces; both are within the step's error of each other.
TEST_F(RigidPins, TakeOtherMethodsAsACheck) {
    const Words at{"--set", "start.settling_time=1 ms", "--set", "start.ramp_time=1 ms", "--until", "1 ms"};
    ASSERT_EQ(run(Words{"run", "tiny", "-q", "-o", "sweep.h5"} + level + Words{"--set", "run.step=0.5 us"} + at).status, 0);
    ASSERT_EQ(
        run(Words{"run", "tiny", "-q", "-o", "rk4.h5"} + level + Words{"--set", "run.method=rk4", "--set", "run.step=0.1 us"} + at).status,
        0);
    EXPECT_NEAR(last("sweep.h5", "tight_tension"), last("rk4.h5", "tight_tension"), 0.01 * last("rk4.h5", "tight_tension"));
}

}  // namespace
}  // namespace cvtflow::tools
