/// A vehicle behind shaft 2: it coasts down as the closed form has it, and shafts give what a cycle needs.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tasks/scene/parameter_table.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::tasks {
namespace {

Scene ready(const std::string& name, const std::vector<std::string>& settings) {
    Scene scene = read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/" + name + ".toml");
    set_values(scene, settings);
    return scene;
}

double turning(const Simulation& simulation, int shaft) {
    const double* tail = simulation.workspace().state() + simulation.workspace().layout().pulley_begin();
    return simulation.workspace().variator.pulleys().shaft_speed(tail, shaft);
}

/// m dv/dt = -(F_0 + c v²): v = sqrt(F_0/c) tan(atan(v_0 sqrt(c/F_0)) - t sqrt(F_0 c)/m). A light vehicle with large drag, so that
/// milliseconds slow it by 6 %. m has the inertia of both pulleys and of the chain (1.5 kg) as well. The tolerance covers the losses of the
/// chain, some thousandths of the road load (measured: 0.07 %).
TEST(SimulationVehicle, CoastsDownAsTheClosedFormHasIt) {
    Scene scene = ready("ece15", {"cycle.speed=0", "control.enabled=false", "clamping.safety=0", "clamping.driving=27.1 kN",
                                  "clamping.driven=20 kN", "start.ratio=1", "drive.mode=torque", "drive.torque=0", "vehicle.mass=40 kg",
                                  "vehicle.wheel_inertia=0", "vehicle.drag_area=10 m^2", "vehicle.rolling_resistance=1"});
    const model::Parameters& p = scene.parameters;
    Simulation simulation(scene);
    settle_and_go(simulation, 2e-3);
    const double lever = scene.vehicle.lever(), v0 = turning(simulation, 1) * lever, ratio = turning(simulation, 0) * lever / v0;
    const double polar = p.pulley.shaft_polar_inertia + 2.0 * p.pulley.sheave_polar_inertia;
    const Workspace& w = simulation.workspace();
    const double link = 2.0 * p.half.mass + p.plate.count * p.plate.mass,
                 radius = w.variator.pulleys().running_radius(w.state() + w.layout().pulley_begin(), 1);
    const double chain = p.chain.pins * link * radius * radius;
    const double mass = scene.vehicle.mass + (polar + ratio * ratio * polar + chain) / (lever * lever);
    const double constant = 40.0 * 9.81, drag = 0.5 * 1.2 * 10.0, lasted = 40e-3;
    settle_and_go(simulation, 2e-3 + lasted);
    const double expected =
        std::sqrt(constant / drag) * std::tan(std::atan(v0 * std::sqrt(drag / constant)) - lasted * std::sqrt(constant * drag) / mass);
    const double v1 = turning(simulation, 1) * lever;
    EXPECT_GT(v0 - expected, 0.05 * v0);
    EXPECT_NEAR(v0 - v1, v0 - expected, 0.005 * (v0 - expected));
}

/// While 1500 kg accelerate from 15 to 35 km/h: the work of shaft 2 is what the cycle needs, but for the error of the ratio (measured: 0.44
/// %).
TEST(SimulationVehicle, ShaftTwoGivesWhatTheCycleNeeds) {
    Simulation simulation(ready("ece15", {"cycle.begin=128 s"}));
    settle_and_go(simulation, 0.1);
    const auto load = static_cast<std::size_t>(model::Work::load);
    const double work = simulation.workspace().energy.sums(0.1).work[load], needed = simulation.workspace().trip.sums(0.1)[2];
    settle_and_go(simulation, 0.4);
    const double given = work - simulation.workspace().energy.sums(0.4).work[load];
    const double target = simulation.workspace().trip.sums(0.4)[static_cast<std::size_t>(model::TripAccount::shaft)] - needed;
    EXPECT_GT(target, 1500.0);
    EXPECT_NEAR(given, target, 0.01 * target);
    EXPECT_NEAR(turning(simulation, 1) * 0.3 / 5.5, simulation.workspace().trip.speed(0.4), 0.01 * simulation.workspace().trip.speed(0.4));
}

TEST(SceneVehicle, OfARecordReadsBackEqual) {
    const Scene scene = ready("ece15", {});
    const Scene again = parse_scene(write_scene(scene), "again.toml", StartState::recorded);
    EXPECT_EQ(again.parameters, scene.parameters);
    EXPECT_EQ(again.cycle, scene.cycle);
    EXPECT_EQ(again.vehicle, scene.vehicle);
}

TEST(SceneVehicle, KeysThatFollowChangeWithItAndGoWithIt) {
    Scene scene = ready("ece15", {"vehicle.mass=3000 kg"});
    const double heavy = scene.parameters.load.torque.largest_magnitude();
    set_value(scene, "vehicle.mass=1500 kg");
    EXPECT_LT(scene.parameters.load.torque.largest_magnitude(), 0.6 * heavy);
    set_value(scene, "cycle.speed=0");
    EXPECT_EQ(scene.parameters.drive.speed, model::Drive{}.speed) << "no cycle, no table";
    EXPECT_NEAR(scene.parameters.load.inertia, (1500.0 + 4.0 / 0.09) * 0.09 / 30.25, 1e-9);
    set_value(scene, "vehicle.mass=0");
    EXPECT_EQ(scene.parameters.load, model::Load{});
}

TEST(SceneVehicle, RefusesOtherValuesOfKeysThatFollow) {
    Scene scene = ready("ece15", {});
    const auto refused = [&](const std::string& setting) {
        try {
            set_value(scene, setting);
        } catch (const SceneError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(refused("load.torque=10"), "--set load.torque=10: load.torque: follows from [vehicle] and [cycle]; remove it");
    EXPECT_EQ(refused("start.ratio=1"), "--set start.ratio=1: start.ratio: follows from [vehicle] and [cycle]; remove it");
    EXPECT_EQ(refused("start.ratio=" + value_text(*find_parameter("start.ratio"), scene)), "") << "its present value";
    EXPECT_EQ(refused("load.inertia=0.1"), "") << "a cycle does not set it";
}

}  // namespace
}  // namespace cvtflow::tasks
