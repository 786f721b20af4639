/// Sweeps of several processes: workers that claim cases, tasks of a job array, and fixed shares that are merged.

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "engine/record/run/part_file.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// Workers: processes that share the cases of one sweep folder.

class Worker : public Sweeps {
protected:
    [[nodiscard]] std::unique_ptr<Child> start(const Words& more = {}) const { return std::make_unique<Child>(line_ + more, folder_); }
    /// Results of the sweep in one process.
    [[nodiscard]] std::string whole_hash() const {
        static std::map<std::string, std::string> known;  // by sweep
        std::string& hash = known[read("sweep.toml")];
        if (hash.empty()) hash = hash_in(run({"batch", "sweep.toml", "-o", "whole"}).out);
        return hash;
    }
    /// Number of cases in the table of a worker.
    [[nodiscard]] std::size_t rows(const std::string& place) const { return rows_of("out/workers/" + place + "/cases.h5"); }
    /// Number of cases in the tables of all workers.
    [[nodiscard]] std::size_t all_rows() const {
        std::size_t sum = 0;
        for (int place = 1; exists(fmt::format("out/workers/{:04}", place)); ++place) sum += rows(fmt::format("{:04}", place));
        return sum;
    }
    /// Workers that die by kill -9 after numbers of cases that are drawn, every second one for good while others live.
    void kill_workers(std::size_t workers, int kills, unsigned seed) const;

    const Words line_{"batch", "sweep.toml", "-o", "out", "--worker", "--threads", "1"};
    static constexpr const char* twenty = "\"6 N*m\", \"9 N*m\", \"12 N*m\", \"15 N*m\", \"18 N*m\"";
};

void Worker::kill_workers(std::size_t workers, int kills, unsigned seed) const {
    std::mt19937 chance(seed);
    std::vector<std::unique_ptr<Child>> alive;
    for (std::size_t k = 0; k < workers; ++k) alive.push_back(start({"--checkpoint-every", "10 ms"}));
    for (int kill = 0; kill < kills; ++kill) {
        const std::size_t which = chance() % alive.size(), until = all_rows() + chance() % 3;
        const int status = alive[which]->ended_when([&] { return all_rows() >= until; }, SIGKILL).status;
        ASSERT_TRUE(status == 128 + SIGKILL || status == 0) << status;
        alive.erase(alive.begin() + static_cast<std::ptrdiff_t>(which));
        if (kill % 2 == 0 || alive.empty()) alive.push_back(start({"--checkpoint-every", "10 ms"}));
    }
    for (const auto& worker : alive) {
        const Outcome outcome = worker->wait();
        EXPECT_EQ(outcome.status, 0) << outcome.err;
    }
}

using DeepWorker = Worker;

TEST_F(DeepWorker, KilledOnesAreReplacedByTheOthersAndTheHashIsThatOfOneProcess) {
    write_sweep(twenty, "80 us");
    const std::string expected = hash_in(run({"batch", "sweep.toml", "-o", "whole"}).out);
    kill_workers(3, 6, 7);
    const Outcome shown = run({"table", "out"});
    EXPECT_EQ(hash_in(shown.out), expected) << shown.err;
    EXPECT_EQ(column("hash"), column("hash", "whole"));
    EXPECT_EQ(column("evaluations"), column("evaluations", "whole"));
}

using NightlyWorker = Worker;

TEST_F(NightlyWorker, OneTwoAndSevenOfThemGiveTheHashOfOneProcessAtManyKills) {
    write_sweep(twenty + std::string(", \"7 N*m\", \"8 N*m\", \"10 N*m\", \"11 N*m\", \"13 N*m\""), "80 us");
    const std::string expected = whole_hash();
    for (const std::size_t workers : {1u, 2u, 7u}) {
        kill_workers(workers, 20, static_cast<unsigned>(workers));
        EXPECT_EQ(hash_in(run({"table", "out"}).out), expected) << workers;
        std::filesystem::remove_all(folder_ / "out");
    }
}

