/// Cases of a sweep: what is tried before it, where they start, how they are cut, killed and continued, and how they fail.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using testing::Not;
using testing::Pair;
using testing::StartsWith;

using Batch = Sweeps;

TEST_F(Batch, GivesOneHashForEveryNumberOfThreadsAndEveryCut) {
    write_sweep();
    const Outcome one = batch({"--threads", "1"});
    ASSERT_EQ(one.status, 0) << one.err;
    EXPECT_THAT(one.out, HasSubstr("12 ok"));
    for (const char* threads : {"2", "3"})
        EXPECT_EQ(hash_in(run({"batch", "sweep.toml", "-o", std::string("t") + threads, "--threads", threads}).out), hash_in(one.out));
    for (const char* shard : {"1/3", "2/3", "3/3"}) ASSERT_EQ(run({"batch", "sweep.toml", "-o", "cut", "--shard", shard}).status, 0);
    const Outcome merged = run({"merge", "cut"});
    EXPECT_EQ(merged.status, 0) << merged.err;
    EXPECT_EQ(hash_in(merged.out), hash_in(one.out));
    EXPECT_EQ(column("hash", "cut"), column("hash"));
}

TEST_F(Batch, CaseEqualsTheRunOfItsScene) {
    write_sweep();
    ASSERT_EQ(batch().status, 0);
    const Outcome single =
        run({"run", "tiny", "-o", "none", "--settle", "--until", "40 us", "--step", "50 ns", "--set", "start.settling_time=20us", "--set",
             "start.ramp_time=10us", "--set", "load.torque=12 N*m", "--set", "clamping.driven=5 kN"});
    EXPECT_THAT(single.out, HasSubstr("state hash          " + column("hash").at(4)));
}

TEST_F(Batch, LeavesNothingBehindOfACheckpointThatAKillCutShort) {
    write_sweep();
    std::filesystem::create_directories(folder_ / "out" / "checkpoints");
    const std::string state = read(CVTFLOW_SOURCE_DIR "/scenes/states/baseline.h5");
    ASSERT_FALSE(state.empty());
    std::ofstream(folder_ / "out" / "checkpoints" / "case-000000.h5.part") << state.substr(0, state.size() / 2);
    const Outcome outcome = batch();
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_FALSE(exists("out/checkpoints"));
}

/// The process of the sweep dies by SIGSEGV in a case, and again when that runs alone. A case has a record while it runs.
TEST_F(Batch, CrashedCaseIsARowAndTheOthersHaveTheirResults) {
    write_sweep("\"6 N*m\", \"12 N*m\"", "0.4 ms");
    add_records();
    const Outcome undisturbed = run({"batch", "sweep.toml", "-o", "whole"});
    ASSERT_EQ(undisturbed.status, 0) << undisturbed.err;
    Child child({"batch", "sweep.toml", "-o", "out", "--threads", "1"}, folder_);
    const auto part_of = [](long number) { return fmt::format("out/records/case-{:06}.h5.part", number); };
    long crashed = 3;
    const auto is_running = [&] { return crashed < 8 && exists(part_of(crashed)); };
    ASSERT_TRUE(eventually([&] { return is_running(); }));
    const pid_t first = child.worker();
    ASSERT_EQ(kill(first, SIGSTOP), 0);
    while (!is_running()) ASSERT_LT(++crashed, 8) << "stopped between two cases";
    std::filesystem::remove(folder_ / part_of(crashed));  // the next attempt makes it again
    kill(first, SIGSEGV);
    kill(first, SIGCONT);
    ASSERT_TRUE(eventually([&] { return child.worker() != first && is_running(); }));
    ASSERT_EQ(kill(child.worker(), SIGSEGV), 0);
    const Outcome outcome = child.wait();
    EXPECT_EQ(outcome.status, 5);
    EXPECT_THAT(outcome.err,
                HasSubstr(fmt::format("cvtflow: a process of the sweep was ended by SIGSEGV (Segmentation fault); its cases run "
                                      "again one by one: case {0}\ncvtflow: case {0} crashed: SIGSEGV (Segmentation fault)\n",
                                      crashed)));
    EXPECT_THAT(outcome.out, HasSubstr("1 crashed, 7 ok"));
    EXPECT_EQ(column("error").at(crashed), "its process was ended by SIGSEGV (Segmentation fault), even when it ran alone");
    EXPECT_EQ(column("slip_mean").at(crashed), "nan");
    auto hashes = column("hash"), expected = column("hash", "whole");
    hashes.erase(crashed);
    expected.erase(crashed);
    EXPECT_EQ(hashes, expected);
    const Outcome again = batch({"--retry", "crashed"});
    EXPECT_EQ(again.status, 0) << again.err;
    EXPECT_EQ(hash_in(again.out), hash_in(undisturbed.out));
}

