/// Systems that refuse: calls that fail, one at a time, and threads that are not given.

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include "engine/executor/catalogue.hpp"
#include "tests/tools/program_fixture.hpp"

#ifdef CVTFLOW_FAULTS  // not under sanitizers, whose runtime has to be loaded before any other library

namespace cvtflow::tools {
namespace {

using testing::HasSubstr;

// Calls of the system that fail, one at a time: every command ends by itself, with a status that it has and a message, and what was there
// stays.

/// A command line, short enough to be run with every call.
struct Order {
    std::string name;
    Words arguments;
    friend void PrintTo(const Order& order, std::ostream* out) { *out << order.name; }  // in the names of tests
};

const Words briefly{
    "--until", "20 us", "--set", "start.settling_time=20us", "--set", "start.ramp_time=10us", "--set", "run.schedule=serial"};

Words with_brief(Words words) { return std::move(words) + briefly; }

/// Commands of the laboratory, from the existing settled state.
[[maybe_unused]] Words measured(Words words) { return std::move(words) + Words{"--set", "start.state=given.h5"}; }

/// Commands without an order, and why.
const std::map<std::string, std::string> left_out{
    {"extremes", "its smallest group takes 6 s of processor time; it reads and writes no file"},
    {"executors", "lists what is compiled in; reads and writes no file"},
    {"granularity", "measured in rounds of every executor; writes tables as profile does"},
    {"sweep-cost", "runs sweeps by turns as batch does, in a folder that it removes"},
    {"run-cost", "runs a scene by turns as run does, in a folder that it removes"},
    {"work", "counts every instruction of a step: a second and more; writes tables as profile does"},
    {"reduce", "a minute of processor time; it runs batch and run, and Python writes, which the faults do not reach"},
    {"clamp", "likewise"},
    {"tune", "10 s of processor time, measured in rounds; writes tables as compare does, and a scene as settle does a state"}};

const std::vector<Order>& orders() {
    static const std::vector<Order> all{
        {"run", with_brief({"run", "tiny", "-o", "new.h5", "--checkpoint-every", "1 ms"})},
        {"resume", {"resume", "old.checkpoint.h5", "--set", "run.max_steps=0"}},
        {"batch", {"batch", "sweep.toml", "-o", "new", "--threads", "1"}},
        {"table", {"table", "old", "--csv"}},
        {"info", {"info", "record.h5"}},
        {"rainflow", {"table", "record.h5", "--rainflow", "tight_tension"}},
        {"export", {"export", "record.h5", "--vtk", "new.pvd"}},
        {"check", {"check", "tiny"}},
        {"settle", {"settle", "tiny", "-o", "state.h5", "--time", "20us", "--set", "start.ramp_time=10us"}},
        {"merge", {"merge", "shards"}},
        {"diff", {"diff", "old", "old"}},
        {"list", {"list", "scenes"}},
        {"schema", {"schema"}},
        {"plot", {"plot", "record.h5", "-o", "new.svg"}},
        {"report", {"report", "record.h5", "-o", "new.html"}},
        {"export-fmu", {"export-fmu", "tiny", "-o", "new.fmu"}},
        {"explain", {"explain", "run.method"}},
#ifdef CVTFLOW_LAB
        {"method", {"method", "rk4"}},
        {"dot", {"dot", "tiny"}},
        {"belt", {"belt", "tiny", "-o", "new"}},
        {"noise", {"noise", "tiny", "--detail", "rigid", "--random", "1", "--candidates", "1", "--checked", "1", "-o", "new"}},
        {"lottery", {"lottery", "--machines", "1", "--settings"}},
        {"stability", {"stability", "rk4", "-q"}},
        {"compare", measured({"compare", "tiny", "rk4@100ns", "trapezoidal-full@100ns", "--reference", "rk4@50ns", "--duration", "2us",
                              "--interval", "1us", "--rounds", "1", "--pin", "0", "--newton", "-q"})},
        {"local-error", measured({"local-error", "tiny", "--methods", "rk4", "--steps", "200ns,100ns"})},
        {"spectrum", measured({"spectrum", "tiny", "--extremal", "-q"})},
        // Two threads on any machine: oneTBB ends the process where one of many is refused after our trial (docs/security.md, Threads).
        {"profile", measured({"profile", "tiny", "--step", "100ns", "--schedules", "serial:staged", "--threads", "1,2", "--steps", "2",
                              "--rounds", "1", "--neighbours", "0", "--round-ms", "1", "-q"})},
#endif
    };
    return all;
}

constexpr const char* families[] = {"open", "read", "write", "fsync", "rename", "truncate", "lock", "mmap", "pthread_create"};

class Faults : public Sweeps {
protected:
    void SetUp() override {
        made_once("files for every command", [this] { make(); });
        kept_ = {"record.h5", "given.h5", "sweep.toml", "old/cases.h5", "shards/workers/0001/cases.h5"};
        for (const std::string& name : kept_) contents_[name] = read(name);
        checkpoint_ = read("old.checkpoint.h5");
        part_ = read("old.h5");
    }

