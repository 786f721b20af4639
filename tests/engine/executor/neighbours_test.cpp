/// Executors among others: busy processors, few workers, other executors, hosts that run tasks too, and what is left behind.

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_group.h>

#include <atomic>
#include <thread>

#include "executor_fixture.hpp"

namespace cvtflow::engine {
namespace {

using test::Case;
using test::mixed_cycles;
using test::World;

/// Runs in a separate world and compares with serial.
void expect_right(Executor& executor, long cycles = 200) {
    World world(mixed_cycles());
    world.run(executor, cycles);
    EXPECT_EQ(world.faults(), 0);
    EXPECT_EQ(world.hash(), test::serial_hash(mixed_cycles(), cycles));
}

TEST(AmongNeighbours, ProgressWhileAllProcessorsAreBusy) {
    test::for_each(test::pairs(), [&](const Case& each) {
        std::vector<std::jthread> neighbours;
        for (unsigned i = 0; i < std::thread::hardware_concurrency() && i < 8; ++i) {
            neighbours.emplace_back([](const std::stop_token& stop) {
                while (!stop.stop_requested()) {}
            });
        }
        expect_right(*each.make(), 100);
    });
}

TEST(AmongNeighbours, ProgressWithoutWorkersAndWithMoreThanProcessors) {
    test::for_each(test::pairs(), [&](const Case& each) {
        for (const int workers : {1, 8}) {
            const oneapi::tbb::global_control limited(oneapi::tbb::global_control::max_allowed_parallelism,
                                                      static_cast<std::size_t>(workers));
            expect_right(*each.row->make({.threads = workers == 1 ? 4 : 8}));
        }
    });
}

/// Executors in a process that uses oneTBB itself.
class InsideAHost : public testing::Test {
    void SetUp() override {
        if (test::thread_sanitizer) GTEST_SKIP() << "the host is oneTBB";
    }
};

TEST_F(InsideAHost, AsOneOfItsTasks) {
    test::for_each(test::pairs(), [&](const Case& each) { oneapi::tbb::parallel_for(0, 8, [&](int) { expect_right(*each.make(), 50); }); });
}

/// A wait that ran the host's tasks would run one of these inside of a step. Tasks of a millisecond make threads wait for each other.
TEST_F(InsideAHost, WaitingRunsNoneOfItsTasks) {
    test::for_each(test::pairs(), [&](const Case& each) {
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
                world.run(*each.make(), 3);
                stepping = false;
                EXPECT_EQ(world.faults(), 0);
            });
        }
        host.wait();
        EXPECT_EQ(inside, 0);
    });
}

TEST(AmongNeighbours, LeaveNoThreadsBehind) {
    test::for_each(test::pairs(), [&](const Case& each) {
        const auto run = [&] { expect_right(*each.make(), 3); };
        run();  // the runtimes' pools
        const int before = test::thread_count();
        for (int repetition = 0; repetition < 200; ++repetition) run();
        EXPECT_LE(test::thread_count(), before + static_cast<int>(std::thread::hardware_concurrency()));
        for (const char* ends_with_run : {"barrier", "serial", "asio_pool", "taskflow"}) {  // whose threads end with the run
            if (each.row->name != ends_with_run) continue;
            EXPECT_EQ(test::thread_count(), before);
        }
    });
}

TEST(AmongNeighbours, WaitInEveryWay) {
    test::for_each(test::pairs(), [&](const Case& each) {
        for (const Wait wait : {Wait::spin, Wait::balanced, Wait::passive}) {
            for (const double spin : {-1.0, 0.0, 100.0}) {
                expect_right(*each.row->make({.threads = 2, .wait = wait, .spin = spin}));
            }
        }
    });
}

}  // namespace
}  // namespace cvtflow::engine
