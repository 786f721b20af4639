/// The commands of cvtflow-lab, among them those about time: profile, granularity, sweep-cost and run-cost (what a sweep and a run cost
/// beside the bare loop of their steps).

#include <gmock/gmock.h>
#include <wordexp.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "bench/study/profile/other_load.hpp"
#include "engine/base/provenance.hpp"
#include "tasks/scene/csv.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using testing::AllOf;
using testing::ContainsRegex;
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

class ProfileCommand : public Program {};

TEST_F(ProfileCommand, MeasuresAndWritesItsFiles) {
    const Outcome outcome = run({"profile",   "tiny",    "--schedules",  "serial:staged,flow:fused,barrier:fused",
                                 "--threads", "2",       "--steps",      "4",
                                 "--rounds",  "1",       "--neighbours", "0,1",
                                 "--wait",    "passive", "--pin",        "-o",
                                 "out",       "--trace", "t.json",       "-q"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("tiny: 4 schedules"), HasSubstr("\nbarrier:fused "), HasSubstr("\nStages by thread:"),
                                   HasSubstr("\nBeside busy neighbours"), HasSubstr("\nWhere sequential time goes (serial:staged)"),
                                   ContainsRegex("\n  serial share +[0-9.]+ % of serial:fused")));
    for (const char* name : {"profile.csv", "stages.csv", "stages.svg", "loads.svg"})
        EXPECT_THAT(outcome.out, HasSubstr(std::string("out/") + name));
    const std::string rows = read("out/profile.csv");
    EXPECT_THAT(rows, AllOf(testing::StartsWith("scene,schedule,"), HasSubstr(",gain_near,rounds_near,gain_far,rounds_far,calibrated,")));
    const std::vector<std::vector<std::string>> lines = tasks::csv_lines(rows);  // a blank one at the end
    ASSERT_EQ(lines.size(), 1u + 4 * 2 + 1) << "of every schedule and load";
    for (std::size_t k = 0; k + 1 < lines.size(); ++k) EXPECT_EQ(lines[k].size(), lines[0].size());
    EXPECT_THAT(read("out/stages.csv"),
                AllOf(testing::StartsWith("scene,schedule,threads,"), HasSubstr("serial:staged,1,1,0,\"Cholesky\"")));
    EXPECT_THAT(read("out/stages.svg"), AllOf(HasSubstr("all forces"), HasSubstr("controller"), HasSubstr("3 flow:fused, 2 threads")));
    EXPECT_GT(nlohmann::json::parse(read("t.json"))["traceEvents"].size(), 20u);
}

