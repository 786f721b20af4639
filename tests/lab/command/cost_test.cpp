/// The commands about time: profile, granularity, sweep-cost and run-cost (what a sweep and a run cost beside the bare loop of their
/// steps).

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "bench/study/profile/other_load.hpp"
#include "engine/base/provenance.hpp"
#include "tasks/scene/csv.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;

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
