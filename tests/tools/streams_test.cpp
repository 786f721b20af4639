/// Descriptors that are closed, full or broken, and the signals that tell a run to end.

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <csignal>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::HasSubstr;

class Streams : public Sweeps {
protected:
    static constexpr const char* brief =
        "'" CVTFLOW_PROGRAM "' run tiny --until 20us --set start.settling_time=20us --set start.ramp_time=10us";
    [[nodiscard]] std::string hash_of(const std::string& record) const { return recorded_hash(folder_ / record); }
};

TEST_F(Streams, ClosedOnesAreNotTheRecordsAndEndNoRun) {
    ASSERT_EQ(shell(std::string(brief) + " -q -o whole.h5").status, 0);
    const std::string expected = hash_of("whole.h5");
    for (const char* closed : {"2>&-", "0<&- 2>&-", "2>/dev/full"}) {
        const Outcome outcome = shell(std::string(brief) + " --force -o r.h5 " + closed);
        EXPECT_EQ(outcome.status, 0) << closed;
        EXPECT_THAT(outcome.out, HasSubstr("state hash")) << closed;
        EXPECT_EQ(hash_of("r.h5"), expected) << closed;
    }
    for (const char* closed : {">&-", "0<&- >&- 2>&-"}) {
        EXPECT_EQ(shell(std::string(brief) + " --force -o r.h5 " + closed).status, 1) << closed;  // the summary went nowhere
        EXPECT_EQ(hash_of("r.h5"), expected) << closed;
    }
}

TEST_F(Streams, OutputThatCannotBeWrittenIsAnError) {
    write_sweep("\"6 N*m\"", "20 us");
    ASSERT_EQ(batch().status, 0);
    for (const char* command : {"table out", "table out --csv", "list methods", "schema", "check tiny"}) {
        const Outcome outcome = shell("'" CVTFLOW_PROGRAM "' " + std::string(command) + " > /dev/full");
        EXPECT_EQ(outcome.status, 1) << command;
        EXPECT_THAT(outcome.err, HasSubstr("No space left on device")) << command;
    }
    EXPECT_EQ(shell("'" CVTFLOW_PROGRAM "' --help > /dev/full").status, 1);
}

TEST_F(Streams, WhatIsReadWithoutEndOrNeverComesIsRefused) {
    mkfifo((folder_ / "pipe").c_str(), 0600);
    const Outcome endless = run({"check", "/dev/zero"}), pipe = run({"info", "pipe"});
    EXPECT_EQ(endless.status, 1);
    EXPECT_EQ(endless.err, "cvtflow: /dev/zero: cannot be read: not a regular file\n");
    EXPECT_EQ(pipe.status, 1);
    EXPECT_EQ(pipe.err, "cvtflow: pipe: not a regular file\n");
    EXPECT_EQ(shell("'" CVTFLOW_PROGRAM "' check /dev/stdin < '" CVTFLOW_SOURCE_DIR "/scenes/tiny.toml'").status, 0);
    EXPECT_EQ(shell("cat '" CVTFLOW_SOURCE_DIR "/scenes/tiny.toml' | '" CVTFLOW_PROGRAM "' check /dev/stdin").status, 0);
}

TEST_F(Streams, SignalsThatEndARunLeaveACheckpointAndAWholeRecord) {
    for (const int signal : {SIGHUP, SIGXCPU, SIGPIPE, SIGTERM}) {
        Child child({"run", "tiny", "-o", "r.h5", "--force", "--until", "5 ms", "--set", "start.settling_time=100us", "--set",
                     "start.ramp_time=50us", "--checkpoint-every", "1 h"},
                    folder_);
        ASSERT_TRUE(eventually([&] { return exists("r.h5.part"); }));
        child.send(signal);
        if (signal == SIGXCPU || signal == SIGPIPE) child.send(signal);  // they come again, which is no insisting
        const Outcome outcome = child.wait();
        EXPECT_EQ(outcome.status, 130) << strsignal(signal);
        EXPECT_THAT(outcome.out, testing::StartsWith("tiny: stopped: cancelled at t = ")) << strsignal(signal);
        EXPECT_TRUE(exists("r.checkpoint.h5")) << strsignal(signal);
        EXPECT_FALSE(exists("r.h5.part")) << strsignal(signal);
        EXPECT_THAT(record("r.h5").status(), testing::StartsWith("cancelled at t = ")) << strsignal(signal);
        EXPECT_EQ(run({"info", "r.h5"}).status, 0) << strsignal(signal);
        std::filesystem::remove(folder_ / "r.checkpoint.h5");
    }
}

TEST_F(Streams, ALimitOfProcessorTimeLeavesACheckpoint) {
    const Outcome outcome =
        shell("ulimit -S -t 1; '" CVTFLOW_PROGRAM "' run tiny -o r.h5 -q --until 1s --set run.schedule=serial --checkpoint-every 1h");
    EXPECT_EQ(outcome.status, 130);
    EXPECT_TRUE(exists("r.checkpoint.h5"));
}

TEST_F(Streams, AHangupThatIsIgnoredStaysIgnored) {
    const auto before = std::signal(SIGHUP, SIG_IGN);  // inherited by the child
    Child child(
        {"run", "tiny", "-o", "r.h5", "-q", "--until", "1 ms", "--set", "start.settling_time=20us", "--set", "start.ramp_time=10us"},
        folder_);
    std::signal(SIGHUP, before);
    ASSERT_TRUE(eventually([&] { return exists("r.h5.part"); }));
    child.send(SIGHUP);
    ASSERT_TRUE(exists("r.h5.part")) << "it came after the end";
    EXPECT_EQ(child.wait().status, 0);
    EXPECT_EQ(record("r.h5").status(), "finished");
}

#ifdef CVTFLOW_FAULTS
TEST_F(Streams, AReadThatFailsIsAnErrorAndNotTheEndOfTheFile) {
    write("scene.toml", "[chain]\npins = 24\n" + std::string(100000, '#') + "\n[run]\nuntil = \"20 us\"\n");
    write_sweep("\"6 N*m\"", "20 us");
    write("csv.toml", "[sweep]\nscene = \"tiny\"\n[[axes]]\ncsv = \"axis.csv\"\n[outputs]\nscalars = [\"slip mean\"]\n");
    write("axis.csv", "load.torque [N*m]\n6\n");
    const std::vector<std::pair<std::vector<std::string>, std::string>> readers{
        {{"check", "./scene.toml"}, "./scene.toml: cannot be read: Input/output error"},
        {{"batch", "sweep.toml", "--dry-run"}, "sweep.toml: cannot be read: Input/output error"},
        {{"batch", "csv.toml", "--dry-run"}, "axis.csv\" cannot be read: Input/output error"},
    };
    for (const auto& [arguments, message] : readers) {
        bool found = false;
        for (int n = 1; n <= 100 && !found && !HasFailure(); ++n) {  // what is mapped where is read first
            const Outcome outcome = run(arguments, {preload(CVTFLOW_FAULTS), "CVTFLOW_FAULT=read:" + std::to_string(n)});
            const bool here = outcome.err.find(message) != std::string::npos;
            found |= here;
            EXPECT_EQ(outcome.status, outcome.err.empty() ? 0 : 1) << n << ": " << outcome.err;
        }
        EXPECT_TRUE(found) << message;
    }
}
#endif

}  // namespace
}  // namespace cvtflow::tools