TEST_F(Batch, FailingCasesAreRowsWithAStatus) {
    write_sweep("\"6 N*m\", \"12 N*m\"", "5 ms",
                "[budget]\nsteps = 600\n[[axes]]\nkey = \"start.ratio\"\nvalues = [1.0, 0.3]\n[[axes]]\nkey = \"run.step\"\nvalues = [\"50 "
                "ns\", \"10 us\"]\n");
    const Outcome outcome = batch();
    EXPECT_EQ(outcome.status, 5) << outcome.err;
    const auto status = column("status");
    EXPECT_EQ(status.size(), 32u);
    EXPECT_EQ(status.at(0), "budget");
    EXPECT_EQ(status.at(1), "diverged");
    EXPECT_EQ(status.at(2), "bad_parameters");
    EXPECT_THAT(column("error").at(0), StartsWith("the budget of 600 steps (run.max_steps) is used up"));
    EXPECT_EQ(column("slip_mean").at(1), "nan");
    const Outcome shown = run({"table", "out", "--status", "diverged"});
    EXPECT_THAT(shown.out, AllOf(HasSubstr("  diverged  "), testing::Not(HasSubstr("  budget  "))));
    const Outcome again = batch({"--retry", "budget"});
    EXPECT_THAT(again.out, HasSubstr("; 24 before"));
}

