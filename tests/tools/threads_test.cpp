/// A system that has no threads to give.

#include <gmock/gmock.h>

#include "engine/executor/catalogue.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::HasSubstr;

class FewThreads : public Program {
protected:
    void SetUp() override {
#ifndef CVTFLOW_FAULTS
        GTEST_SKIP() << "a sanitizer's runtime has to be loaded before any other library";
#endif
    }
    /// Environment in which every call of pthread_create is refused while `threads` threads live.
    [[nodiscard]] static std::vector<std::string> at_most(int threads) {
#ifdef CVTFLOW_FAULTS
        return {"LD_PRELOAD=" CVTFLOW_FAULTS, "CVTFLOW_FAULT=threads:" + std::to_string(threads), "OMP_WAIT_POLICY=passive"};
#else
        return {std::to_string(threads)};
#endif
    }
    /// A fraction of a second on an executor.
    [[nodiscard]] Outcome run_on(std::string_view executor, int threads, const std::vector<std::string>& environment = {}) const {
        return run(
            {"run", "tiny", "-o", "none", "--until", "20 us", "--set", "start.settling_time=20us", "--set", "start.ramp_time=10us",
             "--threads", std::to_string(threads), "--segments", std::to_string(threads), "--set", "run.schedule=" + std::string(executor)},
            environment);
    }
    [[nodiscard]] static std::string hash_in(const std::string& text) {
        const auto at = text.find("state hash");
        return at == std::string::npos ? "none" : text.substr(text.find_first_not_of(' ', at + 10), 16);
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
    for (const char* name : {"flow"}) {
        std::vector<std::string> environment = at_most(0);
        environment[1] = "CVTFLOW_FAULT=pthread_create:2";  // the first is the trial
        const Outcome outcome = run_on(name, 2, environment);
        EXPECT_EQ(outcome.status, 0) << name << ": " << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr("cvtflow: only 1 of 2 threads were available")) << name;
    }
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

TEST_F(FewThreads, ProfileReportsThatItCannotMeasure) {
    const Outcome outcome = run(
        {"profile", "tiny", "--schedules", "barrier:fused", "--threads", "2", "--steps", "2", "--rounds", "1", "--neighbours", "0,1", "-q"},
        at_most(0));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr("threads, which are not available"));
}

}  // namespace
}  // namespace cvtflow::tools