TEST_F(Worker, TakesOverThePlaceOfADeadOneWhileAnotherWorks) {
    write_sweep(twenty, "80 us");
    const auto dies = start();
    ASSERT_TRUE(eventually([&] { return rows("0001") >= 1; }));
    const auto works = start();
    ASSERT_TRUE(eventually([&] { return rows("0002") >= 1; }));
    dies->send(SIGKILL);
    EXPECT_EQ(dies->wait().status, 128 + SIGKILL);
    const Outcome outcome = works->wait();
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("20 ok"));
    EXPECT_EQ(hash_in(outcome.out), whole_hash());
    EXPECT_FALSE(exists("out/workers/0003"));
}

TEST_F(Worker, FolderShowsItsProgressToPeopleAndPrograms) {
    write_sweep(twenty, "80 us");
    const auto worker = start();
    ASSERT_TRUE(eventually([&] { return rows("0001") >= 2; }));
    const auto during = nlohmann::json::parse(run({"info", "out", "--json"}).out);
    EXPECT_EQ(during["running"], 1);
    EXPECT_EQ(during["cases"], 20);
    EXPECT_GE(during["done"], 2);
    EXPECT_LT(during["done"], 20);
    EXPECT_EQ(during["parts"][0]["folder"], "out/workers/0001");
    EXPECT_GE(during["parts"][0]["claimed"], during["parts"][0]["done"]);
    EXPECT_EQ(during["parts"][0]["process"], "running");
    worker->send(SIGKILL);
    EXPECT_EQ(worker->wait().status, 128 + SIGKILL);
    const Outcome after = run({"info", "out"});
    EXPECT_EQ(after.status, 0) << after.err;
    EXPECT_THAT(after.out, HasSubstr("out: a sweep in parts, 0 of 1 running\n"));
    EXPECT_EQ(run(line_).status, 0) << "info has locked or changed something";
    EXPECT_EQ(hash_in(run({"info", "out"}).out), whole_hash());
}