TEST_F(Batch, OfAnotherSweepIsRefusedWithTheDifference) {
    write_sweep("\"6 N*m\"");
    ASSERT_EQ(batch().status, 0);
    const auto before = column("hash");
    write_sweep("\"6 N*m\", \"7 N*m\"", "50 us");
    const Outcome outcome = run({"resume", "out"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.err,
              "cvtflow: out/cases.h5: results of another sweep:\n  axes.load.torque = 6 in the table, 6, 7 in the sweep\n  run.until = "
              "4e-5 in the table, 5e-5 in the sweep\n");
    EXPECT_EQ(column("hash"), before);
}

TEST_F(Batch, IntoAFolderThatAnotherWritesIsRefused) {
    write_sweep("\"6 N*m\"", "20 ms");
    Child first({"batch", "sweep.toml", "-o", "out", "-q"}, folder_);
    ASSERT_TRUE(eventually([&] { return exists("out/cases.h5"); }));
    const Outcome second = batch();
    EXPECT_EQ(second.status, 1);
    EXPECT_EQ(second.err, "cvtflow: out: another sweep is writing into it\n");
}

TEST_F(Batch, IntoAFolderThatCannotBeWrittenReportsIt) {
    write_sweep();
    write("file", "");
    EXPECT_EQ(run({"batch", "sweep.toml", "-o", "file"}).err, "cvtflow: file: cannot create: File exists\n");
    EXPECT_EQ(run({"batch", "sweep.toml", "-o", "no/such"}).err, "cvtflow: no/such: cannot create: the folder 'no' does not exist\n");
    EXPECT_EQ(run({"batch", "sweep.toml", "-o", "/proc/here"}).err, "cvtflow: /proc/here: cannot create: No such file or directory\n");
}

TEST_F(Batch, OnAFullDiskKeepsWhatItHasAndContinuesLater) {
    write_sweep(
        "\"1 N*m\", \"2 N*m\", \"3 N*m\", \"4 N*m\", \"5 N*m\", \"6 N*m\", \"7 N*m\", \"8 N*m\", \"9 N*m\", \"10 N*m\", \"11 N*m\", \"12 "
        "N*m\", \"13 N*m\", \"14 N*m\", "
        "\"15 N*m\", \"16 N*m\", \"17 N*m\", \"18 N*m\", \"19 N*m\", \"20 N*m\"",
        "20 us");
    const Outcome full = shell("ulimit -f 120; \"$CVTFLOW\" batch sweep.toml -o out -q --threads 1");
    EXPECT_EQ(full.status, 1) << full.out << full.err;
    EXPECT_THAT(full.err, testing::MatchesRegex("cvtflow: out/cases.h5: cannot write: File too large; [0-9]+ cases are saved\n"));
    const std::size_t saved = column("hash").size();
    EXPECT_GT(saved, 0u);
    EXPECT_LT(saved, 80u);
    const Outcome rest = run({"resume", "out"});
    EXPECT_EQ(rest.status, 0) << rest.err;
    EXPECT_THAT(rest.out, HasSubstr("; " + std::to_string(saved) + " before"));
    EXPECT_EQ(column("hash").size(), 80u);
}

TEST_F(Batch, DistinguishesOtherTablesFromThoseOfSweeps) {
    engine::write_cases(
        (folder_ / "other.h5").string(),
        {engine::RowLayout({{"case", "1", "", engine::ColumnType::integer}, {"status", "1", "", engine::ColumnType::real}}), {}, {}});
    EXPECT_EQ(run({"table", "other.h5"}).err, "cvtflow: other.h5: not the table of a sweep: it has no column 'status' of texts\n");
    EXPECT_EQ(run({"table", "other.h5"}).status, 1);
}

/// The differences in the table are those to a sweep without continuation.
class ContinuedBatch : public Batch {
protected:
    void expect_units_of_its_csv();
    void expect_error_of_continuation() {
        const std::string stated = table().attribute("continuation_error");
        write_sweep("\"6 N*m\", \"12 N*m\"", "40 us");
        ASSERT_EQ(run({"batch", "sweep.toml", "-o", "own"}).status, 0);
        const double own = std::stod(column("slip_mean", "own").at(7)), continued = std::stod(column("slip_mean").at(7));
        ASSERT_NE(own, continued);
        EXPECT_THAT(stated, StartsWith(fmt::format("1 case, at most: slip mean {:.2g} ({:.2g} %), tight_tension max ",
                                                   std::abs(continued - own), 100.0 * std::abs((continued - own) / own))));
    }
};

/// Names of columns are those that scripts read, unless units are requested; a picture of either CSV is the same.
void ContinuedBatch::expect_units_of_its_csv() {
    const std::string plain = run({"table", "out", "--csv"}).out, named = run({"table", "out", "--csv", "--units"}).out;
    EXPECT_THAT(plain, HasSubstr(",load_torque,"));
    EXPECT_THAT(named, AllOf(HasSubstr(",load_torque [N*m],"), HasSubstr(",slip_mean [1],")));
    EXPECT_EQ(plain.substr(plain.find('\n')), named.substr(named.find('\n')));
    EXPECT_THAT(run({"table", "out", "--si"}).out, AllOf(HasSubstr(" clamping_driven [N] "), HasSubstr(" slip_mean ")));
    EXPECT_EQ(run({"table", "out", "--units"}).status, 2);
    EXPECT_EQ(run({"table", "out", "--column", "clamping.driven", "--column", "slip mean"}).out,
              run({"table", "out", "--column", "clamping_driven", "--column", "slip_mean"}).out);
    EXPECT_THAT(run({"table", "out", "--column", "load.torqe"}).err, HasSubstr("has no such column (did you mean \"load_torque\"?)"));
    write("named.csv", named);
    EXPECT_EQ(run({"plot", "named.csv", "--x", "load.torque", "--y", "slip_mean", "-o", "p.svg"}).status, 0);
    EXPECT_THAT(read("p.svg"), AllOf(HasSubstr(">mean slip [%]<"), HasSubstr(">load torque [N·m]<")));
}

TEST_F(ContinuedBatch, SharesASettledStateAndContinuesFromNeighbours) {
    write_sweep("\"6 N*m\", \"12 N*m\"", "40 us", "continuation = \"clamping.driven\"\n");
    ASSERT_EQ(batch({"--threads", "1"}).status, 0);
    const auto start = column("start");
    EXPECT_EQ(start.at(0), "settled");
    EXPECT_EQ(start.at(1), "continued");
    EXPECT_EQ(start.at(4), "settled");
    const Outcome two = run({"batch", "sweep.toml", "-o", "two", "--threads", "2"});
    const std::string text = run({"table", "out"}).out, slip = fmt::format(" {:.6g} ", 100.0 * std::stod(column("slip_mean").at(0)));
    EXPECT_EQ(hash_in(two.out), hash_in(text));
    EXPECT_THAT(text,
                AllOf(HasSubstr(" slip_mean [%] "), HasSubstr(slip), HasSubstr(" efficiency [%] "), HasSubstr("clamping_driven [kN]")));
    expect_units_of_its_csv();
    std::string shared = read("sweep.toml");
    shared.replace(shared.find("\"settle\""), 8, "\"shared\"");
    shared.resize(shared.find("continuation"));
    write("sweep.toml", shared);
    ASSERT_EQ(run({"batch", "sweep.toml", "-o", "shared"}).status, 0);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_ / "shared/states"), {}), 1);
    EXPECT_EQ(column("start", "shared").at(3), "shared");
    expect_error_of_continuation();
}

