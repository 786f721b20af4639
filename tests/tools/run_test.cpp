/// Runs: what `cvtflow run` records, reports and leaves; inputs from CSV files; bits that must not depend on the processor.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <csignal>
#include <filesystem>

#include "tasks/run/run_recorder.hpp"
#include "tests/tools/program_fixture.hpp"
#include "tools/program/progress.hpp"

namespace cvtflow::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class Run : public Program {
protected:
    /// The scene with a state file that fits, settled for 20 us.
    void write_settled_scene() const {
        ASSERT_EQ(run({"settle", "tiny", "-q", "-o", "state.h5", "--time", "20us", "--set", "start.ramp_time=10us"}).status, 0);
        std::string text = read_ready("tiny.toml");
        text.replace(text.find("settling_time = \"10 ms\""), 23, "settling_time = \"20 us\"");
        text.replace(text.find("ramp_time = \"5 ms\""), 18, "ramp_time = \"10 us\"\nstate = \"state.h5\"");
        text.replace(text.find("until = \"1 ms\""), 14, "until = \"20 us\"");
        write("settled.toml", text);
    }
    [[nodiscard]] std::string read_ready(const std::string& name) const {
        return read(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/" + name);
    }
};

TEST_F(Run, RecordsInResultsAndSumsUp) {
    const Outcome outcome = run_briefly();
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.out, StartsWith("tiny: finished at t = 2e-05 s\n"));
    EXPECT_THAT(outcome.out,
                AllOf(HasSubstr("\n  method "), HasSubstr("\n  state hash "), HasSubstr("\n  machine "), HasSubstr("\n  program ")));
    EXPECT_THAT(outcome.out, HasSubstr("\n  record              results/tiny.h5 ("));
    EXPECT_EQ(record("results/tiny.h5").status(), "finished");
    EXPECT_EQ(record("results/tiny.h5").rows(), 3u);  // 0, 10, 20 us
}

/// Beside what check states: attributes and one chunk of states, 0.4 MB. Chunks of 512 rows took 2 MB more.
TEST_F(Run, TakesTheRoomThatCheckStates) {
    const std::vector<std::string> settings{"start.settling_time=1 ms", "start.ramp_time=0.5 ms", "run.until=5 ms"};
    ASSERT_EQ(run(Words{"run", "baseline", "--detail", "rigid", "-q", "-o", "short.h5"} + set_all(settings)).status, 0);
    tasks::Scene scene = tasks::read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/baseline.toml");
    tasks::apply_detail(scene, "rigid");
    tasks::set_values(scene, settings);
    const double stated = tasks::record_bytes(scene, model::make_chain(scene.parameters));
    EXPECT_LT(static_cast<double>(std::filesystem::file_size(folder_ / "short.h5")), stated + 0.4e6);
    EXPECT_EQ(record("short.h5").rows(), 101u);
}

TEST_F(Run, ReportsThatClampingWasAboveItsLimit) {
    EXPECT_THAT(run_briefly({"--set", "wear.clamping_limit=[[0, 1], [0.1, 0.5]]"}).out,
                HasSubstr("clamping exceeds wear.clamping_limit at its slip speed in 100 % of the time"));
    EXPECT_THAT(run_briefly({"--set", "wear.clamping_limit=[[0, 1e6], [0.1, 1e6]]"}).out, testing::Not(HasSubstr("clamping_limit")));
}

TEST_F(Run, SumsUpTemperaturesAndWhereHeatWent) {
    EXPECT_THAT(run_briefly().out, testing::Not(HasSubstr("temperature")));
    EXPECT_THAT(run_briefly({"--set", "heat.enabled=true"}).out,
                AllOf(HasSubstr("\n  temperature         pulleys 353.15"), HasSubstr(" to ambient\n")));
}