    void make() const {
        ASSERT_EQ(run(with_brief({"run", "tiny", "-q", "-o", "record.h5"})).status, 0);
        ASSERT_EQ(run(with_brief({"run", "tiny", "-q", "-o", "old.h5", "--checkpoint-every", "1 h", "--set", "run.max_steps=50"})).status,
                  4);
        ASSERT_EQ(run({"settle", "tiny", "-q", "-o", "given.h5", "--time", "20us", "--set", "start.ramp_time=10us"}).status, 0);
        write_sweep("\"6 N*m\"", "20 us");
        ASSERT_EQ(run({"batch", "sweep.toml", "-q", "-o", "old"}).status, 0);
        for (const char* shard : {"1/2", "2/2"}) ASSERT_EQ(run({"batch", "sweep.toml", "-q", "-o", "shards", "--shard", shard}).status, 0);
    }

    [[nodiscard]] static std::vector<std::string> environment(const std::string& family, long n, bool lasting) {
        return {preload(CVTFLOW_FAULTS), "CVTFLOW_FAULT=" + family + ":" + std::to_string(n) + (lasting ? "+" : ""),
                "CVTFLOW_FAULT_COUNTS=counts"};
    }

    /// Calls of each family in an undisturbed run: the most of all its processes, since one that is forked counts on.
    [[nodiscard]] std::map<std::string, long> calls_of(const Order& order) {
        clean();
        (void)run(order.arguments, {preload(CVTFLOW_FAULTS), "CVTFLOW_FAULT_COUNTS=counts"});
        std::map<std::string, long> calls;
        std::istringstream lines(read("counts"));
        std::string name;
        for (long made = 0, failed = 0; lines >> name >> made >> failed;) calls[name] = std::max(calls[name], made);
        return calls;
    }

    /// Back to where every order begins.
    void clean() const {
        for (const char* name : {"new.h5", "new.h5.part", "new.pvd", "new.pvd.part", "new.checkpoint.h5", "new.svg", "new.html", "new.fmu",
                                 "new", "state.h5", "state.h5.part", "shards/cases.h5", "counts", "old.h5.part", "old.h5.before"}) {
            std::error_code absent;
            std::filesystem::remove_all(folder_ / name, absent);
        }
        write("old.checkpoint.h5", checkpoint_);
        write("old.h5", part_);
    }

    void expect_stated_outcome(const Order& order, const std::string& family, long n, bool lasting) {
        clean();
        const Outcome outcome = run(order.arguments, environment(family, n, lasting));
        const std::string where = order.name + ", " + family + ":" + std::to_string(n) + (lasting ? "+" : "") + "\n" + outcome.err;
        ++endings_[family + ": " + std::to_string(outcome.status)];
        if (family == "malloc") return expect_untouched(where);  // libhdf5 and the loader may end the process there: docs/security.md
        EXPECT_TRUE(std::set<int>({0, 1, 2, 3, 4, 5, 130}).contains(outcome.status)) << outcome.status << ": " << where;
        // Where not even stderr can be written, the status has to tell.
        const bool silent = lasting && family == "write";
        EXPECT_TRUE(outcome.status == 0 || silent || !outcome.err.empty()) << where;
        expect_untouched(where);
        if (order.name == "resume" && outcome.status != 0) expect_still_resumable(where);
    }

