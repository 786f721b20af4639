/// Shafts that are coupled to far ends: their energy, and that a run continues bit for bit.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tasks/tuning/tuner.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::tasks {
namespace {

SilentObserver no_observer;
const engine::Cancellation not_ended;

/// Both shafts through couplings; the far end of shaft 2 slows down from 1 ms on.
Scene coupled_scene() {
    Scene scene = read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml");
    const std::vector<std::string> settings{"start.settling_time=1 ms",
                                            "start.ramp_time=0.5 ms",
                                            "run.step=50 ns",
                                            "drive.mode=coupling",
                                            "drive.coupling_stiffness=300 N*m/rad",
                                            "load.mode=coupling",
                                            "load.coupling_stiffness=200 N*m/rad",
                                            "load.coupling_damping=0.5 N*m*s/rad",
                                            "load.speed=[[0, 209], [0.1e-3, 209], [0.4e-3, 200]]"};
    set_values(scene, settings);
    return scene;
}

const double* pulleys_of(const Simulation& of) { return of.workspace().state() + of.workspace().layout().pulley_begin(); }

TEST(SimulationCouplings, TheirEnergyBalanceClosesToRounding) {
    Simulation simulation(coupled_scene());
    settle_and_go(simulation, 0.0);
    double stored[2];
    for (int shaft = 0; shaft < 2; ++shaft)
        stored[shaft] = simulation.workspace().variator.pulleys().coupling(0.0, pulleys_of(simulation), shaft).energy;
    settle_and_go(simulation, 1e-3);
    const EnergyLedger& energy = simulation.workspace().energy;
    const EnergySums sums = energy.sums(simulation.time());
    for (std::size_t k = 0; k < 2; ++k) {
        const int shaft = static_cast<int>(k);
        const double now = simulation.workspace().variator.pulleys().coupling(simulation.time(), pulleys_of(simulation), shaft).energy;
        const double far = energy.input_works().couplings.work[k], lost = energy.input_works().couplings.dissipated[k];
        EXPECT_GT(lost, 0.0) << shaft;
        EXPECT_NEAR(far, sums.work[k] + (now - stored[k]) + lost, 1e-9 * std::abs(far)) << shaft;  // sums over 20,000 steps
    }
    EXPECT_LE(energy.balance_error_ratio(), 1.0);
}

/// Rigid pins count each step's works themselves, at mean velocities: the identity holds to the second order of their long steps.
TEST(SimulationCouplings, RigidPinsCountWorkAndLossOfBothCouplings) {
    Scene scene = coupled_scene();
    set_values(scene, std::vector<std::string>{"detail.pins=rigid", "detail.order=2", "run.method=auto", "run.step=1 us"});
    Simulation simulation(scene);
    settle_and_go(simulation, 0.0);
    double stored[2];
    for (int shaft = 0; shaft < 2; ++shaft)
        stored[shaft] = simulation.workspace().variator.pulleys().coupling(0.0, pulleys_of(simulation), shaft).energy;
    settle_and_go(simulation, 1e-3);
    const EnergyLedger& energy = simulation.workspace().energy;
    const EnergySums sums = energy.sums(simulation.time());
    for (std::size_t k = 0; k < 2; ++k) {
        const int shaft = static_cast<int>(k);
        const double now = simulation.workspace().variator.pulleys().coupling(simulation.time(), pulleys_of(simulation), shaft).energy;
        const double far = energy.input_works().couplings.work[k], lost = energy.input_works().couplings.dissipated[k];
        EXPECT_GT(std::abs(far), 0.01) << shaft;
        EXPECT_GT(lost, 0.0) << shaft;
        EXPECT_NEAR(far, sums.work[k] + (now - stored[k]) + lost, 1e-4 * std::abs(far)) << shaft;
    }
    EXPECT_LE(energy.balance_error_ratio(), 1.0);
}

TEST(SimulationCouplings, AFarEndThatSlowsDownBrakesTheShaft) {
    Simulation simulation(coupled_scene());
    settle_and_go(simulation, 0.0);
    const model::PulleyModel& pulleys = simulation.workspace().variator.pulleys();
    const auto torque = [&] { return pulleys.inputs(simulation.time(), pulleys_of(simulation)).load_torque; };
    const double before = torque();
    EXPECT_LT(before, 0.0);
    settle_and_go(simulation, 4e-4);
    EXPECT_LT(torque(), before - 1.0);  // damper: 0.5 N·m·s/rad times 9 rad/s; the spring twists on
}

TEST(SimulationCouplings, ContinueBitForBitFromAnIntegrationState) {
    const Scene scene = coupled_scene();
    Simulation whole(scene);
    settle_and_go(whole, 2e-4);
    const IntegrationState middle = whole.integration_state();
    EXPECT_EQ(middle.couplings.size(), 6u);
    settle_and_go(whole, 5e-4);
    Simulation other(scene);
    other.restore(middle);
    settle_and_go(other, 5e-4);
    EXPECT_EQ(other.hash(), whole.hash());
    EXPECT_EQ(other.workspace().energy.input_works().couplings.work, whole.workspace().energy.input_works().couplings.work);
}

TEST(SimulationCouplings, AreReleasedWhereAStateBeforeThemIsPutBack) {
    const Scene scene = coupled_scene();
    Simulation simulation(scene), fresh(scene);
    ASSERT_EQ(simulation.advance({.until = 0.0, .steps = 100}, no_observer, not_ended).kind, FaultKind::max_steps);
    const IntegrationState settling = simulation.integration_state();
    settle_and_go(simulation, 1e-4);
    simulation.restore(settling);
    settle_and_go(simulation, 1e-4);
    settle_and_go(fresh, 1e-4);
    EXPECT_EQ(simulation.hash(), fresh.hash());
}

TEST(SimulationCouplings, CannotBeTuned) { EXPECT_THROW(Tuner(coupled_scene(), {}, not_ended), SceneError); }

}  // namespace
}  // namespace cvtflow::tasks
