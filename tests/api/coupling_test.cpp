/// A host that sets the pressures of cylinders or couples a vehicle.

#include <cmath>

#include "host_fixture.hpp"

namespace cvtflow::host {
namespace {

Scene by_pressure() { return tiny({"hydraulics.mode=pressure", "hydraulics.driven_pressure=4 bar", "hydraulics.driving_pressure=3 bar"}); }
Scene coupled() { return tiny({"load.mode=coupling", "load.speed=209 rad/s", "load.coupling_stiffness=200 N*m/rad"}); }
Scene coupled_rigid_pins() { return coupled().with({"detail.pins=rigid", "detail.plates=lumped", "run.method=auto", "run.step=1 us"}); }

// A host that sets the pressures of cylinders.

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

// A host that couples a vehicle: the far end's speed and angle as inputs, the torque's impulse back.

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

/// Rigid pins count impulse and work in every step; half of the step at an exchange passes at the speed before it.
TEST(HostCouplings, RigidPinsExchangeWithAVehicle) {
    Simulation simulation(coupled_rigid_pins());
    simulation.advance_to(0.0);
    const double before = simulation.channel("shaft_2/impulse")[0], work = simulation.channel("shaft_2/coupling_work")[0];
    const double torque = simulation.channel("shaft_2/torque")[0];
    simulation.set_input(Input::load_speed, 205.0);
    simulation.advance_to(5e-5);
    const double given = simulation.channel("shaft_2/impulse")[0] - before;
    EXPECT_LT(given, 0.0);
    EXPECT_NEAR(simulation.channel("shaft_2/coupling_work")[0] - work, 205.0 * given, 1.1 * 0.5e-6 * 4.0 * std::abs(torque));
}

// Both hosts.

TEST(HostInputs, ACopyContinuesBitForBit) {
    struct Row {
        Scene scene;
        Input input;
        double value;
        const char* channel;
    };
    for (const Row& row : {Row{by_pressure(), Input::pressure_driving, 5e5, "hydraulics/pump"},
                           Row{coupled(), Input::load_speed, 205.0, "shaft_2/coupling_work"},
                           Row{coupled_rigid_pins(), Input::load_speed, 205.0, "shaft_2/coupling_work"}}) {
        Simulation simulation(row.scene);
        simulation.advance_to(1e-5);
        simulation.set_input(row.input, row.value);
        simulation.advance_to(1.3e-5);
        Simulation copy = simulation.copy();
        for (Simulation* one : {&simulation, &copy}) one->advance_to(4e-5);
        EXPECT_EQ(copy.hash(), simulation.hash()) << row.channel;
        EXPECT_EQ(copy.channel(row.channel)[0], simulation.channel(row.channel)[0]) << row.channel;
    }
}

TEST(HostInputs, OutOfRangeOrOfOtherModesAreRefused) {
    struct Row {
        Scene scene;
        Input input;
        double value;
        const char* text;
    };
    for (const Row& row : {
             Row{tiny(), Input::clamping_driven, -1.0, "clamping.driven: -1 is outside [0, 1e7] N"},
             Row{tiny(), Input::load_torque, std::nan(""), "load.torque: nan is outside [-1e5, 1e5] N*m"},
             Row{tiny(), Input::drive_torque, 1.0, "drive.torque: needs drive.mode = \"torque\""},
             Row{tiny(), Input::ratio, 1.0, "control.ratio: needs control.enabled = true and control.quantity = \"ratio\""},
             Row{tiny(), static_cast<Input>(17), 1.0, "input: there is no number 17"},
             Row{tiny(), Input::pressure_driven, 5e5, "hydraulics.driven_pressure: needs hydraulics.mode = \"pressure\""},
             Row{tiny(), Input::load_speed, 5.0, "load.speed: needs load.mode = \"speed\" or \"coupling\""},
             Row{tiny(), Input::drive_angle, 5.0, "drive_angle: needs drive.mode = \"coupling\""},
             Row{by_pressure(), Input::clamping_driven, 5e3, "clamping.driven: needs clamping forces, not hydraulics.mode = \"pressure\""},
             Row{coupled(), Input::load_torque, 5.0, "load.torque: needs load.mode = \"torque\""},
         }) {
        Simulation simulation(row.scene);
        EXPECT_EQ(error_of([&] { simulation.set_input(row.input, row.value); }), row.text);
        EXPECT_EQ(code_of([&] { simulation.set_input(row.input, row.value); }), ErrorCode::argument) << row.text;
    }
    EXPECT_EQ(code_of([&] { Simulation other(tiny({"load.mode=speed"})); }), ErrorCode::scene);
}

}  // namespace
}  // namespace cvtflow::host
