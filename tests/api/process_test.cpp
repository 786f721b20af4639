/// Threads and processes: none before the first step, none after shutdown, and what a fork leaves.

#include <oneapi/tbb/global_control.h>

#include <cstdlib>
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