TEST_F(ProfileCommand, NamesTheStagesOfAMethodWithCyclesOfItsOwn) {
    const Outcome outcome = run({"profile", "tiny", "--method", "leapfrog-sweep", "--schedules", "serial:staged,flow:fused", "--threads",
                                 "2", "--steps", "4", "--rounds", "1", "--neighbours", "0", "--csv", "-o", "out", "-q"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr(" record, F friction,"));
    EXPECT_THAT(read("out/stages.csv"), HasSubstr("flow:fused,2,2,0,\"friction\""));
}

/// Beside four threads per processor that only spin (no neighbours that the profile starts, which it knows of), a calibration gets a fifth.
TEST_F(ProfileCommand, ReportsACrowdedMachine) {
    const BusyNeighbours neighbours(4 * engine::usable_processors());
    const Outcome outcome = run({"profile", "tiny", "--method", "rk4", "--schedules", "flow:fused", "--threads", "2", "--steps", "4",
                                 "--rounds", "1", "--neighbours", "0", "-q"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, AllOf(ContainsRegex("\n  crowded +calibration got 0\\."), HasSubstr("comparisons are unreliable")));
}

TEST_F(ProfileCommand, ReportsWhatItDoesNotKnow) {
    const Outcome outcome = run({"profile", "tiny", "--schedules", "flaw"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr("there is no executor 'flaw' (did you mean \"flow\"?)"));
}

/// A library that is no runtime of OpenMP leaves the linked one in use, which is a complaint: its figures are of the wrong runtime.
TEST_F(ProfileCommand, RunsOpenMpsRuntimesByWaitPolicyAndReportsOneThatIsNotInUse) {
    write("libother.so", "");
    const Outcome outcome = run({"profile", "tiny", "--runtimes", "--schedules", "flow:fused,omp_fork:fused", "--threads", "2", "--steps",
                                 "4", "--rounds", "1", "--openmp", "libother.so", "-o", "out", "-q"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr("libother.so is not in use: 201511 of libgomp.so"));
    for (const char* policy : {"default", "active", "passive"})
        EXPECT_THAT(outcome.out, ContainsRegex(std::string("\nomp_fork:fused +2 +libgomp.so[.0-9]* +") + policy + " "));
    EXPECT_THAT(outcome.out, AllOf(ContainsRegex("\nflow:fused +2 +[0-9]"), HasSubstr("18 processes by turns")));
    EXPECT_EQ(tasks::csv_lines(read("out/profile.csv")).size(), 1u + 18 * 3 + 1);
    const Outcome missing = run({"profile", "tiny", "--runtimes", "--openmp", "nowhere.so"});
    EXPECT_THAT(missing.err, HasSubstr("nowhere.so: no such file"));
}

class GranularityCommand : public Program {};

TEST_F(GranularityCommand, ComparesExecutorsAndLeavesFiles) {
    const Outcome outcome = run({"granularity", "--executors", "serial,barrier", "--threads", "2", "--tasks", "1,4", "--lengths", "20,1",
                                 "--rounds", "1", "-o", "out", "-q"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("METG(50 %) [us]"), HasSubstr("M = 1"), HasSubstr("M = 4"), HasSubstr("\n  barrier "),
                                   HasSubstr("calibration got"), HasSubstr("oneTBB 20")));
    const std::string csv = read("out/granularity.csv");
    EXPECT_THAT(csv, testing::StartsWith("executor,threads,tasks,length_us,efficiency,"));
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 2 * 2 * 2);
    EXPECT_LT(csv.find("serial,1,1,1,"), csv.find("serial,1,1,20,")) << "lengths ascend";
    EXPECT_THAT(read("out/efficiency.svg"), AllOf(HasSubstr("1 task per level"), HasSubstr("4 tasks per level"), HasSubstr(">barrier<")));
    EXPECT_THAT(read("out/granularity.svg"), HasSubstr("METG(50 %) [us]"));
}

TEST_F(GranularityCommand, ReportsWhatItDoesNotKnow) {
    const Outcome unknown = run({"granularity", "--executors", "flaw"});
    EXPECT_EQ(unknown.status, 1);
    EXPECT_THAT(unknown.err, HasSubstr("there is no executor 'flaw' (did you mean \"flow\"?)"));
    EXPECT_EQ(run({"granularity", "--lengths", "-1"}).status, 2);
    EXPECT_EQ(run({"granularity", "--tasks", "0"}).status, 2);
}

class SweepCostCommand : public Program {};

TEST_F(SweepCostCommand, ComparesTheSweepWithItsBareSteps) {
    write("sweep.toml",
          "[sweep]\nscene = \"tiny\"\n[set]\nrun.until = \"20 us\"\nstart.settling_time = \"10 us\"\nstart.ramp_time = \"5 us\"\n"
          "[[axes]]\nkey = \"load.torque\"\nvalues = [5, 10]\n[outputs]\nscalars = [\"slip mean\"]\n");
    const Outcome outcome = run({"sweep-cost", "sweep.toml", "--rounds", "1", "--threads", "2"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("sweep: 2 cases, "), HasSubstr("\n  bare step loop "), HasSubstr("\n  2 threads ")));
    EXPECT_THAT(outcome.out, ContainsRegex("results hash +[0-9a-f]{16}\n"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "results")) << "it keeps no results";
}

class RunCostCommand : public Program {};

TEST_F(RunCostCommand, ComparesOutputsAndARecordWithBareSteps) {
    const Outcome outcome = run({"run-cost", "tiny", "--until", "20 us", "--rounds", "3", "--set", "run.output_interval=2us", "--set",
                                 "start.settling_time=10us", "--set", "start.ramp_time=5us"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("tiny: outputs every 2 us, medians of 3 rounds\n"),
                                   ContainsRegex("\n  without watch( +[-+0-9.]+)( +[-+0-9.]+ %){3}\n  bare steps +[0-9.]+ *\n"),
                                   ContainsRegex("\n  observed( +[-+0-9.]+)( +[-+0-9.]+ %){3}\n"),
                                   ContainsRegex("\n  recorded( +[-+0-9.]+)( +[-+0-9.]+ %){3}\n")));
    EXPECT_TRUE(std::filesystem::is_empty(folder_)) << "it keeps no record";
}

using testing::StartsWith;

class WorkCommand : public Program {};

TEST_F(WorkCommand, CountsInstructionsByStageAndByThreads) {
    const Outcome outcome =
        run({"work", "tiny", "--method", "rk4", "--step", "50 ns", "--segments", "2", "-q", "-o", "w", "--set", "scene.name=a,b;=1+1"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_THAT(outcome.out, AllOf(StartsWith("a,b;=1+1: work of a step of rk4, 50 ns long, kernels "),
                                   HasSubstr("\n  all forces (fused) "), HasSubstr(" 2 ")));
    EXPECT_THAT(read("w/work.csv"), StartsWith("scene,method,kernels,threads,links,even,segments,instructions,fixed,claimed,"));
    EXPECT_THAT(read("w/stages.csv"), StartsWith("scene,method,kernels,step_s,stage,instructions,share,commit\n\"a,b;=1+1\",rk4,"));
    EXPECT_THAT(read("w/work.svg"), HasSubstr("Speed-up of a,b;=1+1 by counted instructions"));
}

TEST_F(WorkCommand, RefusesMoreSegmentsThanLinks) {
    const Outcome outcome = run({"work", "tiny", "--segments", "1000"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr("--segments 1000: the chain has "));
}

TEST_F(WorkCommand, CountsTheTasksOfALeapfrog) {
    const Outcome outcome = run({"work", "tiny", "--method", "leapfrog-sweep", "--step", "500 ns", "--segments", "1", "-q"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    for (const char* task : {"observe", "record", "friction"}) EXPECT_THAT(outcome.out, HasSubstr(task));
}

TEST_F(WorkCommand, CountsTheTasksOfRigidPins) {
    const Outcome outcome = run({"work", "tiny", "--detail", "rigid", "--method", "auto", "--segments", "1", "-q"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    for (const char* task : {"links", "press", "plates", "rub", "kick"}) EXPECT_THAT(outcome.out, HasSubstr(task));
}

}  // namespace

}  // namespace cvtflow::bench