    /// Earlier files, and files with their final name.
    void expect_untouched(const std::string& where) {
        for (const std::string& name : kept_) EXPECT_TRUE(read(name) == contents_[name]) << name << " is not what it was: " << where;
        for (const char* name : {"new.h5", "state.h5"})
            EXPECT_TRUE(!exists(name) || run({"info", name}).status == 0) << name << " has its name and is none: " << where;
    }

    void expect_still_resumable(const std::string& where) const {
        const Outcome again = run({"resume", "old.checkpoint.h5", "-q", "--set", "run.max_steps=0"});
        // Equal bits (Resume.*) or a clear refusal: HDF5 does not open what was lost in the moment in which a record is completed.
        EXPECT_TRUE(again.status == 0 || (again.status == 1 && again.err.starts_with("cvtflow: ")))
            << "after: " << where << "\nthen: " << again.err;
    }

    /// Number of ends of the command by status and by what failed.
    void print_endings() const {
        for (const auto& [ending, count] : endings_) std::printf(" %s x %ld;", ending.c_str(), count);
        std::printf("\n");
    }

    std::vector<std::string> kept_;
    std::map<std::string, long> endings_;
    std::map<std::string, std::string> contents_;
    std::string checkpoint_, part_;
};

/// Every call of a command.
class NightlyFaults : public Faults, public testing::WithParamInterface<Order> {};
INSTANTIATE_TEST_SUITE_P(Commands, NightlyFaults, testing::ValuesIn(orders()), [](const auto& order) {
    std::string name = order.param.name;
    std::erase(name, '-');
    return name;
});

TEST_F(Program, HasAnOrderWithFaultsForEveryCommandOrAReasonWhyNot) {
    std::set<std::string> found;
    for (const Order& order : orders()) found.insert(order.arguments.front());
    Words all = commands_of(CVTFLOW_PROGRAM);
#ifdef CVTFLOW_LAB
    all = all + commands_of(CVTFLOW_LAB);
#endif
    for (const std::string& command : all) EXPECT_NE(found.contains(command), left_out.contains(command)) << command;
    EXPECT_GT(all.size(), 16u);
}

/// The three that compute and write most (the first ones); half of all in depth; every call of all of them nightly.
TEST_F(Faults, SampledCallsOfCommandsEndInAStatedOutcome) {
    std::mt19937 chance(11);
    const std::vector<Order> first(orders().begin(), orders().begin() + 3);
    for (const Order& order : cvtflow::test::depth(first, cvtflow::test::sample(orders(), orders().size() / 2, "faults"))) {
        auto calls = calls_of(order);
        for (const std::string family : families) {
            const long count = calls[family];
            std::set<long> sample{1, count};
            for (int i = 0; i < 2; ++i) sample.insert(1 + static_cast<long>(chance() % static_cast<unsigned long>(std::max(1L, count))));
            for (const long n : sample) {
                if (n >= 1 && n <= count) expect_stated_outcome(order, family, n, n % 2 == 0);
            }
        }
    }
}

/// Two writers could take one file otherwise: a first run that reports success, and a record that is damaged.
TEST_F(Faults, NothingIsWrittenWithoutALock) {
    for (const Words& order :
         {with_brief({"run", "tiny", "-o", "new.h5", "--force"}), Words{"batch", "sweep.toml", "-o", "new", "--threads", "1"},
          Words{"resume", "old.checkpoint.h5", "--set", "run.max_steps=0"}}) {
        clean();
        const Outcome outcome = run(order, environment("lock", 1, true));
        EXPECT_EQ(outcome.status, 1) << order.front();
        EXPECT_THAT(outcome.err, testing::HasSubstr(": cannot lock: No locks available; ")) << order.front();
        expect_untouched(order.front());
        EXPECT_FALSE(exists("new.h5") || exists("new/cases.h5")) << order.front();
    }
}

TEST_F(Faults, AListWithoutScenesReportsThatNoneCanBeRead) {
    const Outcome outcome = run({"list", "scenes"}, environment("read", 1, true));
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.out, testing::StartsWith("none: no folder of ready scenes can be read; "));
}

TEST_P(NightlyFaults, EveryCallEndsInAStatedOutcome) {
    auto calls = calls_of(GetParam());
    for (const std::string family : families) {
        for (long n = 1; n <= calls[family]; ++n) {
            for (const bool lasting : {false, true}) expect_stated_outcome(GetParam(), family, n, lasting);
        }
    }
    print_endings();
}

TEST_P(NightlyFaults, AllocationsThatFailLeaveResultsAsTheyWere) {
    const long count = calls_of(GetParam())["malloc"];
    for (long n = 1; n <= count; n += std::max(1L, count / 200)) {
        for (const bool lasting : {false, true}) expect_stated_outcome(GetParam(), "malloc", n, lasting);
    }
    print_endings();
}

// A system that has no threads to give.

class FewThreads : public Program {
protected:
    /// Environment in which every call of pthread_create is refused while `threads` threads live.
    [[nodiscard]] static std::vector<std::string> at_most(int threads) {
        return {preload(CVTFLOW_FAULTS), "CVTFLOW_FAULT=threads:" + std::to_string(threads), "OMP_WAIT_POLICY=passive"};
    }
    /// A fraction of a second on an executor.
    [[nodiscard]] Outcome run_on(std::string_view executor, int threads, const std::vector<std::string>& environment = {}) const {
        return run(
            {"run", "tiny", "-o", "none", "--until", "20 us", "--set", "start.settling_time=20us", "--set", "start.ramp_time=10us",
             "--threads", std::to_string(threads), "--segments", std::to_string(threads), "--set", "run.schedule=" + std::string(executor)},
            environment);
    }
};

TEST_F(FewThreads, EveryExecutorRunsOnWhatThereIsAndReportsIt) {
    const std::string expected = hash_in(run_on("serial", 1).out);
    ASSERT_NE(expected, "none");
    for (const engine::ExecutorRow& row : engine::executors()) {
        if (!row.parallel) continue;
        const Outcome alone = run_on(row.name, 2, at_most(0)), with_one = run_on(row.name, 3, at_most(1));
        EXPECT_EQ(alone.status, 0) << row.name << ": " << alone.err;
        EXPECT_EQ(hash_in(alone.out), expected) << row.name;
        EXPECT_THAT(alone.err, HasSubstr("cvtflow: only 1 of 2 threads were available")) << row.name;
        EXPECT_EQ(with_one.status, 0) << row.name << ": "
                                      << with_one.err;  // oneTBB itself wants no more than there are processors: no notice then
        EXPECT_EQ(hash_in(with_one.out), expected) << row.name;
    }
}

TEST_F(FewThreads, AFailureBetweenTrialAndStartIsSurvivedOnTheCallerAlone) {
    std::vector<std::string> environment = at_most(0);
    environment[1] = "CVTFLOW_FAULT=pthread_create:2";  // the first is the trial
    const Outcome outcome = run_on("flow", 2, environment);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("cvtflow: only 1 of 2 threads were available"));
}

TEST_F(FewThreads, ASweepRunsItsCasesAndWritesItsRowsOnOneThread) {
    write("sweep.toml",
          "[sweep]\nscene = \"tiny\"\n[set]\nrun.until = \"20 us\"\nstart.settling_time = \"20 us\"\nstart.ramp_time = \"10 us\"\n"
          "[[axes]]\nkey = \"load.torque\"\nvalues = [1, 2, 3]\n[outputs]\nscalars = [\"slip mean\"]\n");
    const Outcome outcome = run({"batch", "sweep.toml", "-o", "out", "--threads", "2"}, at_most(0));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("cvtflow: only 1 of 2 threads were available"));
    EXPECT_THAT(run({"table", "out"}).out, HasSubstr("3 of 3 cases"));
}

#ifdef CVTFLOW_LAB
TEST_F(FewThreads, ProfileReportsThatItCannotMeasure) {
    const Outcome outcome = run(
        {"profile", "tiny", "--schedules", "barrier:fused", "--threads", "2", "--steps", "2", "--rounds", "1", "--neighbours", "0,1", "-q"},
        at_most(0));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr("threads, which are not available"));
}
#endif

}  // namespace
}  // namespace cvtflow::tools

#endif
