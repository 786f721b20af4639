#include <gmock/gmock.h>

#include <algorithm>

#include "tests/tools/batch_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::HasSubstr;

using Merge = Sweeps;

TEST_F(Merge, NamesWhatIsMissing) {
    write_sweep();
    for (const char* shard : {"1/3", "3/3"}) ASSERT_EQ(run({"batch", "sweep.toml", "-o", "cut", "--shard", shard}).status, 0);
    const Outcome refused = run({"merge", "cut"});
    EXPECT_EQ(refused.status, 5);
    EXPECT_EQ(refused.err,
              "cvtflow: cut/shard-0002-of-0003: this shard has no results\ncvtflow: 4 of 12 cases are missing: 1, 4, 7, 10\n"
              "cvtflow: nothing was written; run the missing shards, or use --partial to join the available ones\n");
    EXPECT_FALSE(exists("cut/cases.h5"));
    EXPECT_EQ(run({"merge", "cut", "--partial"}).status, 5);
    EXPECT_EQ(column("hash", "cut").size(), 8u);
    EXPECT_EQ(table("cut").attribute("missing_cases"), "1 4 7 10");
}

TEST_F(Merge, NamesTheFirstMissingShardsAndCountsTheOthers) {
    write_sweep();
    ASSERT_EQ(run({"batch", "sweep.toml", "-o", "cut", "--shard", "4/12"}).status, 0);
    const Outcome refused = run({"merge", "cut"});
    EXPECT_EQ(refused.status, 5);
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 5 + 1 + 1 + 1)
        << refused.err;  // five shards, how many more, cases, what to do
    EXPECT_THAT(refused.err,
                HasSubstr("cut/shard-0006-of-0012: this shard has no results\ncvtflow: … and 6 more; 11 shards have no results\n"));
}

}  // namespace
}  // namespace cvtflow::tools
