#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>
#include <pthread.h>

#include <atomic>
#include <cstdlib>
#include <map>
#include <thread>

#include "command_fixture.hpp"
#include "host_fixture.hpp"

namespace cvtflow::host {
namespace {

// A host that starts threads, in every way that such hosts have.

TEST(HostThreads, EightThreadsWithFourSimulationsEachGetTheSerialHash) {
    const Scene scene = tiny();
    const std::uint64_t expected = serial_hash(scene, -2.5e-4);
    for (const Threads threads : ways()) {
        std::atomic<int> right = 0;
        {
            std::vector<std::jthread> hosts;
            for (int host = 0; host < 8; ++host) {
                hosts.emplace_back([&] {
                    std::vector<Simulation> mine;
                    for (int k = 0; k < 4; ++k) mine.emplace_back(scene, threads);
                    for (double t = -2.9e-4; t < -2.45e-4; t += 1e-5) {  // by turns
                        for (Simulation& simulation : mine) simulation.advance_to(t);
                    }
                    for (Simulation& simulation : mine) {
                        simulation.advance_to(-2.5e-4);
                        right += simulation.hash() == expected ? 1 : 0;
                    }
                });
            }
        }
        EXPECT_EQ(right, 32) << static_cast<int>(threads.way());
    }
}

TEST(HostSnapshot, IsReadByOthersWhileItSteps) {
    Simulation simulation(tiny());
    Snapshot gauges(simulation, {"run/steps", "shaft_1/angle", "links/tension"});
    ASSERT_EQ(gauges.size(), 3u + 24u);
    std::map<double, std::vector<double>> written;  // by time
    const auto take = [&](Simulation& now) {
        gauges.take(now);
        written[now.time()] = gauges.read();
    };
    take(simulation);
    simulation.on_output(1e-6, take);
    std::atomic<bool> done = false;
    std::vector<std::vector<std::vector<double>>> seen(2);
    {
        std::vector<std::jthread> readers;
        for (auto& mine : seen)
            readers.emplace_back([&] {
                for (mine.push_back(gauges.read()); !done; std::this_thread::yield())
                    if (std::vector<double> now = gauges.read(); now != mine.back()) mine.push_back(std::move(now));
            });
        simulation.advance_to(-2e-4);
        done = true;
    }
    EXPECT_GT(written.size(), 90u);
    for (const auto& mine : seen) {
        EXPECT_GT(mine.size(), 1u);
        for (const std::vector<double>& values : mine) EXPECT_EQ(values, written.at(values[0])) << "values of different moments";
    }
    std::vector<double> too_few(3);
    EXPECT_EQ(code_of([&] { gauges.read(too_few); }), ErrorCode::argument);
    EXPECT_EQ(code_of([&] { Snapshot(simulation, {"no/such"}); }), ErrorCode::argument);
}

TEST(HostThreads, ASecondCallIsRefusedWhileOneIsUnderWay) {
    Simulation simulation(tiny());
    std::atomic<bool> inside = false;
    std::atomic<bool> released = false;
    simulation.on_output(1e-5, [&](Simulation&) {
        inside = true;
        while (!released) std::this_thread::yield();
    });
    std::jthread stepper([&] { simulation.advance_to(-2.8e-4); });
    ASSERT_TRUE(eventually([&] { return inside.load(); }));
    EXPECT_EQ(error_of([&] { simulation.advance_to(1.0); }), "the simulation is in use by another thread");
    EXPECT_EQ(code_of([&] { simulation.set_input(Input::load_torque, 1.0); }), ErrorCode::busy);
    EXPECT_EQ(code_of([&] { static_cast<void>(simulation.state()); }), ErrorCode::busy);
    released = true;
    stepper.join();
    EXPECT_EQ(code_of([&] { simulation.advance_to(-2.7e-4); }), ErrorCode::none);
}

TEST(HostThreads, CancellationFromAnotherThreadEndsOneCallSoon) {
    const Scene scene = tiny();
    for (const Threads threads : ways()) {
        Simulation simulation(scene, threads);
        std::atomic<bool> running = false;
        ErrorCode code = ErrorCode::none;
        std::jthread stepper([&] {
            running = true;
            code = code_of([&] { simulation.advance_to(10.0); });  // hours
        });
        ASSERT_TRUE(eventually([&] { return running.load(); }));
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        simulation.cancel();
        stepper.join();
        EXPECT_EQ(code, ErrorCode::cancelled);
        Simulation alone(scene);
        alone.advance_to(simulation.time());
        if (simulation.counters().steps > 0) {  // a first call finds the tips' phases, then steps
            EXPECT_EQ(simulation.hash(), alone.hash());
        }
        EXPECT_NO_THROW(simulation.step());  // one request, one call
        alone.step();
        EXPECT_EQ(simulation.hash(), alone.hash());
    }
}

TEST(HostThreads, AHostArenaUnderLoadDoesNotMix) {
    const Scene scene = tiny();
    const std::uint64_t expected = serial_hash(scene, -2.8e-4);
    for (const Threads threads : {Threads::current_arena(2), Threads::private_arena(2)}) {
        oneapi::tbb::task_arena arena(2);
        std::atomic<bool> stop = false;
        std::atomic<int> moonlighting = 0;
        const std::thread::id none;
        std::atomic<std::thread::id> inside = none;
        std::atomic<long> host_tasks = 0;
        arena.execute([&] {
            oneapi::tbb::task_group load;
            for (int k = 0; k < 3; ++k) {
                load.run([&] {
                    while (!stop) {
                        oneapi::tbb::parallel_for(0, 64, [&](int) {
                            ++host_tasks;
                            if (inside.load() == std::this_thread::get_id()) ++moonlighting;
                        });
                    }
                });
            }
            for (int wait = 0; wait < 1000 && host_tasks == 0; ++wait)
                std::this_thread::sleep_for(std::chrono::milliseconds(1));  // a worker comes
            Simulation simulation(scene, threads);
            for (int k = 1; k <= 10; ++k) {
                inside = std::this_thread::get_id();
                simulation.advance_to(-3e-4 + 2e-6 * k);
                inside = none;
            }
            EXPECT_EQ(simulation.hash(), expected);
            stop = true;
            load.wait();
        });
        EXPECT_EQ(moonlighting, 0) << "a host task ran inside advance_to()";
    }
}

/// Makes a simulation and uses it on a thread with a stack of this size. @param base  where the stack lies; null: anywhere
/// @return the error's text
std::string error_on_stack(const Scene& scene, std::size_t size, Threads threads = Threads::caller(), void* base = nullptr) {
    struct Job {
        const Scene& scene;
        Threads threads;
        std::string text;
    } job{scene, threads, {}};
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    EXPECT_EQ(base != nullptr ? pthread_attr_setstack(&attributes, base, size) : pthread_attr_setstacksize(&attributes, size), 0);
    const auto work = [](void* argument) -> void* {
        auto& mine = *static_cast<Job*>(argument);
        mine.text = error_of([&] {
            Simulation simulation(mine.scene, mine.threads);
            simulation.advance_to(-2.9e-4);
            simulation.step();
            static_cast<void>(simulation.channel("ratio"));
        });
        return nullptr;
    };
    pthread_t thread;
    EXPECT_EQ(pthread_create(&thread, &attributes, work, &job), 0);
    pthread_join(thread, nullptr);
    pthread_attr_destroy(&attributes);
    return job.text;
}

/// The stack is painted, to see how much of it was overwritten.
TEST(HostThreads, NeedLessThan256KilobytesOfStack) {
    if (address_sanitizer) GTEST_SKIP() << "a sanitizer puts room between variables";
    const Scene scene = tiny({"plate.count=64", "detail.joint_points=16", "detail.plates=each"});
    for (const Threads threads : ways()) {
        constexpr std::size_t size = 512 * 1024;
        std::vector<unsigned char> stack(size + 4096, 0xa5);
        unsigned char* base = stack.data() + 4096 - reinterpret_cast<std::uintptr_t>(stack.data()) % 4096;
        ASSERT_EQ(error_on_stack(scene, size, threads, base), "no error");
        std::size_t untouched = 0;
        while (untouched < size && base[untouched] == 0xa5) ++untouched;
        RecordProperty("stack_bytes", std::to_string(size - untouched));
        EXPECT_LT(size - untouched, 256u * 1024u) << static_cast<int>(threads.way());
    }
}

TEST(HostThreads, WithTooLittleStackGetAnError) {
    if (address_sanitizer) GTEST_SKIP() << "a sanitizer puts room between variables";
    const Scene scene = tiny();
    EXPECT_NE(error_on_stack(scene, 64 * 1024).find("256 KiB are needed"), std::string::npos);
    EXPECT_EQ(error_on_stack(scene, 256 * 1024), "no error");
}

TEST(Scene, TakesSettingsInBraces) {
    const Scene both = tiny().with({"run.step=100 ns", "run.seed=7"});  // not one text from "run.step…" to "run.seed…"
    EXPECT_EQ(both.value("run.seed"), "7");
    EXPECT_EQ(both.value("run.step"), tiny().with("run.step=100 ns").value("run.step"));
    EXPECT_EQ(tiny().with({"run.seed=3"}).value("run.seed"), "3");
}

// Threads and processes: none before the first step, none after shutdown, and what a fork leaves.

/// Whether this is a process in which nothing else has run. If not, the test is run again in one, and its result taken from there.
bool alone() {
    if (std::getenv("CVTFLOW_ALONE") != nullptr) return true;
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
    const std::string command = "CVTFLOW_ALONE=1 '" + self + "' --gtest_filter=" + test->test_suite_name() + "." + test->name();
    EXPECT_EQ(std::system(command.c_str()), 0);
    return false;
}

TEST(HostProcess, NoneIsStartedBeforeTheFirstStepAndNoneLeftAfterShutdown) {
    if (!alone()) return;
    const long before = threads();
    const Scene scene = tiny();
    {
        Simulation simulation(scene, Threads::private_arena(2)), serial(scene);
        EXPECT_EQ(threads(), before);
        serial.advance_to(-2.9e-4);
        EXPECT_EQ(threads(), before);
        simulation.advance_to(-2.5e-4);
        EXPECT_TRUE(threads() > before || std::thread::hardware_concurrency() == 1);
    }
    EXPECT_TRUE(shutdown());
    EXPECT_TRUE(eventually([&] { return threads() == before; }));
}

TEST(HostProcess, ShutdownReportsWhenOthersKeepTheWorkers) {
    if (!alone()) return;
    oneapi::tbb::task_scheduler_handle hosts{oneapi::tbb::attach{}};  // a host that uses oneTBB and is not done with it
    Simulation simulation(tiny(), Threads::private_arena(2));
    simulation.advance_to(-2.9e-4);
    EXPECT_FALSE(shutdown());
    EXPECT_TRUE(oneapi::tbb::finalize(hosts, std::nothrow));
}

TEST(HostProcess, AForkAfterThreadedStepsIsAClearErrorAndTheCallerAloneCanContinue) {
    const Scene scene = tiny();
    EXPECT_EQ(in_child([&] {
                  Simulation simulation(scene, Threads::private_arena(2));
                  simulation.advance_to(-2.9e-4);
                  return in_child([&] {
                      const ErrorCode code = code_of([&] { simulation.advance_to(-2.8e-4); });
                      if (code != ErrorCode::forked) return 1;
                      Simulation anew(scene);
                      anew.set_state(simulation.state());
                      anew.advance_to(-2.8e-4);
                      return anew.hash() == serial_hash(scene, -2.8e-4) ? 0 : 2;
                  });
              }),
              0);
}

}  // namespace
}  // namespace cvtflow::host
