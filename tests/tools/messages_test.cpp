/// Answers of the program to a command that is nearly right, and its warnings.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tasks/run/run_means.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class Messages : public Program {
protected:
    /// Stderr of a command that must end with that status.
    [[nodiscard]] std::string of(const Words& words, int status) const {
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, status) << outcome.err;
        return outcome.err;
    }
};

TEST_F(Messages, BlameTheSettingThatMakesAStateUselessAndNoneThatWasNotGiven) {
    const std::string error = of({"run", "baseline", "--set", "chain.pins=3"}, 2);
    EXPECT_THAT(error, StartsWith("cvtflow: chain.pins = 3 (was 84): chain.pins: 3 pins make a chain of "));
    EXPECT_THAT(error, Not(HasSubstr("start.state")));
}

TEST_F(Messages, KnowTheWordsOfTheField) {
    for (const auto& [key, meant] : {std::pair{"pulley.sheave_angle", "tip.angle"},
                                     {"tip.mu", "tip.friction_coefficient"},
                                     {"pulley.center_distance", "pulley.centre_distance"},
                                     {"run.duration", "run.until"},
                                     {"load.output_torque", "load.torque"}}) {
        EXPECT_THAT(of({"check", "tiny", "--set", std::string(key) + "=1"}, 2),
                    HasSubstr(std::string("unknown key (did you mean \"") + meant + "\"?)"))
            << key;
    }
    write("sweep.toml",
          "[sweep]\nscene = \"tiny\"\n[[axes]]\nkey = \"load.torque\"\nfrom = 1\nto = 2\nstep = 1\n[outputs]\nscalars = [\"slip mean\"]\n");
    EXPECT_THAT(of({"batch", "sweep.toml", "--dry-run"}, 1), HasSubstr("axes.step: unknown key (did you mean \"count\"?)"));
}

TEST_F(Messages, ShowHowASettingIsWrittenInOneWord) {
    EXPECT_THAT(of({"run", "tiny", "--set", "load.torque", "120 Nm"}, 2), HasSubstr("did you mean '--set load.torque=\"120 Nm\"'?"));
}

TEST_F(Messages, NameTheCommandForASceneOrASweep) {
    EXPECT_THAT(of({"baseline"}, 2), HasSubstr("no command 'baseline', did you mean 'cvtflow run baseline'?"));
    EXPECT_THAT(of({"operating_map"}, 2), HasSubstr("did you mean 'cvtflow batch operating_map'?"));
}

TEST_F(Messages, NameTheReadySweeps) {
    EXPECT_THAT(run({"list", "sweeps"}).out, AllOf(HasSubstr("\noperating_map"), HasSubstr("\nslip_efficiency")));
    EXPECT_THAT(of({"batch", "baseline"}, 1), HasSubstr("no sweep 'baseline'; ready sweeps: operating_map, slip_efficiency"));
}

/// Every note that a record or a sweep can have.
TEST_F(Messages, NameTheNotes) {
    const std::string notes = run({"list", "notes"}).out;
    for (const tasks::NoteKind& kind : tasks::note_kinds())
        EXPECT_THAT(notes, ContainsRegex(fmt::format("\n{} +[a-z]", kind.name))) << kind.meaning;
}

TEST_F(Messages, NameTheRecordsInAFolderWithoutASweep) {
    std::filesystem::create_directory(folder_ / "results");
    ASSERT_EQ(run_briefly({"-q", "-o", "results/a.h5"}).status, 0);
    for (const Words& command : {Words{"report"}, {"plot", "--x", "case", "--y", "wall"}, {"table"}, {"info"}})
        EXPECT_THAT(of(command + Words{"results"}, 1), HasSubstr("results: a folder without the table of a sweep (cases.h5); it contains "
                                                                 "results/a.h5: name one of these files"))
            << command.front();
}

TEST_F(Messages, StateWhatABareNumberOfALongRunMeans) {
    const Words brief{"check", "tiny", "--set", "start.settling_time=20us", "--set", "start.ramp_time=10us", "--until"};
    EXPECT_THAT(run(brief + Words{"10"}).err, HasSubstr("--until 10: a number without a unit is in seconds; \"10 ms\" are"));
    EXPECT_EQ(run(brief + Words{"10 s"}).err, "") << "it has a unit";
    EXPECT_EQ(run(brief + Words{"0.001"}).err, "") << "it is short";
}

TEST_F(Messages, OfACheckStateWhyTheFirstStepsFail) {
    const Outcome outcome = run({"check", "baseline", "--set", "chain.pins=100"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, ContainsRegex("baseline: the run fails in its first steps: pin .* runs on a radius of .*, off the sheave"));
    EXPECT_THAT(outcome.out, HasSubstr("not measured: it fails in its first steps: pin "));
    EXPECT_EQ(run({"check", "baseline"}).status, 0);
}

/// 2 mu S_2 r_2/cos(beta) = 2 0.09 20 kN 54.4 mm/cos(11 deg) = 199.7 N m.
TEST_F(Messages, OfACheckWarnOfALoadBeyondTheTorqueLimit) {
    const Outcome light = run({"check", "baseline"}), heavy = run({"check", "baseline", "--set", "load.torque=900"});
    EXPECT_THAT(light.out, AllOf(HasSubstr("682.08 mm, 84 pins"), HasSubstr("54.44 mm driving, 54.44 mm driven; arcs 180 deg, 180 deg"),
                                 HasSubstr("pins pass           1404 Hz"), HasSubstr("199.7 N*m on the driven pulley"),
                                 HasSubstr("load 150 N*m: safety factor 1.33\n"), Not(HasSubstr("exceeds the limit: the chain slips"))));
    EXPECT_THAT(heavy.out, AllOf(HasSubstr("safety factor 0.222\n"), HasSubstr("the load exceeds the limit: the chain slips")));
    EXPECT_THAT(run({"check", "baseline", "--set", "drag.driven_seals=250"}).out,
                HasSubstr("load and drag 400 N*m: safety factor 0.499\n"));
    EXPECT_THAT(run({"check", "free_ring"}).out, Not(HasSubstr("torque limit"))) << "it has no pulleys";
}

TEST_F(Messages, OfHelpAreBrief) {
    EXPECT_THAT(run({"--help"}).out, HasSubstr("  7    target accuracy missed"));
    for (const char* command : {"run", "batch", "merge", "resume", "tune"})
        EXPECT_THAT(run({command, "--help"}).out, AllOf(Not(HasSubstr("target accuracy missed")), HasSubstr("cvtflow --help"))) << command;
}

}  // namespace
}  // namespace cvtflow::tools
