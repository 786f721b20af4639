/// Inertias beyond a shaft: couplings of both shafts, and the governor of shaft 2. (model/EQUATIONS.md section 8)

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "model/variator/variator.hpp"

namespace cvtflow::model {
namespace {

/// Shafts that turn at 200 and 180 rad/s, at the angles 3 and 2 rad.
std::vector<double> coupled_pulleys(const PulleyModel& pulleys) {
    std::vector<double> block(static_cast<std::size_t>(2 * pulleys.coordinates().size()));
    const double speed[] = {200.0, 180.0}, angle[] = {3.0, 2.0};
    for (int shaft = 0; shaft < 2; ++shaft) {
        block[static_cast<std::size_t>(pulleys.coordinates().rotation(shaft))] = angle[shaft];
        block[static_cast<std::size_t>(pulleys.coordinates().size() + pulleys.coordinates().rotation(shaft))] = speed[shaft];
    }
    return block;
}

Parameters coupled() {
    Parameters p;
    p.drive.mode = DriveMode::coupling;
    p.drive.speed = TimeTable(201.0);
    p.drive.coupling = {500.0, 3.0};
    p.load.mode = LoadMode::coupling;
    p.load.torque = TimeTable(60.0);
    p.load.linear = 0.1;
    p.load.speed = TimeTable(179.0);
    p.load.coupling = {400.0, 2.0};
    return p;
}

TEST(Couplings, TakeOverWithoutAJumpOfTheTorque) {
    for (const LoadMode mode : {LoadMode::coupling, LoadMode::speed}) {
        Parameters p = coupled();
        p.load.mode = mode;
        PulleyModel pulleys(p);
        const auto block = coupled_pulleys(pulleys);
        const Inputs before = pulleys.inputs().at(0.0, block.data());
        EXPECT_NEAR(before.load_torque, -78.0, 1e-12) << "until then load.torque acts";
        pulleys.torques().couple(0.0, block.data());
        const Inputs after = pulleys.inputs().at(0.0, block.data());  // angles of 1 rad times stiffnesses of up to 1e5 N·m/rad, rounded
        EXPECT_NEAR(after.drive_torque, before.drive_torque, 1e-9);
        EXPECT_NEAR(after.load_torque, before.load_torque, 1e-9);
        EXPECT_EQ(after.clamping, before.clamping);
    }
}

TEST(Couplings, FarEndsTurnOnFromWhereTheyAreWhenAHostSetsTheirSpeed) {
    PulleyModel pulleys(coupled());
    const auto block = coupled_pulleys(pulleys);
    pulleys.torques().couple(0.0, block.data());
    HeldInputs held = pulleys.torques().held();
    held.reference[1].angle = pulleys.torques().reference_angle(2e-3, 1);
    held.reference[1].since = 2e-3;
    held.load_speed = 150.0;
    const double before = pulleys.torques().reference_angle(2e-3, 1);
    pulleys.torques().hold(held);
    EXPECT_EQ(pulleys.torques().reference_angle(2e-3, 1), before);
    EXPECT_NEAR(pulleys.torques().reference_angle(3e-3, 1), before + 0.15, 1e-12);
    EXPECT_EQ(pulleys.torques().reference_speed(3e-3, 1), 150.0);
}

TEST(Couplings, ModeSpeedHoldsShaftTwoByAGovernorOfItsOwnInertia) {
    Parameters p = coupled();
    p.load.mode = LoadMode::speed;
    p.load.inertia = 0.3;
    p.load.governor_frequency = 50.0;
    PulleyModel pulleys(p);
    auto block = coupled_pulleys(pulleys);
    pulleys.torques().couple(0.0, block.data());
    const double before = pulleys.inputs().at(0.0, block.data()).load_torque;
    block[static_cast<std::size_t>(pulleys.coordinates().rotation(1))] += 1e-4;
    const double polar = p.pulley.shaft_polar_inertia + 2.0 * p.pulley.sheave_polar_inertia + 0.3, omega = 2.0 * std::numbers::pi * 50.0;
    EXPECT_NEAR(pulleys.inputs().at(0.0, block.data()).load_torque, before - 1e-4 * polar * omega * omega, 1e-8);
    EXPECT_FALSE(pulleys.torques().coupled(1)) << "a governor stores nothing";
    EXPECT_TRUE(pulleys.torques().coupled(0));
}

}  // namespace
}  // namespace cvtflow::model