TEST_F(Worker, EndsWithALineOfJson) {
    write_sweep();
    const Outcome outcome = run(line_ + Words{"--json"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    std::istringstream lines(outcome.out);
    nlohmann::json last;
    for (std::string line; std::getline(lines, line);) last = nlohmann::json::parse(line);
    EXPECT_EQ(last["event"], "finished");
    EXPECT_EQ(last["statuses"], (nlohmann::json{{"ok", 12}}));
    EXPECT_EQ(last["done"], 12);
    EXPECT_EQ(last["exit_status"], 0);
    EXPECT_EQ(last["results_hash"], whole_hash());
}

TEST_F(Worker, ThatIsStoppedIsContinuedByAnyCommandForTheFolder) {
    write_sweep(twenty, "80 us");
    const auto first = start({"--grace", "1 us"});
    ASSERT_TRUE(eventually([&] { return rows("0001") >= 2; }));
    first->send(SIGTERM);
    const Outcome stopped = first->wait();
    EXPECT_EQ(stopped.status, 130);
    EXPECT_THAT(stopped.out, HasSubstr("to continue: cvtflow resume out\n"));
    EXPECT_FALSE(exists("out/cases.h5"));
    const std::size_t before = rows("0001");
    EXPECT_EQ(run({"merge", "out"}).status, 5) << "cases are missing";
    const Outcome rest = run({"resume", "out"});
    EXPECT_EQ(rest.status, 0) << rest.err;
    EXPECT_EQ(rows("0001"), 20u);
    EXPECT_LT(before, 20u);
    EXPECT_EQ(hash_in(rest.out), whole_hash());
    const Outcome again = batch();
    EXPECT_EQ(again.status, 0) << again.err;
    EXPECT_THAT(again.out, HasSubstr("; 20 before"));
}

TEST_F(Worker, KeepsItsPlaceWhenACaseTakesItsProcessDown) {
    write_sweep(twenty, "0.2 ms");
    const auto worker = start();
    ASSERT_TRUE(eventually([&] { return rows("0001") >= 1 && read("out/workers/claims").size() >= 2u * 35u; }));
    usleep(50'000);  // into the second case, which takes five times as long
    ASSERT_GT(worker->worker(), 0);
    ASSERT_EQ(kill(worker->worker(), SIGSEGV), 0);
    const Outcome outcome = worker->wait();
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("its cases run again one by one"));
    EXPECT_FALSE(exists("out/workers/0002"));
    EXPECT_EQ(hash_in(outcome.out), whole_hash());
}

TEST_F(Worker, ContinuesStrandsAndChecksThemAsOneProcessDoes) {
    write_sweep("\"6 N*m\", \"9 N*m\", \"12 N*m\"", "40 us", "continuation = \"clamping.driven\"\ncheck = 2\n");
    const Outcome whole = run({"batch", "sweep.toml", "-o", "whole"});
    const auto other = start();
    const Outcome outcome = start()->wait();
    EXPECT_EQ(other->wait().status, 0);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(hash_in(outcome.out), hash_in(whole.out));
    EXPECT_EQ(table().attribute("continuation_error"), table("whole").attribute("continuation_error"));
}

TEST_F(Worker, OfCasesThatAllFailAlikeStops) {
    write_sweep(twenty, "40 us", "[[axes]]\nkey = \"chain.pins\"\nvalues = [4]\n");
    const Outcome outcome = run(line_);
    EXPECT_EQ(outcome.status, 5);
    EXPECT_THAT(outcome.err, HasSubstr("the first 12 cases all failed alike"));
    EXPECT_FALSE(exists("out/cases.h5"));
}

TEST_F(Worker, RefusesAFolderOfAnotherKindOrSweep) {
    write_sweep();
    ASSERT_EQ(run({"batch", "sweep.toml", "-o", "cut", "--shard", "1/3"}).status, 0);
    EXPECT_EQ(run({"batch", "sweep.toml", "-o", "cut", "--worker"}).err,
              "cvtflow: cut/workers/0001: this sweep was begun with --shard 1/3; continue it so\n");
    ASSERT_EQ(run({"batch", "sweep.toml", "-o", "plain"}).status, 0);
    EXPECT_EQ(run({"batch", "sweep.toml", "-o", "plain", "--worker"}).status, 0) << "all cases are done";
    write_sweep("\"6 N*m\"", "20 ms");
    const auto plain = std::make_unique<Child>(Words{"batch", "sweep.toml", "-o", "begun"}, folder_);
    ASSERT_TRUE(eventually([&] { return exists("begun/cases.h5"); }));
    EXPECT_EQ(run({"batch", "sweep.toml", "-o", "begun", "--worker"}).err,
              "cvtflow: begun: this sweep was begun without workers; continue it without --worker\n");
    write_sweep();
    ASSERT_EQ(run(line_).status, 0);
    EXPECT_EQ(run({"batch", "sweep.toml", "-o", "out", "--shard", "1/3"}).err,
              "cvtflow: out: this sweep was begun with --worker; continue it so\n");
    std::filesystem::remove(folder_ / "out/cases.h5");
    write_sweep("\"7 N*m\"");
    const Outcome other = run(line_);
    EXPECT_EQ(other.status, 1);
    EXPECT_THAT(other.err, HasSubstr("out/workers/0001/cases.h5: results of another sweep:\n"));
    for (const char* option : {"--shard=1/2", "--retry=budget", "--dry-run"}) EXPECT_EQ(run(line_ + Words{option}).status, 2) << option;
}

/// Equal machines settle the same state in the same time.
TEST_F(Worker, SettlesByItselfWhereAnotherWritesTheSameSharedStart) {
    write_sweep();
    std::string text = read("sweep.toml");
    write("sweep.toml", text.replace(text.find("\"settle\""), 8, "\"shared\""));
    const std::string whole = whole_hash();
    fs::create_directories(folder_ / "out/states");
    std::vector<engine::Descriptor> written;
    for (const auto& state : fs::directory_iterator(folder_ / "whole/states")) {
        const std::string part = (folder_ / "out/states" / state.path().filename()).string() + ".part";
        written.emplace_back(open(part.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
        ASSERT_TRUE(engine::lock_file(written.back().number(), part));
    }
    ASSERT_FALSE(written.empty());
    const Outcome outcome = run(line_);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(hash_in(outcome.out), whole);
}

TEST_F(Worker, WithDamagedClaimsReportsTheFile) {
    write_sweep();
    ASSERT_EQ(run(line_).status, 0);
    std::filesystem::remove(folder_ / "out/cases.h5");
    const std::string claims = read("out/workers/claims");
    ASSERT_EQ(claims.size(), 12u * 35u);
    write("out/workers/claims", claims.substr(0, 40));  // one and a piece: what a kill leaves
    EXPECT_EQ(hash_in(run(line_).out), whole_hash());
    std::filesystem::remove(folder_ / "out/cases.h5");
    write("out/workers/claims", "       1            5            1\n" + claims.substr(35));  // what a power cut leaves of pages
    EXPECT_EQ(hash_in(run(line_).out), whole_hash());
    std::filesystem::remove(folder_ / "out/cases.h5");
    write("out/workers/claims", "mine\n");
    const Outcome foreign = run(line_);
    EXPECT_EQ(foreign.status, 1);
    EXPECT_EQ(foreign.err, "cvtflow: out/workers/claims: not the claims of a sweep's workers; move it away\n");
    EXPECT_EQ(read("out/workers/claims"), "mine\n");
}

using Merge = Sweeps;

TEST_F(Merge, NamesWhatIsMissing) {
    write_sweep();
    for (const char* shard : {"1/3", "3/3"}) ASSERT_EQ(run({"batch", "sweep.toml", "-o", "cut", "--shard", shard}).status, 0);
    const Outcome refused = run({"merge", "cut"});
    EXPECT_EQ(refused.status, 5);
    EXPECT_EQ(refused.err,
              "cvtflow: cut/workers/0002: this worker has no results\ncvtflow: 4 of 12 cases are missing: 1, 4, 7, 10\n"
              "cvtflow: nothing was written; run the missing shares, or use --partial to join the available ones\n");
    EXPECT_FALSE(exists("cut/cases.h5"));
    EXPECT_EQ(run({"merge", "cut", "--partial"}).status, 5);
    EXPECT_EQ(column("hash", "cut").size(), 8u);
    EXPECT_EQ(table("cut").attribute("missing_cases"), "1 4 7 10");
}

TEST_F(Merge, JoinsFoldersThatWereCopiedTogetherAndThoseOfVersion03ButNotOtherDivisions) {
    write_sweep();
    const std::string whole = hash_in(run({"batch", "sweep.toml", "-o", "whole"}).out);
    for (const char* shard : {"1/2", "2/2"}) {
        const std::string place = std::string("machine ") + shard[0];
        ASSERT_EQ(run({"batch", "sweep.toml", "-o", place, "--shard", shard}).status, 0);
        fs::copy(folder_ / place, folder_ / "cut", fs::copy_options::recursive | fs::copy_options::skip_existing);
    }
    const Outcome joined = run({"merge", "cut"});
    EXPECT_EQ(joined.status, 0) << joined.err;
    EXPECT_EQ(hash_in(joined.out), whole);
    fs::create_directories(folder_ / "old");
    for (const char number : {'1', '2'})
        fs::rename(folder_ / "cut/workers" / ("000" + std::string(1, number)),
                   folder_ / "old" / ("shard-000" + std::string(1, number) + "-of-0002"));
    EXPECT_EQ(hash_in(run({"merge", "old"}).out), whole);
    ASSERT_EQ(run({"batch", "sweep.toml", "-o", "old", "--shard", "3/3"}).status, 0);
    EXPECT_EQ(run({"merge", "old"}).err, "cvtflow: old/workers/0003/cases.h5: rows of 3/3, beside those of 1/2: remove the wrong ones\n");
}

TEST_F(Merge, NamesTheFirstMissingShardsAndCountsTheOthers) {
    write_sweep();
    ASSERT_EQ(run({"batch", "sweep.toml", "-o", "cut", "--shard", "4/12"}).status, 0);
    const Outcome refused = run({"merge", "cut"});
    EXPECT_EQ(refused.status, 5);
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 5 + 1 + 1 + 1)
        << refused.err;  // five shards, how many more, cases, what to do
    EXPECT_THAT(refused.err,
                HasSubstr("cut/workers/0006: this worker has no results\ncvtflow: … and 6 more; 11 workers have no results\n"));
}

}  // namespace
}  // namespace cvtflow::tools