TEST_F(ContinuedBatch, GivesTheSameTableAfterAStopInACase) {
    write_sweep("\"6 N*m\"", "1 ms", "continuation = \"clamping.driven\"\ncheck = 0\n");
    const Outcome whole = run({"batch", "sweep.toml", "-o", "whole"});
    Child child({"batch", "sweep.toml", "-o", "out", "--grace", "1 us", "--checkpoint-every", "10 ms"}, folder_);
    ASSERT_EQ(child.ended_when([&] { return exists("out/checkpoints/case-000001.h5"); }, SIGTERM).status, 130);
    ASSERT_TRUE(exists("out/checkpoints/case-000001.h5"));
    EXPECT_EQ(hash_in(run({"resume", "out"}).out), hash_in(whole.out));
    EXPECT_EQ(column("start"), column("start", "whole"));
}

/// Cases that start from two lines, run by threads, shards and sessions.
TEST_F(Batch, OfSteadyLinesGivesOneHashForThreadsShardsAndStops) {
    write("sweep.toml",
          "[sweep]\nscene = \"control\"\ndetail = \"rigid\"\n[set]\nstart.state = \"\"\nstart.settling_time = \"10 ms\"\nrun.until = "
          "\"steady\"\nrun.steady = \"5 %\"\ncontrol.gains = \"found\"\ncontrol.when_steady = \"hold\"\nrun.output_interval = \"200 us\"\n"
          "[[axes]]\nkey = \"drive.speed\"\nvalues = [\"4000 rpm\", \"4200 rpm\"]\n[[axes]]\nkey = \"clamping.driven\"\nvalues = [\"19 "
          "kN\", \"20 kN\"]\n[[axes]]\nkey = \"load.torque\"\nvalues = [\"60 N*m\", \"70 N*m\", \"80 N*m\"]\n[outputs]\nscalars = [\"slip "
          "mean\", \"ratio mean\"]\n[start]\nmode = \"settle\"\ncontinuation = \"load.torque\"\nacross = \"clamping.driven\"\ncheck = "
          "0\n[steady]\nconfirm = 0\n");
    const Outcome one = batch({"--threads", "1"});
    ASSERT_EQ(one.status, 0) << one.err << one.out;
    const auto starts = column("start");
    for (const long number : {2L, 4L, 5L, 8L, 10L, 11L}) EXPECT_EQ(starts.at(number), "extrapolated") << number;
    EXPECT_FALSE(exists("out/continuation"));
    EXPECT_EQ(hash_in(run({"batch", "sweep.toml", "-o", "two", "--threads", "2"}).out), hash_in(one.out));
    for (const char* shard : {"1/2", "2/2"}) ASSERT_EQ(run({"batch", "sweep.toml", "-o", "cut", "--shard", shard}).status, 0);
    EXPECT_EQ(hash_in(run({"merge", "cut"}).out), hash_in(one.out));
    Child child({"batch", "sweep.toml", "-o", "stopped", "--threads", "1", "--grace", "1 us", "--checkpoint-every", "10 ms"}, folder_);
    ASSERT_EQ(child.ended_when([&] { return exists("stopped/checkpoints/case-000004.h5"); }, SIGTERM).status, 130);
    EXPECT_EQ(hash_in(run({"resume", "stopped"}).out), hash_in(one.out));
    EXPECT_EQ(column("start", "stopped"), starts);
}

TEST_F(Batch, RecordsCasesIfAsked) {
    write_sweep("\"6 N*m\"");
    add_records();
    ASSERT_EQ(batch().status, 0);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_ / "out/records"), {}), 4);
    EXPECT_THAT(run({"info", "out/records/case-000002.h5"}).out, HasSubstr("\n  status              finished\n"));
}

using BatchDryRun = Sweeps;

