#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tasks/channel/channels.hpp"
#include "tasks/run/run.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::tasks {
namespace {

// Cylinders, valves and pump in a run: balance of powers, controllers that act through them, and that a run continues bit for bit.

/// The pump is sized for the clamping forces of `tiny`.
Scene hydraulic_scene(const std::string& detail, const std::vector<std::string>& more = {}) {
    return scene_of("tiny", detail,
                    {"start.settling_time=2 ms", "start.ramp_time=1 ms", detail == "rigid" ? "run.step=0.5 us" : "run.step=0.05 us",
                     "hydraulics.mode=force", "hydraulics.valve_lag=0.2 ms"},
                    more);
}

model::HydraulicEnergy energy_of(const Simulation& simulation) {
    return simulation.workspace().variator.pulleys().inputs().hydraulic_energy(pulleys_of(simulation));
}

model::Inputs inputs_of(const Simulation& simulation) {
    return simulation.workspace().variator.pulleys().inputs().at(simulation.time(), pulleys_of(simulation));
}

model::HydraulicInstant oil_in(const Simulation& simulation) {
    return simulation.workspace().variator.pulleys().inputs().hydraulics(simulation.time(), pulleys_of(simulation));
}

/// S_2 rises by half within 0.2 ms: a transient of everything.
const std::vector<std::string> step_of_force{"clamping.driven=[[0, 4000], [0.2e-3, 6000]]", "clamping.driving=5000"};

TEST(PumpEfficiency, IsUndefinedBeforeThereIsPower) {
    Simulation simulation(hydraulic_scene("rigid"));
    settle_and_go(simulation, 0.0);
    const auto all = channels();
    const auto efficiency = std::ranges::find(all, "efficiency_with_pump", &Channel::name);
    model::Observer observer(simulation.workspace().variator);
    std::vector<double> values;
    Outputs seen([&](double time, const Workspace& workspace, const Counters& counters) {
        efficiency->read({workspace.observed_by(observer, time), workspace, counters, 0, observer}, &values.emplace_back());
    });
    ASSERT_FALSE(simulation.advance({.until = 0.5e-3, .new_part = true}, seen, engine::Cancellation()));
    EXPECT_TRUE(std::isnan(values.front())) << "no time has passed";
    EXPECT_GT(values.back(), 0.1);
    EXPECT_LT(values.back(), 1.0);
}

class SimulationHydraulics : public testing::TestWithParam<std::string> {};

TEST_P(SimulationHydraulics, TheirPowersBalance) {
    Simulation simulation(hydraulic_scene(GetParam(), step_of_force));
    settle_and_go(simulation, 0.0);
    const model::HydraulicEnergy before = energy_of(simulation);
    EXPECT_EQ(before.pump, 0.0);
    settle_and_go(simulation, 2e-3);
    const model::HydraulicEnergy now = energy_of(simulation);
    const double residual = now.pump - now.lost() - now.sheaves - (now.stored - before.stored);
    EXPECT_GT(now.pump, 0.0);
    EXPECT_LT(std::abs(residual), 1e-3 * now.pump);
    EXPECT_LT(std::abs(residual), 2e-2 * (std::abs(now.sheaves) + std::abs(now.stored - before.stored))) << "these are a small part";
    EXPECT_LE(simulation.workspace().energy.balance_error_ratio(), 1.0);
}

TEST_P(SimulationHydraulics, TakeOverWithoutAJumpAndFollowTheForceThatIsRequested) {
    Simulation simulation(hydraulic_scene(GetParam(), step_of_force));
    settle_and_go(simulation, 0.0);
    EXPECT_NEAR(inputs_of(simulation).clamping[0], 5000.0, 1e-3);
    EXPECT_NEAR(inputs_of(simulation).clamping[1], 4000.0, 1e-3);
    settle_and_go(simulation, 3e-3);  // 14 time constants of the valve
    const model::HydraulicInstant now = oil_in(simulation);
    EXPECT_NEAR(now.set[1], now.target[1], 1e-3 * now.target[1]);
    const double droop = now.flow[1] / simulation.workspace().parameters.hydraulics.valve_conductance;
    EXPECT_NEAR(now.pressure[1], now.set[1] - droop, 1e-9 * now.set[1]);
    EXPECT_NEAR(now.force[1], 6000.0, 0.1 * 6000.0) << "less the droop of a valve that fills a cylinder whose sheave moves";
    EXPECT_GT(now.force[1], 5000.0);
}

TEST_P(SimulationHydraulics, ContinueBitForBitFromAnIntegrationState) {
    expect_continued(hydraulic_scene(GetParam(), step_of_force), 3e-4, 6e-4);
}

INSTANTIATE_TEST_SUITE_P(Levels, SimulationHydraulics, testing::Values("rigid", "fine"),
                         [](const auto& instance) { return instance.param; });

/// The tables of mode pressure are pressures, and controllers add to them.
TEST(SimulationHydraulicsByPressure, PressuresAreThoseOfTheTables) {
    Simulation simulation(hydraulic_scene(
        "rigid", {"hydraulics.mode=pressure", "hydraulics.driving_pressure=[[0, 3e5], [1e-4, 4e5]]", "hydraulics.driven_pressure=5 bar"}));
    settle_and_go(simulation, 3e-3);
    const model::HydraulicInstant now = oil_in(simulation);
    EXPECT_NEAR(now.target[0], 4e5, 1e-3);
    EXPECT_NEAR(now.target[1], 5e5, 1e-3);
    EXPECT_NEAR(now.set[0], 4e5, 1e-3 * 4e5);
    EXPECT_NEAR(now.set[1], 5e5, 1e-3 * 5e5);
}

TEST(SimulationHydraulicsByPressure, ASavedStateStartsCylindersWithTheForcesThatAreRequested) {
    Simulation simulation(hydraulic_scene("rigid", step_of_force));
    settle_and_go(simulation, 0.0);
    const engine::SavedState saved = simulation.saved_state();
    const Scene stiffer = hydraulic_scene("rigid", {"clamping.driven=4000", "clamping.driving=5000", "hydraulics.oil_modulus=5e8"});
    Simulation other(stiffer);
    other.reset(stiffer, &saved);
    EXPECT_NEAR(inputs_of(other).clamping[1], 4000.0, 1e-3);
    EXPECT_NEAR(inputs_of(other).clamping[0], 5000.0, 1e-3);
}

// Temperatures of a run: they balance, the lubricated law follows them, and a run continues bit for bit.

/// Scene with so little heat capacity that a millisecond warms the machine by some kelvin.
Scene warming_scene(const std::string& law = "lubricated", const std::vector<std::string>& more = {}) {
    return scene_of("tiny", "",
                    {"start.settling_time=1 ms", "start.ramp_time=0.5 ms", "run.step=50 ns", "run.output_interval=20 us",
                     "tip.friction_law=" + law, "heat.enabled=true", "heat.pulley_capacity=5e-3 J/K", "heat.oil_capacity=5e-3 J/K",
                     "heat.pulley_conductance=2 W/K", "heat.ambient_conductance=1 W/K"},
                    more);
}

TEST(SimulationHeat, LossesWarmTheMachineAndThinTheOil) {
    Simulation simulation(warming_scene());
    settle_and_go(simulation, 0.0);
    const model::HeatBalance& heat = simulation.workspace().heat;
    const double start = heat.film(), before = simulation.workspace().variator.chain().coefficients().tip.law->by_speed.at(0.1);
    settle_and_go(simulation, 5e-4);
    EXPECT_GT(heat.pulleys(), start + 0.5);
    EXPECT_NEAR(heat.given(), heat.stored() + heat.taken(), 1e-9 * heat.given());
    EXPECT_NEAR(heat.given(), simulation.workspace().energy.sums(5e-4).lost(), 0.05 * heat.given()) << "up to the last output";
    EXPECT_GT(simulation.workspace().variator.chain().coefficients().tip.law->by_speed.at(0.1), before)
        << "thin oil: more boundary friction";
}

TEST(SimulationHeat, ContinuesBitForBitFromAnIntegrationState) { expect_continued(warming_scene(), 2e-4, 4e-4); }

/// Temperatures of a run that ends when its means are steady are steady, too, however much heat the machine stores.
TEST(SimulationHeat, IsSteadyWhereARunEndsWhenItsMeansAre) {
    const Scene scene = scene_of("control", "rigid",
                                 {"start.state=", "load.torque=110", "control.gains=found", "run.until=steady",
                                  "tip.friction_law=lubricated", "heat.enabled=true", "oil.temperature=313.15"});
    const RunReport report = run_scene(scene, {});
    ASSERT_FALSE(report.fault) << report.fault.message();
    const double rise = report.whole.lost / scene.parameters.heat.ambient_conductance;
    EXPECT_NEAR(report.heat.oil(), scene.parameters.heat.ambient + rise, 0.03 * rise);
    EXPECT_GT(report.heat.pulleys(), report.heat.oil() + 0.5 * rise);
}

/// The heat of one run must not warm the next one.
TEST(SimulationHeat, BeginsAnewWithAReset) {
    const Scene scene = warming_scene();
    Simulation used(scene);
    settle_and_go(used, 4e-4);
    used.reset(scene, nullptr);
    settle_and_go(used, 2e-4);
    EXPECT_EQ(used.hash(), hash_at(scene, 2e-4));
}

/// Temperatures change nothing but the lubricated law.
TEST(SimulationHeat, LeavesAConstantLawAlone) {
    EXPECT_EQ(hash_at(warming_scene("constant"), 1e-4), hash_at(warming_scene("constant", {"heat.enabled=false"}), 1e-4));
}

TEST(SimulationHeat, RefusesMalformedTemperatures) {
    Simulation simulation(warming_scene());
    settle_and_go(simulation, 1e-4);
    IntegrationState state = simulation.integration_state();
    state.energy.pop_back();
    EXPECT_THROW(simulation.restore(state), engine::ArchiveError);
}

}  // namespace
}  // namespace cvtflow::tasks