TEST_F(Run, SumsUpWhatCouplingsStoreAndCarry) {
    EXPECT_THAT(run_briefly().out, testing::Not(HasSubstr("coupling of shaft")));
    const Outcome outcome = run_briefly({"-o", "coupled.h5", "--set", "load.mode=coupling", "--set", "load.speed=209 rad/s", "--set",
                                         "record.channels=[\"shaft_2/twist\", \"shaft_2/coupling_energy\", \"shaft_2/coupling_work\"]"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const engine::RunReader there = record("coupled.h5");
    const auto last = [&](const char* channel) { return there.channel(channel).back(); };
    EXPECT_THAT(outcome.out,
                HasSubstr(fmt::format("\n  coupling of shaft 2 twist {:.4g} rad, {:.4g} J stored at the end; far end: took {:.4g} J;",
                                      last("shaft_2/twist"), last("shaft_2/coupling_energy"), -last("shaft_2/coupling_work"))));
    EXPECT_THAT(outcome.out, testing::Not(HasSubstr("coupling of shaft 1")));
}

TEST_F(Run, SumsUpWhatThePumpTakes) {
    EXPECT_THAT(run_briefly().out, testing::Not(HasSubstr("hydraulics")));
    const Outcome outcome = run_briefly({"-o", "oil.h5", "--set", "hydraulics.mode=force"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const engine::RunReader there = record("oil.h5");
    const auto last = [&](const char* channel) { return there.channel(channel).back(); };
    const double power = last("hydraulics/pump") / 20e-6, lost = last("hydraulics/mechanical") / 20e-6;
    EXPECT_GT(power, 0.0);
    EXPECT_THAT(outcome.out, HasSubstr(fmt::format("\n  hydraulics          pump {:.1f} W: mechanical {:.1f}  ", power, lost)));
    EXPECT_NEAR(last("pump/power"), power, 0.1 * power);
    const Outcome loaded = run(Words{"run", "tiny", "--detail", "rigid", "-o", "none", "--until", "0.2 ms"} +
                               set_all({"start.settling_time=2ms", "start.ramp_time=1ms", "hydraulics.mode=force"}));
    EXPECT_THAT(loaded.out, HasSubstr(" % of the variator; "));
}

TEST_F(Run, ReportsTransitionsOfSettlingBesideItsOwn) {
    // Clamped while it settles, for 50 us: tips come to the sheaves then.
    const Outcome outcome = run({"run", "tiny", "-o", "none", "--until", "5us", "--set", "start.settling_time=50us", "--set",
                                 "start.ramp_time=10us", "--set", "run.output_interval=5us"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.out, testing::ContainsRegex("\n  transitions +[0-9]+ detected, [0-9]+ steps truncated, [0-9]+ suppressed; "
                                                    "settling [1-9][0-9]* detected, [1-9][0-9]* steps truncated, [0-9]+ suppressed\n"));
}

TEST_F(Run, ReportsItsProgressInPlainLinesWhereThereIsNoTerminal) {
    EXPECT_EQ(run_briefly({"-o", "none"}).err, "") << "a line every 10 s";
    const tasks::Counters counters{};
    testing::internal::CaptureStderr();
    ProgressDisplay display(false, 20e-6, std::chrono::seconds(0));
    display.show({-20e-6, -20e-6, 0.0, 0.0, counters});
    display.show({-20e-6, -10e-6, 0.0, 1.0, counters});
    display.show({0.0, 0.0, 20e-6, 2.0, counters});
    display.show({0.0, 10e-6, 20e-6, 3.0, counters});
    EXPECT_EQ(testing::internal::GetCapturedStderr(),
              "settling: 0 %, t = -20 us\n"
              "settling: 50 %, t = -10 us, 1e+05 s per simulated second (1e-05 x real time), 0:03 left\n"
              "running: 0 %, t = 0 s of 20 us\n"
              "running: 50 %, t = 10 us of 20 us, 1e+05 s per simulated second (1e-05 x real time), 0:01 left\n");
}

TEST_F(Run, DrawsABarOnATerminalThatFitsAndGoesAway) {
    const std::vector<std::string> brief{
        "run", "tiny", "-o", "none", "--until", "1 ms", "--set", "start.settling_time=20us", "--set", "start.ramp_time=10us"};
    for (const int columns : {40, 70, 120}) {
        const std::string text = draw(brief, columns);
        const std::string drawn = text.substr(0, text.find("tiny: finished"));
        EXPECT_THAT(drawn, StartsWith("\rsettling "));
        EXPECT_THAT(drawn, testing::EndsWith("\r\x1b[K"));
        EXPECT_EQ(drawn.find('\n'), std::string::npos);
        for (std::size_t begin = 0, end; (end = drawn.find('\r', begin)) != std::string::npos; begin = end + 1) {
            EXPECT_LT(end - begin, static_cast<std::size_t>(columns) + 3) << "the code to clear the rest of the line takes 3";
        }
        EXPECT_TRUE(columns < 70 || drawn.find(" [>") != std::string::npos) << drawn;
    }
}

TEST_F(Run, WithoutOutputRecordsNothing) {
    EXPECT_THAT(run_briefly({"-o", "none"}).out, HasSubstr("\n  record              none\n"));
    EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(Run, QuietPrintsNothingButErrors) {
    const Outcome good = run_briefly({"-q"});
    EXPECT_EQ(good.out + good.err, "");
    EXPECT_TRUE(exists("results/tiny.h5"));
    const Outcome bad = run_briefly({"-q", "--set", "run.max_steps=10"});
    EXPECT_EQ(bad.out, "");
    EXPECT_THAT(bad.err, StartsWith("cvtflow: the budget of 10 steps (run.max_steps) is used up at t = "));
}

TEST_F(Run, ThatUsesUpItsBudgetExitsWithFour) {
    const Outcome outcome = run_briefly({"--set", "run.max_steps=10", "-o", "r.h5"});
    EXPECT_EQ(outcome.status, 4);
    EXPECT_THAT(outcome.out, StartsWith("tiny: stopped: the budget of 10 steps"));
    EXPECT_THAT(record("r.h5").status(), StartsWith("the budget of 10 steps"));
    EXPECT_EQ(run({"settle", "tiny", "-q", "--set", "run.max_steps=10"}).status, 4);
    EXPECT_FALSE(exists("tiny_state.h5"));
}

TEST_F(Run, ThatBreaksDownExitsWithThree) {
    const Outcome outcome = run_briefly({"--step", "10 us", "--until", "5 ms", "-o", "r.h5"});
    EXPECT_EQ(outcome.status, 3);
    EXPECT_THAT(outcome.out, StartsWith("tiny: stopped: "));
    EXPECT_NE(record("r.h5").status(), "finished");
}

TEST_F(Run, ReplacesTheRecordOfADefaultNameAndReportsIt) {
    EXPECT_THAT(run_briefly().err, testing::Not(HasSubstr("replaced")));
    const Outcome again = run_briefly();
    EXPECT_EQ(again.status, 0);
    EXPECT_THAT(again.err, StartsWith("cvtflow: results/tiny.h5: the existing file is replaced\n"));
}

TEST_F(Run, KilledLeavesAReadablePart) {
    Child child(run_to_be_ended("r.h5") + Words{"--until", "1 s", "--checkpoint-every", "5 ms"}, folder_);
    EXPECT_EQ(child.ended_when([&] { return rows_of("r.h5.part") > 0; }, SIGKILL).status, 128 + SIGKILL);
    EXPECT_FALSE(exists("r.h5"));
    EXPECT_EQ(record("r.h5.part").status(), "running");
    EXPECT_THAT(run({"info", "r.h5.part"}).out, HasSubstr("running (still being written, or left by a killed run)"));
}

TEST_F(Run, BeginsWithTheStateFileOfItsScene) {
    write_settled_scene();
    const Outcome outcome = run({"run", "settled.toml"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.err, testing::Not(HasSubstr("settling")));
    EXPECT_THAT(run({"check", "settled.toml"}).out, HasSubstr("state file " + folder_.string() + "/state.h5"));
}

TEST_F(Run, OfAnotherDetailDropsTheStateFileAndReportsIt) {
    write_settled_scene();
    const Outcome outcome = run({"run", "settled.toml", "--detail", "rigid"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.err, StartsWith("cvtflow: detail.pins = \"rigid\" (was \"halves\"): "
                                        "the state in " +
                                        folder_.string() + "/state.h5 no longer fits; the run settles again\n"));
    EXPECT_THAT(outcome.out, HasSubstr("\n  settled "));
}

TEST_F(Run, ThatSettlesNeedsNoStateFile) {
    write_settled_scene();
    std::filesystem::remove(folder_ / "state.h5");
    EXPECT_EQ(run({"run", "settled.toml"}).status, 1);
    const Outcome outcome = run({"run", "settled.toml", "--settle"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.out, HasSubstr("\n  settled "));
}

TEST_F(Run, FindsScenesByTheEnvironment) {
    std::filesystem::create_directory(folder_ / "mine");
    write("mine/special.toml", read_ready("tiny.toml"));
    EXPECT_EQ(run({"check", "special"}).status, 1);
    const Outcome outcome = run({"check", "special"}, {"CVTFLOW_SCENES=nowhere:mine"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("\n  file                mine/special.toml\n"));
}

// Inputs from CSV files and inputs that follow a law, through the program.

class CsvInput : public Program {
protected:
    CsvInput() { write("load.csv", "t [us],M [N*m]\n0,12\n30,12\n50,15\n"); }

    static inline const std::vector<std::string> all{"--until", "60 us",
                                                     "--set",   "load.torque={csv = \"load.csv\"}",
                                                     "--set",   "load.quadratic=1e-4",
                                                     "--set",   "clamping.safety=1.1",
                                                     "--set",   "control.enabled=true",
                                                     "--set",   "control.quantity=slip",
                                                     "--set",   "record.channels=tips/*",
                                                     "--set",   "start.settling_time=20us",
                                                     "--set",   "start.ramp_time=10us"};
};

TEST_F(CsvInput, ARunContinuesBitForBitWithoutTheFileAndWhateverTheThreads) {
    const std::vector<std::string> run_tiny{"run", "tiny", "-q"};
    ASSERT_EQ(run(run_tiny + all + std::vector<std::string>{"-o", "whole.h5", "--threads", "1"}).status, 0);
    const std::string whole = hash_in(run({"info", "whole.h5"}).out);
    ASSERT_NE(whole, "none");
    ASSERT_EQ(run(run_tiny + all + std::vector<std::string>{"-o", "parallel.h5", "--threads", "2", "--set", "run.schedule=flow"}).status,
              0);
    EXPECT_EQ(hash_in(run({"info", "parallel.h5"}).out), whole);
    const std::vector<std::string> cut{"-o", "cut.h5", "--checkpoint-every", "1 h", "--set", "run.max_steps=40"};
    ASSERT_EQ(run(run_tiny + all + cut).status, 4);
    std::filesystem::remove(folder_ / "load.csv");
    const Outcome resumed = run({"resume", "cut.checkpoint.h5", "-q", "--set", "run.max_steps=0"});
    ASSERT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_EQ(hash_in(run({"info", "cut.h5"}).out), whole);
    EXPECT_THAT(run({"info", "cut.h5"}).out, HasSubstr("tips/radial_force"));
}

TEST_F(CsvInput, ErrorsAreReportedWithPlaceInSceneAndFile) {
    write("load.csv", "t,M\n0,12\n1,1e9\n");
    const Outcome outcome = run({"check", "tiny", "--set", "load.torque={csv = \"load.csv\"}"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr("load.torque: 1e9 N*m is outside [-1e5, 1e5] N*m (load.csv:3:2)"));
}

TEST_F(CsvInput, ChannelsThatDoNotExistAreAnErrorOfTheScene) {
    const Outcome outcome = run({"check", "tiny", "--set", "record.channels=[\"tips/*\", \"tips/normal_froce\"]"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr("unknown channel 'tips/normal_froce' (did you mean \"tips/normal_force\"?)"));
}

// Bits that must not depend on the processor.

using Hashes = Program;

/// glibc chooses sin, pow and others by the processor; here one without fused operations is played.
TEST_F(Hashes, AreTheSameForEveryVariantOfTheCLibrary) {
    const std::vector<std::string> plain{"GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX2_Usable,-FMA_Usable"};
    const std::vector<std::vector<std::string>> variants{
        {"--method", "rk4"},
        {"--method", "leapfrog-chebyshev"},
        {"--method", "leapfrog-sweep"},
        {"--method", "dumka3"},
        {"--method", "rk4", "--set", "joint.law=palmgren"},
        {"--method", "dopri54", "--tolerance", "1"},
        {"--set", "clamping.driven=5.7 N^0.5*kN^0.5"},
#ifdef CVTFLOW_LAB
        {"--method", "rkc"},
        {"--method", "rock2-s10"},
        {"--method", "fitted-l100-w1"},
        {"--method", "trapezoidal-analytic", "--set", "joint.law=palmgren"},
#endif
    };
    for (const std::vector<std::string>& more : variants) {
        const Words arguments = Words{"run", "tiny", "-o", "none", "--until", "20 us"} +
                                set_all({"start.settling_time=20us", "start.ramp_time=10us", "run.schedule=serial"}) + more;
        const Outcome one = run(arguments), other = run(arguments, plain);
        EXPECT_NE(hash_in(one.out), "none") << one.err;
        EXPECT_EQ(hash_in(other.out), hash_in(one.out)) << testing::PrintToString(more);
    }
}

}  // namespace
}  // namespace cvtflow::tools
