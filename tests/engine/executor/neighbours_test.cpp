/// Executors among others: busy processors, few workers, other executors, hosts with tasks of their own, and what is left behind.

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_group.h>

#include <atomic>
#include <thread>

#include "executor_fixture.hpp"

namespace cvtflow::engine {
namespace {

using test::BusyNeighbour;
using test::Case;
using test::mixed_cycles;
using test::World;

class AmongNeighbours : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Catalogue, AmongNeighbours, testing::ValuesIn(test::pairs()), test::case_name);

/// Runs in a world of its own and compares with serial.
void expect_right(Executor& executor, long cycles = 200) {
    World world(mixed_cycles());
    world.run(executor, cycles);
    EXPECT_EQ(world.faults(), 0);
    EXPECT_EQ(world.hash(), test::serial_hash(mixed_cycles(), cycles));
}

TEST_P(AmongNeighbours, ProgressWhileAllProcessorsAreBusy) {
    std::vector<std::unique_ptr<BusyNeighbour>> neighbours;
    for (unsigned i = 0; i < std::thread::hardware_concurrency() && i < 8; ++i) neighbours.push_back(std::make_unique<BusyNeighbour>());
    expect_right(*GetParam().make(), 100);
}

TEST_P(AmongNeighbours, ProgressWithoutWorkers) {
    const oneapi::tbb::global_control alone(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    expect_right(*GetParam().row->make({.threads = 4}));
}

TEST_P(AmongNeighbours, ProgressWithMoreWorkersThanProcessors) {
    const oneapi::tbb::global_control many(oneapi::tbb::global_control::max_allowed_parallelism, 8);
    expect_right(*GetParam().row->make({.threads = 8}));
}

TEST_P(AmongNeighbours, TwoSideBySide) {
    std::vector<std::jthread> hosts;
    for (int host = 0; host < 2; ++host) {
        hosts.emplace_back([] {
            const auto executor = GetParam().make();
            for (int repetition = 0; repetition < 5; ++repetition) expect_right(*executor);
        });
    }
}

/// In a process that uses oneTBB itself.
class InsideAHost : public AmongNeighbours {
    void SetUp() override {
        if (test::thread_sanitizer) GTEST_SKIP() << "the host is oneTBB";
    }
};
INSTANTIATE_TEST_SUITE_P(Catalogue, InsideAHost, testing::ValuesIn(test::pairs()), test::case_name);

TEST_P(InsideAHost, AsOneOfItsTasks) {
    oneapi::tbb::parallel_for(0, 8, [](int) { expect_right(*GetParam().make(), 50); });
}

/// A wait that ran the host's tasks would run one of these inside of a step. Tasks of a millisecond make threads wait for each other.
TEST_P(InsideAHost, WaitingRunsNoneOfItsTasks) {
    thread_local bool stepping = false;
    std::atomic<int> inside{0};
    oneapi::tbb::task_group host;
    for (int task = 0; task < 20; ++task) {
        host.run([&] {
            if (stepping) ++inside;
            if (inside > 0) return;
            World world({{3}, {2, 2}});
            world.task_time(1000000);
            stepping = true;
            world.run(*GetParam().make(), 3);
            stepping = false;
            EXPECT_EQ(world.faults(), 0);
        });
    }
    host.wait();
    EXPECT_EQ(inside, 0);
}

TEST_P(InsideAHost, ThatCancelsItsTasksButNotTheStep) {
    oneapi::tbb::task_group host;
    host.run_and_wait([&] {
        host.cancel();
        expect_right(*GetParam().make());
    });
}

TEST_P(AmongNeighbours, LeaveNoThreadsBehind) {
    const auto run = [] { expect_right(*GetParam().make(), 3); };
    run();  // the runtimes' pools
    const int before = test::thread_count();
    for (int repetition = 0; repetition < 200; ++repetition) run();
    EXPECT_LE(test::thread_count(), before + static_cast<int>(std::thread::hardware_concurrency()));
    for (const char* own : {"barrier", "serial", "asio_pool", "taskflow"}) {  // whose threads end with the run
        if (GetParam().row->name != own) continue;
        EXPECT_EQ(test::thread_count(), before);
    }
}

TEST_P(AmongNeighbours, WaitInEveryWay) {
    for (const Wait wait : {Wait::spin, Wait::balanced, Wait::passive}) {
        for (const double spin : {-1.0, 0.0, 100.0}) {
            expect_right(*GetParam().row->make({.threads = 2, .wait = wait, .spin = spin}));
        }
    }
}

}  // namespace
}  // namespace cvtflow::engine
