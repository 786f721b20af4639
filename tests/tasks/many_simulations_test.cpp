/// A thousand simulations in one process leave neither threads nor memory behind.

#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "engine/executor/catalogue.hpp"
#include "engine/record/run/state_file.hpp"
#include "tasks/run/simulation.hpp"

namespace cvtflow::tasks {
namespace {

/// Resident memory of this process [bytes].
double resident() {
    std::ifstream file("/proc/self/statm");
    double total = 0.0;
    double pages = 0.0;
    file >> total >> pages;
    return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

long threads() {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return std::distance(begin(tasks), end(tasks));
}

TEST(ManySimulations, AThousandLeaveNeitherThreadsNorMemoryBehind) {
    Scene scene = read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml");
    const std::string state = testing::TempDir() + "many_simulations.h5";
    engine::write_state(state, Simulation(scene, Schedule{}).saved_state());
    scene.state_file = state;
    SilentObserver silent;
    const engine::Cancellation never;
    const auto executors = engine::executors();
    double memory = 0.0;
    std::size_t in_use = 0;
    long started = 0;
    for (int number = 0; number < 1000; ++number) {
        const engine::ExecutorRow& row = executors[static_cast<std::size_t>(number) % executors.size()];
        const bool staged = static_cast<std::size_t>(number) / executors.size() % 2 == 1;
        Simulation simulation(scene,
                              Schedule{std::string(row.name), {staged ? Assembly::staged : Assembly::fused}, 4, row.parallel ? 2 : 1});
        EXPECT_EQ(simulation.advance({.steps = 3}, silent, never).kind, FaultKind::max_steps);
        if (number == 200) {
            memory = resident();
            in_use = mallinfo2().uordblks;
            started = threads();
        }
    }
    // oneTBB and OpenMP keep their workers; what they and the allocator keep is there after the first 200.
    EXPECT_LE(threads(), started);
    EXPECT_LT(mallinfo2().uordblks, in_use + 100'000);  // bytes handed out and not given back: 100 a simulation
    EXPECT_LT(resident() - memory, 32e6);               // stacks of workers come and go; one simulation alone takes 0.2 MB
    std::filesystem::remove(state);
}

}  // namespace
}  // namespace cvtflow::tasks
