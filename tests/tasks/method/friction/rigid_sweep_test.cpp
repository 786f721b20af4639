/// Rigid pins as a method: what it keeps is the workspace's where that is read, nothing depends on where calls end, faults have a place.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tasks/batch/sweep/sweep.hpp"
#include "tasks/run/simulation.hpp"
#include "tests/engine/allocation_fixture.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

const engine::Cancellation never_cancelled;

/// At 2 us: the jolt of so small a machine is not resolved by 5 us.
Scene rigid_tiny(const std::vector<std::string>& settings = {}) {
    Scene scene = ready_tiny();
    apply_detail(scene, "rigid");
    set_values(scene,
               std::vector<std::string>{"run.method=leapfrog-sweep", "run.step=2 us", "start.settling_time=2 ms", "start.ramp_time=1 ms"});
    set_values(scene, settings);
    return scene;
}

void settle_tiny(Simulation& simulation) {
    SilentObserver silent;
    ASSERT_FALSE(simulation.advance({.until = 0.0}, silent, never_cancelled));
    ASSERT_EQ(simulation.time(), 0.0);
}

TEST(RigidSweep, DoesNotDependOnWhereCallsEnd) {
    Simulation whole(rigid_tiny()), parts(rigid_tiny());
    SilentObserver silent;
    for (Simulation* simulation : {&whole, &parts}) settle_tiny(*simulation);
    ASSERT_FALSE(whole.advance({.until = 2e-3}, silent, never_cancelled));
    for (int k = 1; k <= 8; ++k) ASSERT_FALSE(parts.advance({.until = 0.25e-3 * k}, silent, never_cancelled));
    EXPECT_EQ(whole.hash(), parts.hash());
    EXPECT_EQ(whole.counters().steps, parts.counters().steps);
}

TEST(RigidSweep, ResumesBitForBitInAnotherSimulation) {
    Simulation one(rigid_tiny());
    settle_tiny(one);
    SilentObserver silent;
    ASSERT_FALSE(one.advance({.until = 1e-3}, silent, never_cancelled));
    Simulation other(rigid_tiny());
    other.restore(one.integration_state());
    for (Simulation* simulation : {&one, &other}) ASSERT_FALSE(simulation->advance({.until = 2e-3}, silent, never_cancelled));
    EXPECT_EQ(one.integration_state().hash(), other.integration_state().hash());
}

/// Inputs that change at points of their tables cut steps; both laws, pulleys of all kinds, control and two pitches.
TEST(RigidSweep, FinishesWhatScenesHaveWithAClosedBalance) {
    const std::vector<std::vector<std::string>> scenes{
        {"load.torque=[[\"0 ms\", \"12 N*m\"], [\"1.0013 ms\", \"12 N*m\"], [\"2.3 ms\", \"6 N*m\"]]"},
        {"detail.friction=smoothed"},
        {"detail.pulleys=rigid"},
        {"control.enabled=true", "control.ratio=1.02"},
        {"chain.pitch=[\"8.12 mm\", \"8.0 mm\"]"},
        {"drive.mode=torque", "drive.torque=12 N*m"},
        {"start.layout=ring", "detail.pulleys=absent"}};
    for (const std::vector<std::string>& settings : scenes) {
        SCOPED_TRACE(settings.front());
        Simulation simulation(rigid_tiny(settings));
        SilentObserver silent;
        if (simulation.needs_settling()) settle_tiny(simulation);
        const Fault fault = simulation.advance({.until = 4e-3}, silent, never_cancelled);
        EXPECT_FALSE(fault) << fault.message();
        EXPECT_LE(simulation.suspicion(), 1.0);
    }
}

/// The ledger of the state is what the energy watch counts: both add up what each step has done.
TEST(RigidSweep, WritesItsLossesIntoTheLedger) {
    Scene scene = rigid_tiny();
    scene.parameters.ledger = true;
    Simulation simulation(scene);
    settle_tiny(simulation);
    const model::ChainLayout& at = simulation.variator().layout();
    const auto ledger = [&] {
        double sum = 0.0;
        for (int k = 0; k < model::loss_kinds; ++k) sum += simulation.state()[at.ledger_begin() + k];
        return sum;
    };
    const double before = ledger();
    SilentObserver silent;
    ASSERT_FALSE(simulation.advance({.until = 2e-3}, silent, never_cancelled));
    const double lost = simulation.energy().sums(simulation.time()).lost();
    EXPECT_GT(lost, 0.0);
    EXPECT_NEAR(ledger() - before, lost, 1e-12 * lost);
}

TEST(RigidSweep, NamesTimeAndPinOfAFault) {
    Simulation simulation(rigid_tiny({"tip.deepest=1 um"}));
    SilentObserver silent;
    const Fault fault = simulation.advance({.until = 0.0}, silent, never_cancelled);
    EXPECT_EQ(fault.kind, FaultKind::penetration);
    EXPECT_TRUE(fault.pin.has_value());
    EXPECT_GT(fault.value, 1e-6);
    EXPECT_LT(fault.time, 0.0);
}

TEST(RigidSweep, FindsStepsThatAreTooLong) {
    Simulation simulation(rigid_tiny({"run.step=9 us", "run.output_interval=90 us"}));
    SilentObserver silent;
    const Fault fault = simulation.advance({.until = 0.0}, silent, never_cancelled);
    EXPECT_TRUE(fault || simulation.suspicion() > 1.0);
}

TEST(RigidSweep, AllocatesNothingBetweenTheStartAndTheEndOfARun) {
    Simulation simulation(rigid_tiny({"run.step=4 us", "run.output_interval=20 us"}));
    settle_tiny(simulation);
    struct Counter final : RunObserver {
        void output(double, const Workspace&, const Counters& counters) override {
            if (counters.steps == 5) before = engine::test::allocation_count();
            if (counters.steps == 200) after = engine::test::allocation_count();
        }
        void transition(const TransitionRecord&) override {}
        long before = -1, after = -2;
    } counter;
    ASSERT_FALSE(simulation.advance({.until = 2e-3}, counter, never_cancelled));
    EXPECT_EQ(counter.before, counter.after);
}

/// On one thread whatever the scene leaves open; cut into segments it cannot be.
TEST(RigidSweep, IsOneSegment) {
    Schedule two;
    two.executor = "barrier";
    two.segments = two.threads = 2;
    EXPECT_THROW(Simulation(rigid_tiny(), two), SimulationError);
    EXPECT_THROW(rigid_tiny({"run.segments=2"}), SceneError);
    EXPECT_THROW(rigid_tiny({"run.schedule=flow"}), SceneError);
    EXPECT_TRUE(violations(rigid_tiny({"run.schedule=auto", "run.threads=4"})).empty());
}

}  // namespace
}  // namespace cvtflow::tasks
