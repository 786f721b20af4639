/// Errors of users, and the one line of the message; answers to a command that is nearly right, and warnings.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <hdf5.h>
#include <sys/stat.h>

#include <cstdio>

#include "engine/record/hdf5/file_seal.hpp"
#include "tasks/run/run_means.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

struct Mistake {
    Words arguments;
    int status;
    std::string message;  ///< all of stderr, without the last line break; FOLDER represents the working directory
};

class Errors : public Program {
protected:
    /// Files to stumble over.
    Errors() {
        write("text.h5", "no HDF5 at all\n");
        write("broken.toml", "[chain]\npich = 3\npins = \"x\"\n");
        write("syntax.toml", "[chain\n");
        write("method.toml", "[run]\nmethod = \"rk45\"\nstepp = \"50 ns\"\n");
        write("no_method.toml", "[run]\nmethod = \"rk5\"\n");
        write("no_estimate.toml", "[run]\nmethod = \"rk4\"\nstep_control = \"error\"\n[chain]\npins = \"x\"\n");
        write("text_state.toml", "[start]\nstate = \"text.h5\"\n");
        write("no_member.toml", "[run]\nmethod = \"rkc-s1\"\n");
        write("no_executor.toml", "[run]\n\nschedule = \"flwo\"\n");
        write("no_state.toml", "[start]\nstate = \"gone.h5\"\n");
        std::filesystem::create_directory(folder_ / "folder");
        write("large.toml", "");
        std::filesystem::resize_file(folder_ / "large.toml", 70'000'000);
        mkfifo((folder_ / "pipe").c_str(), 0600);
        const hid_t other = H5Fcreate((folder_ / "other.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
        H5Fclose(other);
    }

    void make_records() const {
        ASSERT_EQ(run_briefly({"-q", "-o", "record.h5"}).status, 0);
        ASSERT_EQ(run({"settle", "tiny", "-q", "-o", "state.h5", "--time", "20us", "--set", "start.ramp_time=10us"}).status, 0);
        cut("record.h5", "cut_record.h5", 2000);
        cut("state.h5", "cut_state.h5", 2000);
    }

    void expect(const Mistake& mistake) const {
        const Outcome outcome = run(mistake.arguments);
        const std::filesystem::path program = program_of(mistake.arguments);
        std::string message = program.filename().string() + ": " + mistake.message + "\n";
        for (std::size_t at; (at = message.find("FOLDER")) != std::string::npos;) message.replace(at, 6, folder_.string());
        EXPECT_EQ(outcome.err, message) << testing::PrintToString(mistake.arguments);
        EXPECT_EQ(outcome.status, mistake.status) << testing::PrintToString(mistake.arguments);
        EXPECT_EQ(outcome.out, "") << testing::PrintToString(mistake.arguments);
    }
};

TEST_F(Errors, OnTheCommandLineExitWithTwo) {
    const std::vector<Mistake> mistakes{
        {{}, 2, "A subcommand is required (cvtflow --help)"},
        {{"rum"}, 2, "no command 'rum', did you mean 'run'? (cvtflow --help, or cvtflow-lab rum)"},
        {{"gearbox"}, 2, "no command 'gearbox' (cvtflow --help, or cvtflow-lab gearbox)"},
        {{"run"}, 2, "SCENE is required (cvtflow run --help)"},
        {{"run", "tiny", "extra"}, 2, "The following argument was not expected: extra (cvtflow run --help)"},
        {{"run", "tiny", "--til", "1ms"},
         2,
         "The following arguments were not expected: 1ms --til, did you mean '--until'? (cvtflow run --help)"},
        {{"run", "tiny", "--frobnicate"}, 2, "The following argument was not expected: --frobnicate (cvtflow run --help)"},
        {{"run", "tiny", "--dry-run"},
         2,
         "The following argument was not expected: --dry-run, did you mean 'cvtflow check'? (cvtflow run --help)"},
        {{"info"}, 2, "FILE is required (cvtflow info --help)"},
        {{"explain"}, 2, "KEY is required (cvtflow explain --help)"},
        {{"list", "method"}, 2, "no list 'method', did you mean 'methods'?"},
    };
    for (const Mistake& mistake : mistakes) expect(mistake);
}

TEST_F(Errors, InTheProgramNameTheOtherOne) {
    const auto message = [&](const std::string& program, const std::string& command) {
        std::FILE* pipe = popen(("'" + program + "' " + command + " 2>&1").c_str(), "r");
        char line[200] = "";
        EXPECT_NE(std::fgets(line, sizeof line, pipe), nullptr) << program << " " << command;
        pclose(pipe);
        return std::string(line);
    };
    EXPECT_THAT(message(CVTFLOW_PROGRAM, "fit"), testing::HasSubstr("did you mean 'cvtflow.fit of the Python module'?"));
#ifdef CVTFLOW_LAB
    const Words product_commands = commands_of(CVTFLOW_PROGRAM);
    for (const std::string& command : commands_of(CVTFLOW_LAB)) {
        if (std::find(product_commands.begin(), product_commands.end(), command) != product_commands.end()) continue;  // both have it
        EXPECT_THAT(message(CVTFLOW_PROGRAM, command), testing::HasSubstr("(cvtflow --help, or cvtflow-lab " + command + ")\n"));
    }
    EXPECT_EQ(message(CVTFLOW_LAB, "report"), "cvtflow-lab: no command 'report' (cvtflow-lab --help, or cvtflow report)\n");
#endif
}

TEST_F(Errors, InValuesOfOptionsExitWithTwo) {
    write("sweep.toml",
          "[sweep]\nscene = \"tiny\"\n[[axes]]\nkey = \"load.torque\"\nvalues = [1, 2]\n[outputs]\nscalars = [\"slip mean\"]\n");
    const std::vector<Mistake> mistakes{
        {{"run", "tiny", "--checkpoint-every", ""}, 2, "--checkpoint-every : expected a time such as \"30 s\" or \"10 min\""},
        {{"run", "tiny", "--checkpoint-every", "7"}, 2, "--checkpoint-every 7: expected a time such as \"30 s\" or \"10 min\""},
        {{"batch", "sweep.toml", "--checkpoint-every", ""}, 2, "--checkpoint-every : expected a time such as \"30 s\" or \"10 min\""},
        {{"batch", "sweep.toml", "--grace", "soon"}, 2, "--grace soon: expected a time such as \"30 s\" or \"10 min\""},
        {{"batch", "sweep.toml", "--shard", ""}, 2, "--shard : expected I/N with 1 <= I <= N <= 100000, e.g. 3/8"},
        {{"batch", "sweep.toml", "--shard", "0/3"}, 2, "--shard 0/3: expected I/N with 1 <= I <= N <= 100000, e.g. 3/8"},
        {{"batch", "sweep.toml", "--shard", "1/100000000"}, 2, "--shard 1/100000000: expected I/N with 1 <= I <= N <= 100000, e.g. 3/8"},
        {{"batch", "sweep.toml", "--shard", "1/99999999999999999999"},
         2,
         "--shard 1/99999999999999999999: expected I/N with 1 <= I <= N <= 100000, e.g. 3/8"},
        {{"batch", "sweep.toml", "--threads", "-1"}, 2, "--threads: Value -1 not in range 1 to 1024 (cvtflow batch --help)"},
        {{"batch", "sweep.toml", "--threads", "0"}, 2, "--threads: Value 0 not in range 1 to 1024 (cvtflow batch --help)"},
    };
    for (const Mistake& mistake : mistakes) expect(mistake);
    for (const Words& words : {Words{"batch", "sweep.toml", "--retry", "nonsense"}, Words{"batch", "sweep.toml", "--retry", ""}}) {
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, 2);
        EXPECT_THAT(outcome.err,
                    testing::StartsWith("cvtflow: --retry " + words.back() + ": not one of ok, unreliable, diverged, budget, "));
    }
    EXPECT_FALSE(exists("results/sweep"));
}

const std::vector<Mistake> mistakes_in_scenes{
    {{"run", "basline"}, 1, "no scene 'basline' (did you mean 'baseline'?)"},
    {{"run", "zzzzzzz"}, 1, "no scene 'zzzzzzz' (cvtflow list scenes)"},
    {{"run", "missing.toml"}, 1, "missing.toml: cannot be read: No such file or directory"},
    {{"run", "./folder"}, 1, "./folder: cannot be read: a folder, not a file"},
    {{"run", "broken.toml"},
     1,
     "broken.toml:2:1: chain.pich: unknown key (did you mean \"chain.pitch\"?)\ncvtflow: broken.toml:3:8: chain.pins: \"x\" is not an "
     "integer"},
    {{"check", "broken.toml"},
     1,
     "broken.toml:2:1: chain.pich: unknown key (did you mean \"chain.pitch\"?)\ncvtflow: broken.toml:3:8: chain.pins: \"x\" is not an "
     "integer"},
    {{"check", "method.toml"},
     1,
     "method.toml:2:10: run.method: no method 'rk45' (did you mean 'rk4'?)\ncvtflow: method.toml:3:1: run.stepp: unknown key (did you "
     "mean \"run.step\"?)"},
    {{"run", "no_method.toml"}, 1, "no_method.toml:2:10: run.method: no method 'rk5' (did you mean 'rk4'?)"},
    {{"check", "no_member.toml"},
     1,
     "no_member.toml:2:10: run.method: rkc-s1 belongs to the laboratory: cvtflow-lab run SCENE --method rkc-s1"},
    {{"check", "no_executor.toml"},
     1,
     "no_executor.toml:3:12: run.schedule: unknown executor 'flwo' (did you mean \"flow\"?) (cvtflow list executors; or auto)"},
    {{"check", "no_estimate.toml"},
     1,
     "no_estimate.toml:3:16: run.step_control: 'rk4' has no error estimate; only \"fixed\" steps are possible (cvtflow list methods "
     "--all)\ncvtflow: no_estimate.toml:5:8: chain.pins: \"x\" is not an integer"},
    {{"check", "text_state.toml"}, 1, "text_state.toml:2:9: start.state: FOLDER/text.h5: not an HDF5 file"},
    {{"run", "no_state.toml"}, 1, "no_state.toml:2:9: start.state: no file \"gone.h5\""},
    {{"settle", "free_ring"}, 1, "free_ring: nothing to settle: start.layout is \"ring\" or start.settling_time is 0"},
    {{"run", "tiny", "--until", "stedy"}, 2, "--until stedy: \"stedy\" is neither a quantity nor \"steady\" (did you mean \"steady\"?)"},
    {{"explain", "chain.pich"}, 1, "chain.pich: unknown key (did you mean \"chain.pitch\"?)"},
};

TEST_F(Errors, InScenesSayWhereAndWhat) {
    for (const Mistake& mistake : mistakes_in_scenes) expect(mistake);
    EXPECT_THAT(run({"check", "syntax.toml"}).err, testing::StartsWith("cvtflow: syntax.toml:1:"));
}

TEST_F(Errors, InSettingsNameTheOptionThatWasGiven) {
    const std::vector<Mistake> mistakes{
        {{"run", "tiny", "--method", "rk5"}, 2, "--method rk5: no method 'rk5' (did you mean 'rk4'?)"},
        {{"run", "tiny", "--method", "zzzzzz"}, 2, "--method zzzzzz: no method 'zzzzzz' (cvtflow list methods)"},
        {{"run", "tiny", "--detail", "medium"},
         2,
         "--detail medium: not one of rigid, fine, full (use \"fine\", or \"rigid\" at lower cost)"},
        {{"run", "tiny", "--detail", "fein"}, 2, "--detail fein: not one of rigid, fine, full (did you mean \"fine\"?)"},
        {{"run", "tiny", "--set", "chain.pich=3"}, 2, "--set chain.pich=3: chain.pich: unknown key (did you mean \"chain.pitch\"?)"},
        {{"run", "tiny", "--set", "chain.pins=abc"}, 2, "--set chain.pins=abc: chain.pins: \"abc\" is not an integer"},
        {{"run", "tiny", "--set", "nonsense"}, 2, "--set nonsense: not of the form key=value"},
        {{"run", "tiny", "--until", "5 mm"}, 2, "--until 5 mm: 5 mm is a length, expected a time (s)"},
        {{"run", "tiny", "--until=-1"}, 2, "--until -1: -1 s is outside [1e-9, 1e4] s"},
        {{"run", "tiny", "--until", ""}, 2, "--until : \"\" does not begin with a number"},
        {{"run", "tiny", "--step", "1"}, 2, "--step 1: 1 s is outside [1e-12, 1e-2] s (did you mean \"1 us\"?)"},
        {{"run", "tiny", "--threads=-1"}, 2, "--threads -1: -1 is outside [0, 1024]"},
        {{"run", "tiny", "--segments", "30"}, 2, "--segments 30: 30 segments for chain.pins = 24"},
        {{"run", "tiny", "--set", "run.assembly=staged"},
         2,
         "--set run.assembly=staged: run.assembly: \"staged\" belongs to the laboratory: cvtflow-lab run"},
        {{"settle", "tiny", "--method", "rk5"}, 2, "--method rk5: no method 'rk5' (did you mean 'rk4'?)"},
        {{"settle", "tiny", "--step", "1"}, 2, "--step 1: 1 s is outside [1e-12, 1e-2] s (did you mean \"1 us\"?)"},
        {{"settle", "tiny", "--threads=-1"}, 2, "--threads -1: -1 is outside [0, 1024]"},
        {{"settle", "tiny", "--time", "3ms"}, 2, "--time 3ms: start.ramp_time: 5e-3 s is longer than start.settling_time = 3e-3 s"},
    };
    for (const Mistake& mistake : mistakes) expect(mistake);
}

#ifdef CVTFLOW_LAB
TEST_F(Errors, InSettingsOfTheLaboratoryNameTheOption) {
    const std::vector<Mistake> mistakes{
        {{"local-error", "tiny"},
         1,
         "tiny: the start is not settled, so its errors are meaningless: add --settle, or a state file with --set start.state=FILE "
         "(cvtflow settle)"},
        {{"spectrum", "tiny", "-q"},
         1,
         "tiny: the start is not settled, so its eigenvalues are meaningless: add --settle, or a state file with --set start.state=FILE "
         "(cvtflow settle)"},
        {{"stability", "rk4", "--scene", "basline", "-q"}, 1, "no scene 'basline' (did you mean 'baseline'?)"},
        {{"stability"}, 2, "METHOD is required (cvtflow-lab stability --help)"},
        {{"local-error", "tiny", "--friction", "x"}, 2, "--friction: x not in {piecewise,smoothed,both} (cvtflow-lab local-error --help)"},
        {{"run", "tiny", "--method", "rkc-s1"},
         2,
         "--method rkc-s1: no method 'rkc-s1': rkc-s<stages>[-e<damping>] takes 2 to 400 stages, damping 0 to 100 (2/13 if absent)"},
        {{"spectrum", "tiny", "--state", "gone.h5"}, 2, "--state gone.h5: no file \"gone.h5\""},
        {{"spectrum", "tiny", "--method", "rk5"}, 2, "--method rk5: no method 'rk5' (did you mean 'rk4'?)"},
        {{"dot", "tiny", "--cycle", "x"}, 2, "--cycle x: a step of rk4 has evaluate, detect, locate, truncate"},
        {{"dot", "tiny", "--method", "leapfrog-rkc", "--cycle", "x"},
         2,
         "--cycle x: a step of leapfrog-rkc has evaluate, detect, locate, truncate, record, friction, finish"},
        {{"stability", "dumka3"}, 2, "dumka3 chooses among tables of stages: name one of them (cvtflow list methods --all)"},
        {{"stability", "rk5"}, 2, "no method 'rk5' (did you mean 'rk4'?)"},
        {{"local-error", "tiny", "--settle", "--methods", "rk4,heum"}, 2, "no method 'heum' (did you mean 'heun'?)"},
        {{"compare", "tiny", "rk4"}, 2, "rk4: write METHOD@STEP, METHOD@auto, or METHOD@LONGEST~TOLERANCE for steps by error"},
        {{"compare", "tiny", "rk4@50mm"}, 2, "rk4@50mm: '50mm' is not a time above 0, such as 40ns"},
        {{"compare", "tiny", "rk5@50ns"}, 2, "no method 'rk5' (did you mean 'rk4'?)"},
        {{"compare", "tiny", "rk4@50ns", "--duration", "0s"}, 2, "--duration: '0s' is not a time above 0, such as 40ns"},
        {{"compare", "tiny", "rk4@50ns", "--pin", "24"}, 2, "--pin 24: the chain has pins 0 to 23; or \"first\""},
        {{"local-error", "tiny", "--settle", "--steps", "3mm"}, 2, "--steps 3mm: '3mm' is not a time above 0, such as 40ns"},
    };
    for (const Mistake& mistake : mistakes) expect(mistake);
}
#endif

TEST_F(Errors, InFilesSayWhatTheFileIs) {
    make_records();
    const std::string record = std::to_string(read("record.h5").size() - engine::seal_size),
                      state = std::to_string(read("state.h5").size() - engine::seal_size);
    const std::vector<Mistake> mistakes{
        {{"info", "missing.h5"}, 1, "missing.h5: No such file or directory"},
        {{"info", "folder"}, 1, "folder: a folder without the table of a sweep (cases.h5)"},
        {{"info", "text.h5"}, 1, "text.h5: not an HDF5 file"},
        {{"info", "pipe"}, 1, "pipe: not a regular file"},
        {{"info", "/dev/zero"}, 1, "/dev/zero: not a regular file"},
        {{"table", "pipe"}, 1, "pipe: not a regular file"},
        {{"resume", "pipe"}, 1, "pipe: not a regular file"},
        {{"check", "./pipe"}, 1, "./pipe: cannot be read: not a regular file"},
        {{"check", "/dev/zero"}, 1, "/dev/zero: cannot be read: not a regular file"},
        {{"batch", "/dev/zero", "-o", "sweep"}, 1, "/dev/zero: cannot be read: not a regular file"},
        {{"check", "large.toml"}, 1, "large.toml: cannot be read: 70000000 bytes, more than the 4194304 that such a file may have"},
        {{"info", "other.h5"}, 1, "other.h5: an HDF5 file, but neither a record, a state nor a sweep's table of cvtflow"},
        {{"info", "cut_record.h5"}, 1, "cut_record.h5: truncated HDF5 file: 2000 bytes of " + record},
        {{"info", "cut_state.h5"}, 1, "cut_state.h5: truncated HDF5 file: 2000 bytes of " + state},
        {{"run", "tiny", "--set", "start.state=gone.h5"}, 2, "--set start.state=gone.h5: start.state: no file \"gone.h5\""},
        {{"run", "tiny", "--set", "start.state=text.h5"}, 1, "--set start.state=text.h5: start.state: FOLDER/text.h5: not an HDF5 file"},
        {{"run", "tiny", "--set", "start.state=cut_state.h5"},
         1,
         "--set start.state=cut_state.h5: start.state: FOLDER/cut_state.h5: truncated HDF5 file: 2000 bytes of " + state},
        {{"run", "tiny", "--set", "start.state=record.h5"},
         1,
         "--set start.state=record.h5: start.state: FOLDER/record.h5: an HDF5 file, but not a state file (it is a record of a run)"},
        {{"run", "tiny", "--set", "start.state=state.h5", "--set", "detail.pulleys=rigid"},
         1,
         "--set start.state=state.h5: start.state: FOLDER/state.h5 contains 1032 unknowns, this scene has 968\n  detail.pulleys = "
         "\"rigid\", "
         "settled with \"elastic\""},
        {{"check", "tiny", "--set", "start.state=state.h5", "--set", "detail.pulleys=rigid"},
         1,
         "--set start.state=state.h5: start.state: FOLDER/state.h5 contains 1032 unknowns, this scene has 968\n  detail.pulleys = "
         "\"rigid\", "
         "settled with \"elastic\""},
    };
    for (const Mistake& mistake : mistakes) expect(mistake);
}

TEST_F(Errors, BlameNoSettingThatWasNotGiven) {
    expect(
        {{"run", "tiny", "--tolerance", "1"},
         2,
         "--tolerance 1: run.step_control: 'rk4' has no error estimate; only \"fixed\" steps are possible (cvtflow list methods --all)"});
}

TEST_F(Errors, OfTheStandardLibraryAreInOurWords) {
    const std::string long_name(300, 'a');
    for (const char* command : {"table", "resume"}) expect({{command, long_name}, 1, long_name + ": File name too long"});
}

TEST_F(Errors, OfPlacesComeBeforeTheWork) {
    const std::string long_name(252, 'x');  // 255 bytes at most, .part included
    const std::vector<Mistake> mistakes{
        {{"run", "tiny", "-o", "missing/x.h5"}, 1, "missing/x.h5: cannot create: the folder 'missing' does not exist"},
        {{"run", "tiny", "-o", "folder"}, 1, "folder: cannot create: a folder, not a file"},
        {{"run", "tiny", "-o", long_name}, 1, long_name + ".part: cannot create: File name too long"},
        {{"settle", "tiny", "-o", "missing/x.h5"}, 1, "missing/x.h5: cannot create: the folder 'missing' does not exist"},
        {{"settle", "tiny", "-o", "folder"}, 1, "folder: cannot create: a folder, not a file"},
    };
    for (const Mistake& mistake : mistakes) expect(mistake);
}

// Answers of the program to a command that is nearly right, and its warnings.

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

TEST_F(Messages, OfACheckSizePressuresAndControl) {
    const Outcome json = run({"check", "vl300", "--json"}), torque = run({"check", "vl300", "--for-torque", "300 Nm", "--safety", "1.3"});
    EXPECT_THAT(json.out, AllOf(HasSubstr("\"decided_by\": \"clamping.safety\""), HasSubstr("\"driven_pressure\": \"Pa\"")));
    EXPECT_THAT(torque.out, AllOf(HasSubstr("ratio 3.12"), HasSubstr("bar on shaft 2 are above hydraulics.relief_pressure, 60 bar"),
                                  Not(HasSubstr("evaluations"))));
    EXPECT_THAT(run({"check", "control", "--set", "control.ratio=[[0, 1], [\"0.5 s\", 1.6]]", "--until", "0.5 s"}).out,
                ContainsRegex("control has to add -.* kN to clamping.driving, its authority is 10 kN: change one of both"));
    EXPECT_THAT(run({"check", "tiny", "--for-torque", "3 kN"}).err, HasSubstr("--for-torque 3 kN: expected a torque"));
    EXPECT_THAT(run({"check", "free_ring", "--for-torque", "3 Nm"}).err, HasSubstr("--for-torque: free_ring: it has no pulleys"));
    EXPECT_THAT(run({"check", "tiny", "--safety", "2"}).err, HasSubstr("--for-torque"));
    EXPECT_THAT(run({"check", "manoeuvre"}).out, HasSubstr("not sized           a controller of slip makes S_2 in the run"));
}

TEST_F(Messages, OfHelpAreBrief) {
    EXPECT_THAT(run({"--help"}).out, HasSubstr("  7    target accuracy missed"));
    for (const char* command : {"run", "batch", "merge", "resume", "tune"})
        EXPECT_THAT(run({command, "--help"}).out, AllOf(Not(HasSubstr("target accuracy missed")), HasSubstr("cvtflow --help"))) << command;
}

}  // namespace
}  // namespace cvtflow::tools
