/// A host that sets the pressures of cylinders.

#include "host_fixture.hpp"

namespace cvtflow::host {
namespace {

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

}  // namespace
}  // namespace cvtflow::host
