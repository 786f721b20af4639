#include <gtest/gtest.h>

#include "tasks/run/simulation.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

/// Checkpoints pause a run every so often; what it had used of its budget is used.
TEST(WallBudget, PausesDoNotGiveTheBudgetOfWallTimeBack) {
    struct Pausing final : RunObserver {
        bool due = false;
        void output(double, const Workspace&, const Counters&) override { due = true; }
        void transition(const TransitionRecord&) override {}
    } observer;
    constexpr double budget = 0.05;  // [s]
    Scene scene = ready_tiny();
    scene.parameters.start.settling_time = 0.0;
    scene.run.until = 1.0;  // minutes
    scene.run.step = 5e-8;
    scene.run.output_interval = 2e-7;  // a few steps: several pauses fit into the budget, however slow the build
    scene.run.max_wall = budget;
    Simulation simulation(scene);
    Fault fault;
    int pauses = 0;
    do {
        observer.due = false;
        fault = simulation.advance({.until = scene.run.until, .pause = &observer.due}, observer, engine::Cancellation());
    } while (fault.kind == FaultKind::cancelled && ++pauses < 10'000);
    EXPECT_EQ(fault.kind, FaultKind::max_wall);
    EXPECT_EQ(fault.limit, budget);
    EXPECT_GT(fault.value, budget);
    EXPECT_GT(pauses, 3);
}

}  // namespace
}  // namespace cvtflow::tasks
