/// Threads and processes: none before the first step, none after shutdown, and what a fork leaves.

#include <cvtflow/cvtflow.h>
#include <oneapi/tbb/global_control.h>
#include <sys/resource.h>

#include <cstdlib>
#include <fstream>
#include <thread>

#include "command_fixture.hpp"
#include "host_fixture.hpp"

namespace cvtflow::host {
namespace {

/// Whether this is a process in which nothing else has run. If not, the test is run again in one, and its result taken from there.
bool alone() {
    if (std::getenv("CVTFLOW_ALONE") != nullptr) return true;
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
    const std::string command = "CVTFLOW_ALONE=1 '" + self + "' --gtest_filter=" + test->test_suite_name() + "." + test->name();
    EXPECT_EQ(std::system(command.c_str()), 0);
    return false;
}

/// Bytes of addresses that this process has.
std::size_t addresses() {
    std::ifstream file("/proc/self/statm");
    std::size_t pages = 0;
    file >> pages;
    return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

/// Takes the stack that calls will need: where it cannot grow any more, the kernel ends a process without a message.
void touch_stack() {
    volatile char stack[512 * 1024];
    for (std::size_t i = 0; i < sizeof stack; i += 1024) stack[i] = 1;
}

/// Makes simulations through the C interface, with as many bytes more as are left. @return its code
int create_with(const cvtflow_scene* scene, std::size_t more) {
    touch_stack();
    const rlimit limit{addresses() + more, RLIM_INFINITY};
    setrlimit(RLIMIT_AS, &limit);
    cvtflow_code code = CVTFLOW_OK;
    for (int k = 0; k < 400 && code == CVTFLOW_OK; ++k) {  // until there is no room for another one; all are kept
        cvtflow_simulation* simulation = nullptr;
        code = cvtflow_create(scene, nullptr, &simulation, nullptr);
    }
    return code;
}

TEST(HostProcess, WithoutMemoryReportsItInsteadOfCrashing) {
    if (address_sanitizer || thread_sanitizer) GTEST_SKIP() << "they take terabytes of addresses";
    if (!alone()) return;
    cvtflow_scene* scene = nullptr;
    ASSERT_EQ(cvtflow_scene_read((std::string(CVTFLOW_SOURCE_DIR) + "/scenes/baseline.toml").c_str(), &scene, nullptr),
              CVTFLOW_OK);  // starts from a state file
    const std::size_t step = is_deep() ? 400'000 : 4'200'000;
    for (std::size_t more = 0; more < (std::size_t{24} << 20U); more += step) {
        EXPECT_EQ(in_child([&] { return create_with(scene, more); }), CVTFLOW_MEMORY) << more << " bytes";
    }
    cvtflow_scene_release(scene);
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

TEST(HostProcess, StepsAfterShutdownStartNewThreads) {
    if (!alone()) return;
    const Scene scene = tiny();
    const std::uint64_t expected = serial_hash(scene, -2.9e-4);
    for (int round = 0; round < 5; ++round) {
        {
            Simulation simulation(scene, Threads::private_arena(3));
            simulation.advance_to(-2.9e-4);
            EXPECT_EQ(simulation.hash(), expected);
        }
        EXPECT_TRUE(shutdown());
        EXPECT_TRUE(eventually([] { return threads() == 1; }));  // the kernel takes a joined thread off its list a moment later
    }
}

TEST(HostProcess, ShutdownReportsWhenOthersKeepTheWorkers) {
    if (!alone()) return;
    oneapi::tbb::task_scheduler_handle hosts{oneapi::tbb::attach{}};  // a host that uses oneTBB and is not done with it
    Simulation simulation(tiny(), Threads::private_arena(2));
    simulation.advance_to(-2.9e-4);
    EXPECT_FALSE(shutdown());
    EXPECT_TRUE(oneapi::tbb::finalize(hosts, std::nothrow));
}

TEST(HostProcess, AForkBeforeTheFirstStepIsHarmless) {
    const Scene scene = tiny();
    EXPECT_EQ(in_child([&] {
                  Simulation simulation(scene, Threads::private_arena(2));
                  const std::uint64_t expected = serial_hash(scene, -2.9e-4);
                  return in_child([&] {
                      simulation.advance_to(-2.9e-4);
                      return simulation.hash() == expected ? 0 : 1;
                  });
              }),
              0);
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
