#include "engine/executor/tbb/resident_board.hpp"

#include <gtest/gtest.h>

#include <thread>

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

}  // namespace
}  // namespace cvtflow::engine
