#include <gmock/gmock.h>
#include <wordexp.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tasks/scene/parameter_table.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class LabCommands : public Program {};

TEST_F(LabCommands, HaveAHelpEach) {
    const Words names = commands_of(CVTFLOW_LAB);
    EXPECT_GE(names.size(), 10u);
    for (const std::string& name : names) {
        const Outcome help = run({laboratory, name, "--help"});
        EXPECT_EQ(help.status, 0) << name;
        EXPECT_THAT(help.out, HasSubstr("Usage: cvtflow-lab " + name)) << name;
    }
}

/// Settings are pasted into a shell: values contain blanks, brackets and commas.
TEST_F(LabCommands, LotteryPrintsSettingsAsWordsOfAShell) {
    std::istringstream lines(run({"lottery", "--settings", "--machines", "40"}).out);
    int settings = 0;
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("--set")) continue;
        wordexp_t words{};
        ASSERT_EQ(wordexp(line.c_str(), &words, WRDE_NOCMD | WRDE_UNDEF), 0) << line;
        EXPECT_EQ(words.we_wordc, 2u) << line;
        wordfree(&words);
        ++settings;
    }
    EXPECT_GT(settings, 400);
}

/// One machine, some pin periods.
TEST_F(LabCommands, LotteryComparesNotesWithLongerRuns) {
    const Outcome outcome =
        run({"lottery", "--detail", "rigid", "--machines", "1", "--settling", "0.002", "--duration", "0.002", "--longer", "2", "--csv"});
    EXPECT_THAT(outcome.out, StartsWith("machine,status,later,notes,quantity,off,wall\n0,finished,,"));
    EXPECT_THAT(outcome.err,
                HasSubstr("1 machines, 2 ms compared with 4: 0 without a note (unsteady, uncertain) are right to 1 %, 0 are off"));
    EXPECT_EQ(outcome.status, 0) << "eight pin periods of a start that moves have a note";
}

TEST_F(LabCommands, LocalErrorShowsTheOrder) {
    const Outcome outcome = run({"local-error", "tiny", "--settle", "--set", "start.settling_time=1ms", "--set", "start.ramp_time=0.5ms",
                                 "--friction", "both", "--steps", "80ns,160ns"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, StartsWith("tiny: error of one step of rk4 (order 4: slope 5 where the solution is smooth), phases held, "));
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("\npiecewise friction\n"), HasSubstr("\nsmoothed friction\n"), HasSubstr("\n  160 ns "),
                                   HasSubstr("\n   80 ns ")));
}

TEST_F(LabCommands, LocalErrorOfSeveralMethodsIsATableAndAPictureEach) {
    const Outcome outcome = run(
        std::vector<std::string>{"local-error", "tiny", "--methods", "rk4,heun", "--steps", "80ns,160ns", "-o", "errors"} + brief_settling);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out,
                AllOf(HasSubstr("tiny: error of one step of rk4 (order 4"), HasSubstr("\ntiny: error of one step of heun (order 2")));
    EXPECT_THAT(outcome.out, HasSubstr("\n  written             errors/local-error.csv, errors/local-error-axial-force-piecewise.svg, "
                                       "errors/local-error-velocities-piecewise.svg\n"));
    EXPECT_THAT(read("errors/local-error.csv"),
                AllOf(StartsWith("method,friction,step,positions,velocities,axial_force,tension\nrk4,piecewise,1.6"),
                      HasSubstr("\nheun,piecewise,8")));
    EXPECT_THAT(read("errors/local-error-velocities-piecewise.svg"), AllOf(HasSubstr(">rk4</text>"), HasSubstr(">heun</text>")));
}

TEST_F(LabCommands, CompareShowsThePinsForceByMethod) {
    const Outcome outcome = run(std::vector<std::string>{"compare", "tiny", "rk4@50ns", "dumka3-p2@1us", "--duration", "24us",
                                                         "--reference", "rk4@25ns", "--rounds", "1", "--pin", "0", "-q", "-o", "c"} +
                                brief_settling);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, StartsWith("tiny: errors against rk4@25ns over 24us from the settled start, "));
    EXPECT_THAT(outcome.out, testing::ContainsRegex("\n  rk4@50ns +49\\.9 ns +[0-9 ]+ +[0-9.e+]+ +[0-9.e+]+ +1\\.00 +1\\.00 "));
    EXPECT_THAT(read("c/compare_tiny.csv"), StartsWith("method,mean_step,steps,evaluations,transitions,"));
    EXPECT_THAT(read("c/pin-force.csv"), StartsWith("time,reference,rk4@50ns,dumka3-p2@1us\n1.2e-05,"));
    const auto json = nlohmann::json::parse(read("c/compare_tiny.json"));
    EXPECT_EQ(json["choices"].size(), 2u);
    EXPECT_EQ(json["pin"], 0);
    EXPECT_EQ(double(json["choices"][0]["error_pin"]), 0.0) << "pin 0 touches no sheave";
    EXPECT_THAT(read("c/pin-force.svg"), HasSubstr(">reference</text>"));
}

TEST_F(LabCommands, CompareFindsThePinThatEntersFirst) {
    // 24 pins pass within 2 ms and more, so one enters within a tenth of that or so; it carries no force before.
    const Outcome outcome = run(std::vector<std::string>{"compare", "tiny", "dumka3-p2@2us", "--reference", "rk4@50ns", "--duration",
                                                         "1.2ms", "--rounds", "1", "--pin", "first", "-q"} +
                                brief_settling);
    EXPECT_THAT(outcome.out, testing::ContainsRegex("\n  pin +[0-9]+, enters the driving sheaves at [0-9.]+ [num]s\n"));
    EXPECT_THAT(outcome.err, testing::Not(HasSubstr("first")));
}

