#include "engine/executor/tbb/resident_board.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <thread>

#include "tests/engine/executor/board_scenario_fixture.hpp"
#include "tests/engine/executor/executor_fixture.hpp"

namespace cvtflow::engine {
namespace {

using test::mixed_cycles;
using test::World;

/// The board with std::jthreads for workers, which ThreadSanitizer sees through.
class BoardExecutor final : public RunningExecutor {
public:
    BoardExecutor(int threads, int comers) : RunningExecutor({.threads = threads}), comers_(comers) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "board"; }

private:
    void execute(Run& run, int first) override {
        ResidentBoard board(run, options(), first);
        std::vector<std::jthread> workers;
        for (int worker = options().threads - comers_; worker < options().threads; ++worker) {
            workers.emplace_back([&board, worker] { board.work(worker); });
        }
    }
    int comers_;
};

TEST(ResidentBoard, AnyNumberOfWorkersFinishesEverything) {
    for (const int threads : {1, 2, 3, 4, 8}) {
        for (int comers = 1; comers <= threads; ++comers) {
            BoardExecutor board(threads, comers);
            World world(mixed_cycles());
            world.run(board, 500);
            EXPECT_EQ(world.faults(), 0) << comers << " of " << threads;
            EXPECT_EQ(world.hash(), test::serial_hash(mixed_cycles(), 500)) << comers << " of " << threads;
        }
    }
}

TEST(ResidentBoard, WorkersMayComeLate) {
    BoardExecutor board(4, 4);
    World world({{9}, {3, 1, 5}});
    world.task_time(20000);  // threads that begin find the run well under way
    for (int repetition = 0; repetition < 20; ++repetition) {
        world.run(board, 10);
        EXPECT_EQ(world.faults(), 0);
    }
}

TEST(ResidentBoard, ShortTasksOverAndOver) {
    const std::vector<std::vector<int>> cycles{{2}, {3}};
    for (const int threads : {2, 4}) {
        BoardExecutor board(threads, threads);
        World world(cycles);
        world.run(board, 20000);
        EXPECT_EQ(world.faults(), 0);
        EXPECT_EQ(world.hash(), test::serial_hash(cycles, 20000));
    }
}

using ModelBoard = ResidentBoardOn<test::ModelMachine>;
using test::Interleavings;
using test::layers;
using test::Sabotage;

/// Small cases in every interleaving, on a machine of the test's own.
class EveryInterleaving : public testing::Test {
protected:
    void SetUp() override {
        if (test::thread_sanitizer) GTEST_SKIP() << "the sanitizer does not follow changes of stacks";
    }
    static void is_right(const test::BoardCase& what, const Interleavings::Options& options, int missing = 0) {
        const Interleavings::Outcome outcome = test::explore<ModelBoard>(what, options, missing);
        EXPECT_EQ(outcome.fault, "") << what.name;
        EXPECT_GT(outcome.interleavings, 50) << what.name;
        if (testing::Test::HasNonfatalFailure()) return;
        std::printf("%s, %d workers: %ld interleavings\n", what.name.c_str(), options.workers - missing, outcome.interleavings);
    }
};
using ResidentBoardInEveryInterleaving = EveryInterleaving;
using NightlyResidentBoardInEveryInterleaving = EveryInterleaving;

TEST_F(ResidentBoardInEveryInterleaving, TwoWorkersAreRight) {
    for (const test::BoardCase& each : {layers({1}, 3), layers({2}, 2), layers({3}, 1), layers({1, 1}, 1)}) is_right(each, {});
}

TEST_F(ResidentBoardInEveryInterleaving, WorkersMayGoAwayOrNeverCome) {
    is_right(layers({1}, 1), {.absences = 1});
    is_right(layers({2}, 1), {.absences = 1});
    is_right(layers({2}, 2), {.workers = 3}, 1);
}

TEST_F(ResidentBoardInEveryInterleaving, ThreeWorkersAreRight) { is_right(layers({1}, 1), {.workers = 3}); }

TEST_F(NightlyResidentBoardInEveryInterleaving, LongerRunsAreRight) {
    for (const test::BoardCase& each : {layers({2, 1}, 1), test::turns()}) is_right(each, {});
    is_right(layers({2}, 2), {.absences = 1});
    is_right(layers({2}, 1), {.workers = 3});
}

/// Shows that these tests find what is wrong, and that nothing on the board is stronger than it has to be. Only how many are at work may
/// be miscounted: for more than one to leave too many, it takes three workers.
TEST_F(ResidentBoardInEveryInterleaving, WithoutAnyOneOfItsOrdersTheBoardIsWrong) {
    const auto wrong = [](Sabotage sabotage, const std::string& place) {
        const auto found = [&](const test::BoardCase& what, int absences) {
            return !test::explore<ModelBoard>(what, {.absences = absences, .sabotage = sabotage, .place = place}).fault.empty();
        };
        return found(layers({2}, 2), 0) || found(layers({1, 1}, 1), 0) || found(layers({2}, 1), 1);
    };
    int sabotaged = 0;
    for (const test::Site& site : test::explore<ModelBoard>(layers({1, 1}, 1), {.absences = 1}).sites) {
        if (site.orders) {
            EXPECT_TRUE(wrong(Sabotage::relaxed, site.place)) << site.place << " is not needed as it is";
        }
        const bool whole = site.kind == test::Site::Kind::swap || (site.kind == test::Site::Kind::add && site.orders);
        if (whole) {
            EXPECT_TRUE(wrong(Sabotage::torn, site.place)) << site.place << " need not be one operation";
        }
        sabotaged += site.orders + whole;
    }
    EXPECT_GE(sabotaged, 9);
}

}  // namespace
}  // namespace cvtflow::engine
