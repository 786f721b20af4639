/// `cvtflow diff`: two sweeps case by case.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/tools/batch_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::HasSubstr;

class Diff : public Sweeps {
protected:
    void SetUp() override {
        write_sweep("\"6 N*m\", \"12 N*m\"");
        ASSERT_EQ(batch().status, 0);
    }
};

TEST_F(Diff, OfTheSameSweepOnOtherThreadsIsNone) {
    ASSERT_EQ(run({"batch", "sweep.toml", "-o", "again", "--threads", "1"}).status, 0);
    const Outcome same = run({"diff", "out", "again"});
    EXPECT_EQ(same.status, 0) << same.err;
    EXPECT_THAT(same.out, HasSubstr("8 cases in out/cases.h5, 8 in again/cases.h5, 8 in both"));
    EXPECT_THAT(same.out, HasSubstr(" 0 differ\n"));
}

TEST_F(Diff, NamesColumnsCasesAndTheLargestDifference) {
    write_sweep("\"12 N*m\", \"18 N*m\"", "41 us");  // half of the cases in common, which run longer
    ASSERT_EQ(run({"batch", "sweep.toml", "-o", "longer"}).status, 0);
    const Outcome different = run({"diff", "out", "longer", "--json"});
    EXPECT_EQ(different.status, 1) << different.err;
    const auto all = nlohmann::json::parse(different.out);
    EXPECT_EQ(all["in_both"], 4);
    EXPECT_FALSE(all["equal"]);
    std::map<std::string, nlohmann::json> columns;
    for (const auto& column : all["columns"]) columns[column["column"]] = column;
    ASSERT_TRUE(columns.contains("steps"));
    EXPECT_EQ(columns["steps"]["cases"], 4);
    EXPECT_GE(columns["steps"]["largest"], 20);  // 1 us of steps of 50 ns
    EXPECT_FALSE(columns.contains("ratio_at_20_us")) << "the first 20 us are the same";
    const Outcome tolerant = run({"diff", "out", "longer", "--column", "slip_mean", "--tolerance", "1"});
    EXPECT_EQ(tolerant.status, 1) << "cases are missing";
    EXPECT_THAT(tolerant.out, HasSubstr("1 columns compared, 0 differ by more than 1 of the value\n"));
}

TEST_F(Diff, ReadsTheCsvOfATable) {
    write("out.csv", run({"table", "out", "--csv"}).out);
    const Outcome same = run({"diff", "out", "out.csv"});
    EXPECT_EQ(same.status, 0) << same.out << same.err;
    std::string other = read("out.csv");
    const auto cell = other.find(",ok,");
    ASSERT_NE(cell, std::string::npos);
    write("other.csv", other.replace(cell, 4, ",budget,"));
    const Outcome different = run({"diff", "out", "other.csv"});
    EXPECT_EQ(different.status, 1);
    EXPECT_THAT(different.out, HasSubstr("ok -> budget"));
}

TEST_F(Diff, RefusesTablesWhoseCasesHaveNoKeys) {
    write("keyless.csv", "case,status,slip_mean\n0,ok,0.1\n1,ok,0.2\n");
    const Outcome refused = run({"diff", "out", "keyless.csv"});
    EXPECT_EQ(refused.status, 2);
    EXPECT_THAT(refused.err, HasSubstr("both tables need the keys in which they differ"));
    EXPECT_EQ(run({"diff", "out", "out", "--column", "no_such"}).status, 2);
}

}  // namespace
}  // namespace cvtflow::tools