/// 12 um are reached 1.6 us after the settling: a case of 0.2 us knows nothing of that.
TEST_F(BatchDryRun, MeasuresNoStepBeyondACasesEnd) {
    write_sweep("\"12 N*m\"", "0.2 us", "");
    std::string sweep = read("sweep.toml");
    sweep.replace(sweep.find("start.settling_time = \"20 us\"\nstart.ramp_time = \"10 us\""), 0,
                  "tip.deepest = \"12 um\"\nrun.output_interval = \"50 ns\"\nrun.state_interval = \"100 ns\"\n");
    sweep.replace(sweep.find("\"ratio at 20 us\""), 16, "\"ratio at 0.2 us\"");
    write("sweep.toml", sweep);
    const Outcome dry = batch({"--dry-run"});
    EXPECT_THAT(dry.out, HasSubstr("(measured on 3 cases, ")) << dry.err;
    EXPECT_EQ(batch().status, 0);
}

TEST_F(BatchDryRun, ReportsWhyNoCaseCouldBeTried) {
    write_sweep("\"12 N*m\"", "40 us", "");
    std::string sweep = read("sweep.toml");
    sweep.replace(sweep.find("run.until"), 0, "run.method = \"leapfrog-chebyshev\"\ndetail.pins = \"rigid\"\n");
    write("sweep.toml", sweep);
    const Outcome dry = batch({"--dry-run"});
    EXPECT_THAT(dry.out, HasSubstr("estimate            none: every case has inconsistent parameters"));
    EXPECT_EQ(dry.status, 5) << "nothing can run";
}

TEST_F(BatchDryRun, PrintsCasesAndAnEstimate) {
    write_sweep();
    const Outcome outcome = batch({"--dry-run"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.out, AllOf(StartsWith("sweep: 12 cases\n"), HasSubstr("load.torque [N*m]"),
                                   testing::ContainsRegex("  estimate            [a-z0-9. ]+ s on one thread, "),
                                   testing::ContainsRegex("  disk                [0-9.]+ kB of results")));
    EXPECT_FALSE(exists("out"));
}

// Start states of the cases of a sweep.

class BatchStart : public Sweeps {
protected:
    /// Three cases of baseline, whose settled state is of level `fine`.
    void write_of_baseline(const std::string& set, const std::string& more = "") const {
        write("sweep.toml", "[sweep]\nscene = \"baseline\"\n" + more +
                                "[set]\nrun.until = \"20 us\"\nrun.step = \"1 us\"\nstart.ramp_time = \"20 us\"\nstart.settling_time = \"" +
                                set +
                                "\n[[axes]]\nkey = \"load.torque\"\nvalues = [\"10 N*m\", \"20 N*m\", \"30 N*m\"]\n[outputs]\nscalars = "
                                "[\"ratio mean\"]\n");
    }
};

TEST_F(BatchStart, CasesOfAnotherLevelOfDetailThanTheScenesStateSettleAsRunsDo) {
    write_of_baseline("20 us\"\n", "detail = \"rigid\"\n");
    const Outcome outcome = batch();
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    EXPECT_THAT(column("status"), Each(Pair(testing::_, "ok")));
    EXPECT_THAT(column("start"), Each(Pair(testing::_, "geometric")));
    const Outcome single = run({"run", "baseline", "-o", "none", "--detail", "rigid", "--until", "20 us", "--step", "1 us", "--set",
                                "start.settling_time=20us", "--set", "start.ramp_time=20us", "--set", "load.torque=20 N*m"});
    EXPECT_THAT(single.out, HasSubstr("state hash          " + column("hash").at(1)));
}

TEST_F(BatchStart, CasesOfOtherPulleysThanTheScenesStateSettle) {
    write_of_baseline("20 us\"\ndetail.pulleys = \"rigid\"\n");
    const Outcome outcome = batch();
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    EXPECT_THAT(column("start"), Each(Pair(testing::_, "geometric")));
}

TEST_F(BatchStart, CasesThatMustSettleButHaveNoTimeForItSayWhy) {
    write_of_baseline("0 s\"\n", "detail = \"rigid\"\n");
    EXPECT_EQ(batch().status, 5);
    EXPECT_THAT(column("error"), Each(Pair(testing::_, HasSubstr("start.settling_time = 0 leaves no time to settle"))));
}

TEST_F(BatchStart, NamesTheCommandOfAFileOfTheOtherKind) {
    write("t.toml", "[scene]\nname = \"t\"\n\n[chain]\npins = 24\n\n[tips]\nx = 1\n");
    write_sweep();
    EXPECT_EQ(run({"batch", "t.toml"}).err, "cvtflow: t.toml:4:2: chain: this is a scene, not a sweep; to run it: cvtflow run t.toml\n");
    EXPECT_EQ(run({"run", "sweep.toml"}).err,
              "cvtflow: sweep.toml:1:2: sweep: this is a sweep, not a scene; to run it: cvtflow batch sweep.toml\n");
    EXPECT_EQ(run({"batch", "tiny"}).err,
              "cvtflow: no sweep 'tiny'; ready sweeps: operating_map, slip_efficiency, steady_map; to run the scene of that name: "
              "cvtflow run tiny\n");
    EXPECT_EQ(run({"run", "slip_efficiency"}).err,
              "cvtflow: 'slip_efficiency' is a ready sweep, not a scene; to run it: cvtflow batch slip_efficiency\n");
}

// Reports of a sweep on cases that fail, and when it stops.

class BatchFailures : public Sweeps {
protected:
    /// 24 cases, of which none can begin: the chain does not fit the sheaves at that ratio.
    void write_hopeless() const {
        write_sweep("\"1 N*m\", \"2 N*m\", \"3 N*m\", \"4 N*m\", \"5 N*m\", \"6 N*m\"", "40 us",
                    "[[axes]]\nkey = \"start.ratio\"\nvalues = [0.3]\n");
    }
};

TEST_F(BatchFailures, ThatAreAlikeInTheFirstDozenCasesStopTheSweepWithTheirMessage) {
    write_hopeless();
    const Outcome outcome = batch({"--threads", "1"});
    EXPECT_EQ(outcome.status, 5);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("sweep: the first 12 cases all failed alike: bad_parameters: chain.pins: "),
                                   HasSubstr("; --keep-going runs the others\n")));
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("sweep: stopped after 12 of 24 cases; to continue: cvtflow resume out --keep-going\n"),
                                   HasSubstr("failed              12 of 12 cases (100 %)\n"), HasSubstr("12 bad_parameters: chain.pins: "),
                                   HasSubstr("(first: case 0)")));
    EXPECT_EQ(column("status").size(), 12u);
    const Outcome all = run({"resume", "out", "--keep-going"});
    EXPECT_EQ(all.status, 5) << all.err;
    EXPECT_THAT(all.out, AllOf(HasSubstr("sweep: finished\n"), HasSubstr("failed              24 of 24 cases (100 %)\n")));
    EXPECT_EQ(run({"batch", "sweep.toml", "-o", "whole", "--keep-going"}).out.find("results hash") == std::string::npos, false);
    EXPECT_EQ(column("status", "whole").size(), 24u);
}

