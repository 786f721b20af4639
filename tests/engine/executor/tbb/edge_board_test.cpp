#include <gtest/gtest.h>

#include <cstdio>

#include "engine/executor/tbb/edge_board_protocol.hpp"
#include "tests/engine/executor/board_scenario_fixture.hpp"
#include "tests/engine/executor/executor_fixture.hpp"

namespace cvtflow::engine {
namespace {

using ModelEdgeBoard = EdgeBoardOn<test::ModelMachine>;
using test::Interleavings;
using test::layers;
using test::Sabotage;

/// Small cases in every interleaving, on a machine of the test's own.
class EveryInterleavingOfEdges : public testing::Test {
protected:
    void SetUp() override {
        if (test::thread_sanitizer) GTEST_SKIP() << "the sanitizer does not follow changes of stacks";
    }
    static void is_right(const test::BoardCase& what, const Interleavings::Options& options, int missing = 0) {
        const Interleavings::Outcome outcome = test::explore<ModelEdgeBoard>(what, options, missing);
        EXPECT_EQ(outcome.fault, "") << what.name;
        EXPECT_GT(outcome.interleavings, 5) << what.name;
        if (testing::Test::HasNonfatalFailure()) return;
        std::printf("%s, %d workers: %ld interleavings\n", what.name.c_str(), options.workers - missing, outcome.interleavings);
    }
};
using EdgeBoardInEveryInterleaving = EveryInterleavingOfEdges;
using NightlyEdgeBoardInEveryInterleaving = EveryInterleavingOfEdges;

TEST_F(EdgeBoardInEveryInterleaving, TwoWorkersAreRight) {
    for (const test::BoardCase& each : {layers({1}, 3), layers({2}, 2), layers({3}, 1), layers({2, 1}, 1)}) is_right(each, {});
}

TEST_F(EdgeBoardInEveryInterleaving, WorkersMayGoAwayOrNeverCome) {
    is_right(layers({1}, 1), {.absences = 1});
    is_right(layers({2}, 1), {.absences = 1});
    is_right(layers({2}, 2), {.workers = 3}, 1);
}

TEST_F(EdgeBoardInEveryInterleaving, ThreeWorkersAreRight) { is_right(layers({1}, 1), {.workers = 3}); }

TEST_F(NightlyEdgeBoardInEveryInterleaving, LongerRunsAreRight) {
    for (const test::BoardCase& each : {test::turns(), test::rows(2, 3, 1), layers({1, 1}, 2)}) is_right(each, {});
    is_right(layers({2}, 2), {.absences = 1});
    is_right(layers({2}, 1), {.workers = 3});
}

/// Shows that these tests find what is wrong, and that nothing on the board is stronger than it has to be. Only how many are at work may
/// be miscounted: for more than one to leave too many, it takes three workers.
TEST_F(EdgeBoardInEveryInterleaving, WithoutAnyOneOfItsOrdersTheBoardIsWrong) {
    const auto wrong = [](Sabotage sabotage, const std::string& place) {
        for (const int absences : {0, 1}) {
            const test::BoardCase what = layers({2}, absences == 0 ? 2 : 1);
            if (!test::explore<ModelEdgeBoard>(what, {.absences = absences, .sabotage = sabotage, .place = place}).fault.empty())
                return true;
        }
        return false;
    };
    int sabotaged = 0;
    for (const test::Site& site : test::explore<ModelEdgeBoard>(layers({2}, 1), {.absences = 1}).sites) {
        if (site.orders) EXPECT_TRUE(wrong(Sabotage::relaxed, site.place)) << site.place << " is not needed as it is";
        const bool whole = site.kind == test::Site::Kind::swap || (site.kind == test::Site::Kind::add && site.orders);
        if (whole) EXPECT_TRUE(wrong(Sabotage::torn, site.place)) << site.place << " need not be one operation";
        sabotaged += site.orders + whole;
    }
    EXPECT_GE(sabotaged, 7);
}

}  // namespace
}  // namespace cvtflow::engine
