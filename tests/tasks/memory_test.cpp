/// The step loop takes all its memory before it begins, and many simulations in one process leave neither threads nor memory behind.

#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "engine/executor/catalogue.hpp"
#include "engine/record/run/state_file.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tests/claims/operating_point_fixture.hpp"
#include "tests/claims/rig_fixture.hpp"
#include "tests/engine/allocation_fixture.hpp"
#include "tests/sample_fixture.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"
#include "tests/temporary_file_fixture.hpp"

namespace cvtflow::tasks {
namespace {

/// Counts allocations from one output to the next; makes none itself. The first outputs can be passed over: threads arrive meanwhile.
struct AllocationCounter {
    long passed_over = 0, between = 0, before = 0, outputs = 0, transitions = 0, first_steps = 0, last_steps = 0;
    Outputs observer{[this](double, const Workspace&, const Counters& counters) {
                         const long now = engine::test::allocation_count();
                         if (outputs > passed_over) between += now - before;
                         if (outputs == 0) first_steps = counters.steps;
                         last_steps = counters.steps;
                         ++outputs;
                         before = engine::test::allocation_count();
                     },
                     [this](const TransitionRecord&) { ++transitions; }};
};

/// Some steps of a scene from its start.
void expect_no_allocation(Scene scene) {
    scene.run.output_interval = 20.0 * scene.run.step.value_or(automatic_step(Simulation(scene)));
    const bool one_segment = scene.parameters.detail.pins == model::PinDetail::rigid;
    scene.run.segments = one_segment ? 1 : std::min(5, scene.parameters.chain.pins);
    scene.run.max_steps = 200;  // ends a settling run early
    scene.run.schedule = "serial";
    Simulation simulation(scene);
    AllocationCounter counter;
    const Fault fault = simulation.advance({.until = 1.0}, counter.observer, engine::Cancellation());
    EXPECT_EQ(fault.kind, FaultKind::max_steps) << fault.message();
    EXPECT_GE(counter.last_steps - counter.first_steps, 60);
    if (simulation.needs_settling() && !one_segment) {  // rigid pins have no transitions
        EXPECT_GT(counter.transitions, 0) << "tips just touch at the start, so some come and go";
    }
    EXPECT_EQ(counter.between, 0);
}

/// The step loop, where allocations can be counted.
class NoAllocation : public testing::Test {
    void SetUp() override {
        if (engine::test::allocation_count() < 0) GTEST_SKIP() << "a sanitizer owns malloc";
    }
};

/// Scenes settle from the geometric start by the default method; friction takes thirty sweeps in its first step, two in others.
TEST_F(NoAllocation, InTheStepLoopOfAnySceneAtAnyLevelOfDetail) {
    for (const std::string& level : claims::levels()) {
        SCOPED_TRACE(level);
        expect_no_allocation(claims::scene_at_level("tiny", level));
    }
    for (const ReadyScene& ready : ready_scenes()) {
        SCOPED_TRACE(ready.name);
        expect_no_allocation(read_scene(scene_file(ready.name)));
    }
}

TEST_F(NoAllocation, InTheStepLoopOfParallelExecutorsWithEitherAssembly) {
    const Scene scene = claims::ready_scene("shift", {"run.method=rk4", "run.step=50 ns", "run.output_interval=1 us", "run.max_steps=300"});
    for (const char* executor : {"flow", "barrier", "tbb_loop"}) {
        if (engine::find_executor(executor) == nullptr) continue;  // the laboratory's
        for (const Assembly assembly : test::assemblies()) {
            Simulation simulation(scene, {executor, {assembly}, 4, 2});
            AllocationCounter counter{.passed_over = 5};
            EXPECT_EQ(simulation.advance({.until = 1.0}, counter.observer, engine::Cancellation()).kind, FaultKind::max_steps);
            EXPECT_EQ(counter.between, 0) << executor;
        }
    }
}

/// Steps by error, rejections, estimates of the spectrum and changes of the polynomial.
TEST_F(NoAllocation, HoldsForMethodsThatFollowTheSpectrumAndForStepsByError) {
    for (const std::string& method : test::known_methods({"dumka3", "dopri54", "rkc"})) {
        Scene scene =
            test::settled_tiny({"run.method=" + method, "run.step=5us", "run.step_control=error", "run.tolerance=1e-2", "run.until=400us"});
        Simulation simulation(scene);
        AllocationCounter counter;
        const Fault fault = simulation.advance({.until = simulation.time() + 400e-6}, counter.observer, engine::Cancellation());
        EXPECT_FALSE(fault) << method << ": " << fault.message();
        EXPECT_GT(counter.outputs, 30) << method;
        EXPECT_EQ(counter.between, 0) << method;
    }
}

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

TEST(ManySimulations, LeaveNeitherThreadsNorMemoryBehind) {
    const int count = cvtflow::test::depth(400, 1000);
    Scene scene = ready_tiny();
    const tests::TemporaryFile state("many_simulations");
    engine::write_state(state.path(), Simulation(scene, Schedule{}).saved_state());
    scene.state_file = state.path();
    const auto executors = engine::executors();
    const std::vector<Assembly> assemblies = test::assemblies();
    double memory = 0.0;
    std::size_t in_use = 0;
    long started = 0;
    for (int number = 0; number < count; ++number) {
        const engine::ExecutorRow& row = executors[static_cast<std::size_t>(number) % executors.size()];
        const auto kind = static_cast<std::size_t>(number) / executors.size() % assemblies.size();
        Simulation simulation(scene, Schedule{std::string(row.name), {assemblies[kind]}, 4, row.parallel ? 2 : 1});
        EXPECT_EQ(go(simulation, {.steps = 3}).kind, FaultKind::max_steps);
        if (number == 200) {
            memory = resident();
            in_use = mallinfo2().uordblks;
            started = threads();
        }
    }
    // oneTBB and OpenMP keep their workers; what they and the allocator keep is there after the first 200.
    EXPECT_LE(threads(), started);
    const auto later = static_cast<std::size_t>(count - 200);
    EXPECT_LT(mallinfo2().uordblks, in_use + 125 * later);  // bytes handed out and not given back
    EXPECT_LT(resident() - memory, 32e6);                   // stacks of workers come and go; one simulation alone takes 0.2 MB
}

}  // namespace
}  // namespace cvtflow::tasks
