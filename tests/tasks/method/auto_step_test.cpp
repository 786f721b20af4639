/// Automatic steps hold while loads rise, follow the speed and friction, and are found in pieces.

#include "tasks/method/auto_step.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::tasks {
namespace {

/// Contacts that bear nothing yet damp little, so a step found at the geometric start is too long under load.
TEST(AutoStep, HoldsWhileLoadsRise) {
    Simulation simulation(scene_of("baseline", "fine", {"chain.damping_ratio=0.1", "start.settling_time=10 ms"}));
    ASSERT_FALSE(go(simulation, {.until = -1e-6}));
    EXPECT_LE(simulation.balance_error_ratio(), 1.0) << simulation.step() << " s";
}

/// Automatic step and pin period after a short settling [s].
struct StepAtSpeed {
    double step, pin_period;
};

StepAtSpeed step_at(const std::string& level, const std::string& scene_name, const std::vector<std::string>& settings) {
    Simulation simulation(scene_of(scene_name, level, settings, {"start.settling_time=5 ms", "start.ramp_time=2 ms"}));
    settle_and_go(simulation, 0.0);
    return {automatic_step(simulation), simulation.workspace().pin_period()};
}

/// Contacts damp in proportion to what they bear. With a step found at 4 kN, clamping by 60 kN ends the run.
TEST(AutoStep, OfHalvesFollowsClampingThatRises) {
    const Scene scene =
        scene_of("baseline", "fine",
                 {"start.settling_time=5 ms", "start.ramp_time=2 ms", "load.torque=15", "chain.damping_ratio=0.127",
                  "clamping.driven=[[0,4000],[3.2e-3,4000],[4.2e-3,60000]]", "clamping.driving=[[0,4800],[3.2e-3,4800],[4.2e-3,72000]]"});
    Simulation simulation(scene);
    settle_and_go(simulation, 7e-3);
    EXPECT_LT(simulation.balance_error_ratio(), 1.0);
    expect_continued(scene, 3.6e-3, 3.9e-3);
}

/// Longest step of rigid pins between outputs 50 us apart [s].
constexpr double longest_of_rigid_pins = 50e-6 / 7;

/// Friction that falls lets sliding grow, in every chain: at 5 us losses were 13 % too large, at 0.15 of the time in which sliding
/// grows e-fold they are within 1 %. Laws of all kinds that do not fall keep the step of constant friction.
TEST(AutoStep, OfRigidPinsIsShortWhereFrictionFalls) {
    const double constant = step_at("rigid", "baseline", {}).step;
    EXPECT_GE(constant, longest_of_rigid_pins * (1.0 - 1e-9));
    const std::vector<std::string> steep{"tip.friction_law=table", "tip.friction_coefficient=0.16",
                                         "tip.friction_table=[[0.02,0.16],[0.1,0.09]]"};
    EXPECT_LT(step_at("rigid", "baseline", steep).step, 0.5e-6);
    EXPECT_LT(step_at("rigid", "baseline", {"tip.friction_law=table", "tip.friction_table=[[0.02,0.09],[0.3,0.05]]"}).step, 3e-6);
    EXPECT_EQ(step_at("rigid", "baseline", {"tip.friction_law=table", "tip.friction_table=[[0.02,0.05],[0.3,0.09]]"}).step, constant);
}

/// Pins of a fast chain strike their sheaves within few steps of 5 us: losses were up to 3.7 % off. The ready scenes are slower. 80 steps
/// per pin are as exact as 100 were before friction took extrapolated sliding speeds and was solved again (decision 110).
TEST(AutoStep, OfRigidPinsTakes80StepsPerPinOfAFastChain) {
    const StepAtSpeed fast = step_at("rigid", "overdrive", {"drive.speed=5500 rpm"});
    EXPECT_LT(fast.pin_period, 0.3e-3);
    EXPECT_LE(fast.step, 1.01 / 80.0 * fast.pin_period);
    for (const char* scene : {"baseline", "low"})
        EXPECT_GE(step_at("rigid", scene, {}).step, longest_of_rigid_pins * (1.0 - 1e-9)) << scene;
}

/// The filter of the waves lengthens no other limit: of the cylinder's damper on a light sheave, of waves that are damped so much that they
/// are not filtered far enough. Both machines diverge at the longest step.
TEST(AutoStep, IsShortWhereTheFilterDoesNotHelp) {
    for (const auto& [level, longest] : {std::pair{"rigid", longest_of_rigid_pins}, {"fine", 5e-6}}) {
        for (const char* setting : {"pulley.sheave_mass=0.5 kg", "chain.damping_ratio=0.2"}) {
            Simulation simulation(scene_of("baseline", level, {setting, "start.settling_time=5 ms", "start.ramp_time=2 ms"}));
            settle_and_go(simulation, 5e-3);
            EXPECT_LT(automatic_step(simulation), 0.7 * longest) << level << ' ' << setting;
            EXPECT_LT(simulation.balance_error_ratio(), 1.0) << level << ' ' << setting;
        }
    }
}

/// Friction of 3.7 times the usual coefficient uses up more than 0.7 of the tolerance of the balance at 7.1 us (of 3.8 times all of it).
TEST(AutoStep, OfRigidPinsIsShorterWhereTheBalanceAsksForIt) {
    const Scene scene =
        scene_of("control", "rigid", {"tip.friction_coefficient=0.33", "start.settling_time=20 ms", "run.output_interval=0.2 ms"});
    Simulation simulation(scene);
    settle_and_go(simulation, 0.08);
    EXPECT_LE(simulation.step(), 5e-6 * (1.0 + 1e-12));
    EXPECT_LT(simulation.balance_error_ratio(), 1.0);
    expect_continued(scene, 0.01, 0.08);
}

/// A host's call of a millisecond does not contain a whole estimate; the pieces find the same, and continue from a checkpoint bitwise.
TEST(AutoStep, OfRigidPinsSpreadsItsEstimates) {
    const Scene scene = scene_of("baseline", "rigid", {"start.settling_time=5 ms", "start.ramp_time=2 ms"});
    Simulation simulation(scene);
    settle_and_go(simulation, 0.0);
    const Workspace& w = simulation.workspace();
    AutoStep spread(w.variator, scene.parameters, simulation.method()), resumed(w.variator, scene.parameters, simulation.method());
    const auto ask = [&](AutoStep& step, double time) { return step.longest(time, w.state(), w.tips.phases.data()); };
    const double at_once = ask(spread, 0.0);
    const LargestStep first = spread.largest();
    long before = 0;
    for (int question = 1; question <= 400; ++question) {
        const double time = 125e-6 * question;
        if (question == 8) before = spread.evaluations();
        EXPECT_NEAR(ask(spread, time), at_once, 1e-3 * at_once) << time;
        if (question < 8) continue;
        EXPECT_LE(spread.evaluations() - before, 3) << time;
        before = spread.evaluations();
        std::vector<std::byte> fields, again;
        engine::write_fields(fields, [&](auto& archive) { spread.visit(archive); });
        engine::read_fields(fields, [&](auto& archive) { resumed.visit(archive); });
        engine::write_fields(again, [&](auto& archive) { resumed.visit(archive); });
        EXPECT_EQ(again, fields);
    }
    EXPECT_NEAR(spread.largest().step, first.step, 0.02 * first.step);
    EXPECT_GT(spread.evaluations(), 2 * 60) << "it has estimated more than once";
}

/// Losses of as fast a chain of halves were 1.6 % off at 2 us. The ready scenes are slower.
TEST(AutoStep, OfHalvesTakes140StepsPerPinOfAFastChain) {
    const StepAtSpeed fast = step_at("fine", "overdrive", {"drive.speed=5900 rpm"});
    EXPECT_LE(fast.step, fast.pin_period / 139.0) << "the chain has become a little slower or faster since";
    EXPECT_LT(fast.step, 1.7e-6);
    for (const char* scene : {"baseline", "low", "control"}) EXPECT_GE(step_at("fine", scene, {}).step, 4.9e-6) << scene;
}

}  // namespace
}  // namespace cvtflow::tasks