TEST_F(BatchFailures, ThatAreAlikeDoNotStopASweepInWhichACaseHasEndedWell) {
    write_sweep("\"1 N*m\", \"2 N*m\", \"3 N*m\", \"4 N*m\", \"5 N*m\", \"6 N*m\"", "40 us",
                "[[axes]]\nkey = \"start.ratio\"\nvalues = [1.0, 0.3, 0.3, 0.3]\n");
    const Outcome outcome = batch({"--threads", "1"});
    EXPECT_EQ(outcome.status, 5);
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("sweep: finished\n"), HasSubstr("failed              72 of 96 cases (75 %)\n"),
                                   HasSubstr("72 bad_parameters: chain.pins: "), HasSubstr("(first: case 1)")));
}

TEST_F(BatchFailures, FailWhatJoinsThem) {
    write_hopeless();
    for (const char* shard : {"1/2", "2/2"})
        EXPECT_EQ(run({"batch", "sweep.toml", "-o", "cut", "--keep-going", "--shard", shard}).status, 5);
    const Outcome merged = run({"merge", "cut"});
    EXPECT_EQ(merged.status, 5);
    EXPECT_THAT(merged.out, HasSubstr("failed              24 of 24 cases (100 %)\n"));
    EXPECT_THAT(run({"info", "cut"}).out, HasSubstr("failed              24 of 24 cases (100 %)\n"));
}

TEST_F(BatchFailures, AreDistinguishedFromNotesWhichTheSummaryCounts) {
    write_sweep();
    const Outcome outcome = batch();
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const auto notes = column("notes");
    const auto unsteady =
        std::count_if(notes.begin(), notes.end(), [](const auto& row) { return row.second.find("unsteady") != std::string::npos; });
    ASSERT_GT(unsteady, 0) << "20 us of a settling machine";
    EXPECT_THAT(outcome.out, AllOf(HasSubstr(fmt::format("unsteady {} of 12", unsteady)), Not(HasSubstr("  failed  "))));
}

}  // namespace
}  // namespace cvtflow::tools
