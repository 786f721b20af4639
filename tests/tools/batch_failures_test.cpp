/// Reports of a sweep on cases that fail, and when it stops.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>

#include "tests/tools/batch_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

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
