/// A host that sets the pressures of cylinders or couples a vehicle.

#include <cmath>

#include "host_fixture.hpp"

namespace cvtflow::host {
namespace {

// A host that sets the pressures of cylinders.

Scene by_pressure() { return tiny({"hydraulics.mode=pressure", "hydraulics.driven_pressure=4 bar", "hydraulics.driving_pressure=3 bar"}); }

TEST(HostHydraulics, PressuresAreInputs) {
    Simulation simulation(by_pressure());
    simulation.advance_to(0.0);
    EXPECT_EQ(simulation.input(Input::pressure_driven), 4e5);
    simulation.set_input(Input::pressure_driven, 6e5);
    simulation.advance_to(2e-5);
    EXPECT_NEAR(simulation.channel("shaft_2/pressure_target")[0], 6e5, 1e-3);  // a force less what is no pressure, over the area
    EXPECT_GT(simulation.channel("pump/power")[0], 0.0);
    EXPECT_EQ(input_info(Input::pressure_driven).unit, "Pa");
}

TEST(HostHydraulics, ACopyContinuesBitForBit) {
    Simulation simulation(by_pressure());
    simulation.advance_to(1e-5);
    simulation.set_input(Input::pressure_driving, 5e5);
    simulation.advance_to(1.3e-5);
    Simulation copy = simulation.copy();
    for (Simulation* one : {&simulation, &copy}) one->advance_to(4e-5);
    EXPECT_EQ(copy.hash(), simulation.hash());
    EXPECT_EQ(copy.channel("hydraulics/pump")[0], simulation.channel("hydraulics/pump")[0]);
}

TEST(HostHydraulics, InputsOfOtherModesAreRefused) {
    Simulation pressed(by_pressure()), plain(tiny());
    EXPECT_EQ(error_of([&] { pressed.set_input(Input::clamping_driven, 5e3); }),
              "clamping.driven: needs clamping forces, not hydraulics.mode = \"pressure\"");
    EXPECT_EQ(error_of([&] { plain.set_input(Input::pressure_driven, 5e5); }),
              "hydraulics.driven_pressure: needs hydraulics.mode = \"pressure\"");
}

// A host that couples a vehicle: the far end's speed and angle as inputs, the torque's impulse back.

Scene coupled() { return tiny({"load.mode=coupling", "load.speed=209 rad/s", "load.coupling_stiffness=200 N*m/rad"}); }

TEST(HostCouplings, FarEndsAreInputs) {
    Simulation simulation(coupled());
    EXPECT_EQ(simulation.input(Input::load_speed), 209.0);
    EXPECT_EQ(error_of([&] { simulation.set_input(Input::load_angle, 0.0); }), "load_angle: the coupling acts from t = 0 on");
    simulation.advance_to(0.0);
    EXPECT_EQ(simulation.input(Input::load_angle), 0.0);
    simulation.set_input(Input::load_speed, 150.0);
    simulation.advance_to(2e-5);
    EXPECT_NEAR(simulation.input(Input::load_angle), 150.0 * simulation.time(), 1e-12);
    const double torque = simulation.channel("shaft_2/torque")[0];
    simulation.set_input(Input::load_angle, simulation.input(Input::load_angle) + 0.01);
    EXPECT_NEAR(simulation.channel("shaft_2/torque")[0], torque + 200.0 * 0.01, 1e-9);
}

TEST(HostCouplings, ImpulseIsTheMeanTorqueOverAnExchange) {
    Simulation simulation(coupled());
    simulation.advance_to(0.0);
    const double before = simulation.channel("shaft_2/impulse")[0], work = simulation.channel("shaft_2/coupling_work")[0];
    simulation.set_input(Input::load_speed, 205.0);
    simulation.advance_to(5e-5);
    const double given = simulation.channel("shaft_2/impulse")[0] - before;
    EXPECT_LT(given, 0.0);  // a load brakes
    EXPECT_NEAR(simulation.channel("shaft_2/coupling_work")[0] - work, 205.0 * given, 1e-9 * std::abs(205.0 * given));
}

TEST(HostCouplings, ACopyContinuesBitForBit) {
    Simulation simulation(coupled());
    simulation.advance_to(1e-5);
    simulation.set_input(Input::load_speed, 205.0);
    simulation.advance_to(1.3e-5);
    Simulation copy = simulation.copy();
    for (Simulation* one : {&simulation, &copy}) one->advance_to(4e-5);
    EXPECT_EQ(copy.hash(), simulation.hash());
}

/// Rigid pins count impulse and work in every step; half of the step at an exchange passes at the speed before it.
TEST(HostCouplings, RigidPinsExchangeWithAVehicle) {
    Simulation simulation(tiny({"load.mode=coupling", "load.speed=209 rad/s", "load.coupling_stiffness=200 N*m/rad", "detail.pins=rigid",
                                "detail.plates=lumped", "run.method=auto", "run.step=1 us"}));
    simulation.advance_to(0.0);
    const double before = simulation.channel("shaft_2/impulse")[0], work = simulation.channel("shaft_2/coupling_work")[0];
    const double torque = simulation.channel("shaft_2/torque")[0];
    simulation.set_input(Input::load_speed, 205.0);
    simulation.advance_to(5e-5);
    const double given = simulation.channel("shaft_2/impulse")[0] - before;
    EXPECT_LT(given, 0.0);
    EXPECT_NEAR(simulation.channel("shaft_2/coupling_work")[0] - work, 205.0 * given, 1.1 * 0.5e-6 * 4.0 * std::abs(torque));
    Simulation copy = simulation.copy();
    for (Simulation* one : {&simulation, &copy}) one->advance_to(1e-4);
    EXPECT_EQ(copy.hash(), simulation.hash());
    EXPECT_EQ(copy.channel("shaft_2/coupling_work")[0], simulation.channel("shaft_2/coupling_work")[0]);
}

TEST(HostCouplings, InputsOfOtherModesAreRefused) {
    Simulation coupling(coupled()), plain(tiny());
    EXPECT_EQ(error_of([&] { coupling.set_input(Input::load_torque, 5.0); }), "load.torque: needs load.mode = \"torque\"");
    EXPECT_EQ(error_of([&] { plain.set_input(Input::load_speed, 5.0); }), "load.speed: needs load.mode = \"speed\" or \"coupling\"");
    EXPECT_EQ(error_of([&] { plain.set_input(Input::drive_angle, 5.0); }), "drive_angle: needs drive.mode = \"coupling\"");
    EXPECT_EQ(code_of([&] { Simulation other(tiny({"load.mode=speed"})); }), ErrorCode::scene);
}

}  // namespace
}  // namespace cvtflow::host
