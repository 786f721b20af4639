/// Temperatures of a run: they balance, the lubricated law follows them, and a run continues bit for bit.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::tasks {
namespace {

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

TEST(SimulationHeat, ContinuesBitForBitFromAnIntegrationState) { EXPECT_FALSE(expect_continued(warming_scene(), 2e-4, 4e-4).heat.empty()); }

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
    state.heat.pop_back();
    EXPECT_THROW(simulation.restore(state), SimulationError);
}

}  // namespace
}  // namespace cvtflow::tasks