// The classical method is stable to 53 ns there, and at 200 ns no fault comes of it.
const std::vector<std::string> candidates{"rk4@200ns", "leapfrog-sweep@auto", "--reference", "rk4@25ns", "-o", "out"};

TEST_F(LabCommands, CompareMarksWhatIsUnreliable) {
    const Outcome outcome =
        run(std::vector<std::string>{"compare", "control", "-q", "--duration", "120us", "--rounds", "1", "--pin", "first"} + candidates);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.err, testing::StartsWith("cvtflow-lab: rk4@200ns: unreliable: the residual of the energy balance is "));
    EXPECT_THAT(outcome.out, testing::ContainsRegex("\n  rk4@200ns .* unreliable\n"));
    EXPECT_THAT(outcome.out, testing::ContainsRegex("\n  leapfrog-sweep@auto +4 us .* finished\n"));
    EXPECT_THAT(outcome.out,
                testing::ContainsRegex("\n  too short +120 us are 0\\.17 pin periods: means of slip and efficiency require 16 "));
    EXPECT_THAT(read("out/compare_control.csv"),
                AllOf(HasSubstr(",status,residual,error_ratio,pin_periods,long_enough,mean_slip,efficiency\n"),
                      testing::ContainsRegex("\nrk4@200ns,.*,unreliable,"),
                      testing::ContainsRegex("\nleapfrog-sweep@auto,.*,finished,[^,]*,[^,]*,0\\.1[0-9]*,0,")));
    const auto json = nlohmann::json::parse(read("out/compare_control.json"));
    EXPECT_EQ(json["choices"][0]["status"], "unreliable");
    EXPECT_GT(double(json["choices"][0]["error_ratio"]), 1.0);
    EXPECT_EQ(json["reference_watch"]["long_enough"], false);
}

TEST_F(LabCommands, AutomaticStepsAreChoicesWhereverAMethodAndItsStepAreRead) {
    const Outcome compare = run({"compare", "tiny", "leapfrog-sweep@auto", "rk4@auto", "--reference", "rk4@auto", "--rounds", "1", "--set",
                                 "start.settling_time=20us", "--set", "start.ramp_time=10us"});
    EXPECT_EQ(compare.status, 0) << compare.err;
    EXPECT_THAT(compare.out, testing::ContainsRegex("\n  rk4@auto .* 0\\.0e\\+00 ")) << "the reference itself";
    EXPECT_EQ(run({"compare", "tiny", "rk4@Auto", "-q"}).err, "cvtflow-lab: rk4@Auto: 'Auto' is not a time above 0, such as 40ns\n");
}

TEST_F(LabCommands, DotDrawsATaskPerSegment) {
    const std::string text = run({"dot", "tiny", "--segments", "3"}).out;
    EXPECT_THAT(text, AllOf(StartsWith("digraph cycle_0 {\n    rankdir=LR;\n"), HasSubstr("    { rank=same; t"),
                            HasSubstr(" [label=\"force[2]\"]"), testing::Not(HasSubstr("force[3]"))));
}

TEST_F(LabCommands, DotDrawsTheCyclesOfAMethodByTheirTasks) {
    const std::string kick = run({"dot", "tiny", "--segments", "3", "--method", "leapfrog-sweep", "--cycle", "friction"}).out;
    EXPECT_THAT(kick, AllOf(StartsWith("digraph "), HasSubstr("friction[2]"), testing::Not(HasSubstr("record"))));
    const std::string solve = run({"dot", "tiny", "--method", "trapezoidal-full", "--cycle", "backward"}).out;
    EXPECT_THAT(solve, AllOf(HasSubstr("label=\"forward[0]\""), HasSubstr("label=\"join\""),
                             testing::ContainsRegex("\n    t[0-9]+ -> t[0-9]+;\n")));
}

class BeltCommand : public Program {};

TEST_F(BeltCommand, WritesPointsAndArcs) {
    const Outcome outcome = run({"belt", "control", "--ratios", "1,0.7", "--loads", "0.3,1.2", "-o", "b"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("friction cannot carry this difference of tensions"));
    EXPECT_THAT(read("b/belt.csv"), StartsWith("ratio,load,torque_Nm,growth_m_per_s,status,"));
    EXPECT_THAT(read("b/belt.csv"), HasSubstr("\n0.7,1.2,"));
    EXPECT_THAT(read("b/arcs.csv"), StartsWith("ratio,load,pulley,angle,tension_N,"));
}

/// Each part that is left out changes the result, and so do pins that vibrate.
TEST_F(BeltCommand, LeavesPartsOut) {
    const auto table = [this](const std::vector<std::string>& words, const std::string& folder) {
        const std::vector<std::string> belt{"belt", "baseline", "--ratios", "0.7", "--csv", "-o", folder};
        EXPECT_EQ(run(belt + words).status, 0) << folder;
        return read(folder + "/belt.csv");
    };
    const std::string whole = table({}, "whole");
    for (const char* part : {"tilt", "yield", "stretch", "crown"}) EXPECT_NE(table({"--without", part}, part), whole) << part;
    EXPECT_NE(table({"--vibration", "0.01"}, "vibration"), whole);
}

TEST_F(BeltCommand, RefusesWhatItDoesNotKnow) {
    EXPECT_EQ(run({"belt", "baseline", "--without", "nothing"}).status, 2);
    const Outcome ring = run({"belt", "free_ring"});
    EXPECT_EQ(ring.status, 2);
    EXPECT_THAT(ring.err, HasSubstr("free_ring has no pulleys"));
}

}  // namespace

}  // namespace cvtflow::bench
