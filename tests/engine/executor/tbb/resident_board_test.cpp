/// A board of resident workers as an executor, and of the model machine (interleaving_fixture.hpp) in every interleaving, with a check of
/// everything that may go wrong.

#include "engine/executor/tbb/resident_board.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "engine/executor/run.hpp"
#include "tests/engine/executor/executor_fixture.hpp"
#include "tests/engine/executor/interleaving_fixture.hpp"

namespace cvtflow::engine::test {

/// A graph, and its cycles to run one after the other.
struct BoardCase {
    std::string name;
    std::vector<int> cycles;
    TaskGraph graph{};
    std::vector<std::vector<int>> before{};  ///< [task] its predecessors

    /// Adds a task to the last cycle, or to a new one.
    int add(int cycle, const std::vector<int>& predecessors);
};

/// Each task writes one cell and reads those of its predecessors and of the controller, which reads all cells and writes one:
/// whatever runs too early, twice, or without seeing what it should is a race or is counted.
class BoardScenario : public Scenario, public Controller {
public:
    [[nodiscard]] std::string fault() final {
        const std::string wrong = wrong_;
        return wrong.empty() && !over_ ? "cycles are missing:" : wrong;
    }
    int next() noexcept final {
        for (const int task : what_.graph.topological(cycle())) {
            Interleavings::memory().touch(task, false);
            if (epochs_[static_cast<std::size_t>(task)] != epoch_) wrong_ = "the controller was asked before all tasks had run:";
        }
        Interleavings::memory().touch(controller(), true);
        if (over_) wrong_ = "the controller was asked after it had said stop:";
        over_ = left_ == 0;
        if (over_) return stop;
        --left_;
        ++epoch_;
        return cycle();
    }
    /// Body of all tasks; the context of their run is the scenario.
    static void body(void* scenario, int task) noexcept { static_cast<BoardScenario*>(scenario)->run_task(task); }

protected:
    explicit BoardScenario(const BoardCase& what)
        : run_(what.graph, this, *this, nullptr), what_(what), left_(what.cycles.size() - 1), epochs_(what.before.size()) {
        for (std::size_t cell = 0; cell <= what.before.size(); ++cell) static_cast<void>(Interleavings::memory().add_cell());
    }
    Run run_;
    const BoardCase& what_;

private:
    [[nodiscard]] int controller() const { return static_cast<int>(what_.before.size()); }
    [[nodiscard]] int cycle() const { return what_.cycles[static_cast<std::size_t>(epoch_ - 1)]; }
    void run_task(int task) noexcept {
        Interleavings::memory().touch(controller(), false);
        if (what_.graph.task(task).cycle != cycle()) wrong_ = "a task of another cycle ran:";
        for (const int before : what_.before[static_cast<std::size_t>(task)]) {
            Interleavings::memory().touch(before, false);
            if (epochs_[static_cast<std::size_t>(before)] != epoch_) wrong_ = "a task ran before its predecessor:";
        }
        Interleavings::memory().touch(task, true);
        long& epoch = epochs_[static_cast<std::size_t>(task)];
        if (epoch == epoch_) wrong_ = "a task ran twice:";
        epoch = epoch_;
    }

    std::size_t left_;
    std::vector<long> epochs_;  ///< [task] in which it ran last
    long epoch_ = 1;
    bool over_ = false;
    const char* wrong_ = "";
};

template <class Board>
class ScenarioOf final : public BoardScenario {
public:
    ScenarioOf(const BoardCase& what, int workers) : BoardScenario(what), board_(run_, {.threads = workers}, what.cycles.front()) {}
    void work(int worker) noexcept override { board_.work(worker); }

private:
    Board board_;
};

/// All interleavings of a case on a board. The last `missing` of the `options.workers` workers that the board expects never come.
template <class Board>
[[nodiscard]] Interleavings::Outcome explore(const BoardCase& what, Interleavings::Options options, int missing = 0) {
    const int expected = options.workers;
    options.workers -= missing;
    return Interleavings::explore(options, [&] { return std::make_unique<ScenarioOf<Board>>(what, expected); });
}

int BoardCase::add(int cycle, const std::vector<int>& predecessors) {
    const int task = graph.add({"t" + std::to_string(graph.size()), cycle, BoardScenario::body, graph.size(), {}});
    for (const int each : predecessors) graph.order(each, task);
    before.push_back(predecessors);
    return task;
}

/// Widths of the levels of one cycle, every task waiting for all of the level before; run `times` times.
BoardCase layers(const std::vector<int>& widths, std::size_t times) {
    BoardCase result{"layers", std::vector<int>(times, 0)};
    std::vector<int> before;
    for (const int width : widths) {
        result.name += " " + std::to_string(width);
        std::vector<int> level;
        for (int i = 0; i < width; ++i) level.push_back(result.add(0, before));
        before = level;
    }
    result.name += ", " + std::to_string(times) + " times";
    result.graph.freeze();
    return result;
}

/// Two cycles in turns: of a task, and of two tasks and one behind them.
BoardCase turns() {
    BoardCase result{"turns", {1, 0}};
    result.add(0, {});
    const int one = result.add(1, {}), other = result.add(1, {});
    result.add(1, {one, other});
    result.graph.freeze();
    return result;
}

}  // namespace cvtflow::engine::test

namespace cvtflow::engine {
namespace {

using test::mixed_cycles;
using test::World;

/// The board with std::jthreads for workers, which ThreadSanitizer can check.
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

/// Any number of workers; also those that come late, as threads that begin find the run well under way; and short tasks over and over.
TEST(ResidentBoard, FinishesEverythingInOrder) {
    const auto expect_right = [](int threads, int comers, const std::vector<std::vector<int>>& cycles, long count, long task_time = 0) {
        BoardExecutor board(threads, comers);
        World world(cycles);
        world.task_time(task_time);
        world.run(board, count);
        EXPECT_EQ(world.faults(), 0) << comers << " of " << threads;
        EXPECT_EQ(world.hash(), test::serial_hash(cycles, count)) << comers << " of " << threads;
    };
    for (const int threads : {1, 2, 3, 4, 8}) {
        for (int comers = 1; comers <= threads; ++comers) expect_right(threads, comers, mixed_cycles(), 500);
    }
    for (int repetition = 0; repetition < 20; ++repetition) expect_right(4, 4, {{9}, {3, 1, 5}}, 10, 20000);
    for (const int threads : {2, 4}) expect_right(threads, threads, {{2}, {3}}, 20000);
}

using ModelBoard = ResidentBoardOn<test::ModelMachine>;
using test::Interleavings;
using test::layers;
using test::Sabotage;

/// Small cases in every interleaving, on the test's machine.
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
