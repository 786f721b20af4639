#include "model/force/pulley.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace cvtflow::model {
namespace {

constexpr double pi = std::numbers::pi;

std::vector<double> at_rest(const PulleyModel& pulleys) { return std::vector<double>(static_cast<std::size_t>(2 * pulleys.size()), 0.0); }

std::vector<double> random_block(const PulleyModel& pulleys, unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    std::vector<double> block = at_rest(pulleys);
    for (std::size_t k = 0; k < block.size(); ++k) block[k] = (k < block.size() / 2 ? 1e-5 : 1.0) * any(random);
    return block;
}

Parameters scene(PulleyDetail detail) {
    Parameters p;
    p.detail.pulleys = detail;
    return p;
}

TEST(PulleyInputs, ClampingAndLoadRiseSmoothlyWhileSettling) {
    Parameters p;
    p.start.settling_time = 0.02;
    p.start.ramp_time = 0.005;
    const PulleyModel pulleys(p);
    const auto block = at_rest(pulleys);
    const auto share = [&](double t) { return pulleys.inputs(t, block.data()).clamping[1] / 20e3; };
    EXPECT_EQ(share(-0.02), 0.0);
    EXPECT_NEAR(share(-0.01875), 0.15625, 1e-12);  // a quarter: x²(3 - 2x)
    EXPECT_NEAR(share(-0.0175), 0.5, 1e-12);
    for (const double t : {-0.015, -0.001, 0.0, 1.0}) EXPECT_EQ(share(t), 1.0) << t;
    EXPECT_NEAR(pulleys.inputs(-0.0175, block.data()).load_torque, -75.0, 1e-9);
    EXPECT_NEAR(pulleys.inputs(-0.0175, block.data()).clamping[0], 13.55e3, 1e-8);
}

TEST(PulleyInputs, TablesAreLinearAndTakenAtZeroBeforeZero) {
    Parameters p;
    p.load.torque = TimeTable({0.0, 0.01}, {100.0, 200.0});
    p.clamping.driving = TimeTable({0.002, 0.004}, {20e3, 30e3});
    const PulleyModel pulleys(p);
    const auto block = at_rest(pulleys);
    const auto inputs = [&](double t) { return pulleys.inputs(t, block.data()); };
    EXPECT_NEAR(inputs(0.005).load_torque, -150.0, 1e-10);
    EXPECT_NEAR(inputs(1.0).load_torque, -200.0, 0.0);
    EXPECT_NEAR(inputs(-0.001).load_torque, -100.0, 0.0);
    EXPECT_NEAR(inputs(0.003).clamping[0], 25e3, 1e-8);
    EXPECT_NEAR(inputs(0.0).clamping[0], 20e3, 0.0);
}

TEST(PulleyInputs, TheGovernorHoldsItsSpeedAndLagsByTorqueOverStiffness) {
    for (const PulleyDetail detail : {PulleyDetail::elastic, PulleyDetail::rigid}) {
        Parameters p = scene(detail);
        p.drive.speed = TimeTable({0.0, 0.1}, {200.0, 300.0});
        p.drive.inertia = 0.01;
        const PulleyModel pulleys(p);
        auto block = at_rest(pulleys);
        const double stiffness = (0.02 + 2.0 * 8e-3 + 0.01) * std::pow(2.0 * pi * 200.0, 2);
        for (const double t : {-0.01, 0.0, 0.05, 0.2}) {
            const double now = std::max(t, 0.0);
            const double angle = t <= 0.0 ? 200.0 * t : t <= 0.1 ? 200.0 * t + 500.0 * t * t : 25.0 + 300.0 * (t - 0.1);
            const auto drive = [&] { return pulleys.inputs(t, block.data()).drive_torque; };
            block[static_cast<std::size_t>(pulleys.rotation(0))] = angle;
            block[static_cast<std::size_t>(pulleys.size() + pulleys.rotation(0))] = std::min(200.0 + 1000.0 * now, 300.0);
            EXPECT_NEAR(drive(), 0.0, 1e-9) << t;  // angles of 55 rad are known to 7e-15, the stiffness is 7e4
            block[static_cast<std::size_t>(pulleys.rotation(0))] -= 150.0 / stiffness;
            EXPECT_NEAR(drive(), 150.0, 1e-8) << t;
            block[static_cast<std::size_t>(pulleys.size() + pulleys.rotation(0))] -= 1.0;
            EXPECT_NEAR(drive(), 150.0 + 2.0 * 0.046 * 2.0 * pi * 200.0, 1e-8) << "critically damped";
        }
    }
}

TEST(PulleyInputs, ControlClampsHarderIfTheDrivenSideIsTooSlowWithinItsAuthorityAndNeverPulls) {
    Parameters p;
    p.control.enabled = true;
    p.control.ratio = TimeTable(2.0);
    p.control.proportional = 1e5;
    p.control.integral = 2e7;
    const PulleyModel pulleys(p);
    auto block = at_rest(pulleys);
    block.push_back(0.0);  // the integral
    const auto inputs = [&](const PulleyModel& of, double integral) {
        block.back() = integral;
        return of.inputs(0.0, block.data());
    };
    const double nominal = 200.0 * pi / 3.0;  // 2000 rpm
    block[static_cast<std::size_t>(pulleys.size() + pulleys.rotation(0))] = nominal;
    double& driven = block[static_cast<std::size_t>(pulleys.size() + pulleys.rotation(1))];
    driven = 0.5 * nominal;
    EXPECT_NEAR(pulleys.inputs(0.0, block.data()).clamping[0], 27.1e3, 1e-6);
    driven = 0.49 * nominal;  // ε = 0.02
    const Inputs slow = inputs(pulleys, 3e-5);
    EXPECT_NEAR(slow.control_rate[0], 0.02, 1e-15);
    EXPECT_NEAR(slow.clamping[0], 27.1e3 + 1e5 * 0.02 + 2e7 * 3e-5, 1e-6);
    EXPECT_EQ(slow.clamping[1], 20e3);
    const Inputs saturated = inputs(pulleys, 1.0);
    EXPECT_NEAR(saturated.clamping[0], 27.1e3 + 10e3, 1e-6);
    EXPECT_EQ(saturated.control_rate[0], 0.0) << "it does not wind up";
    const Inputs unwinding = inputs(pulleys, -1.0);
    EXPECT_NEAR(unwinding.clamping[0], 27.1e3 - 10e3, 1e-6);
    EXPECT_GT(unwinding.control_rate[0], 0.0) << "the error leads back";
    p.clamping.driving = TimeTable(5e3);
    EXPECT_EQ(inputs(PulleyModel(p), -1.0).clamping[0], 0.0) << "a cylinder cannot pull";
}

TEST(Pulleys, ClampingPushesBothMovableSheavesTowardTheChain) {
    for (const PulleyDetail detail : {PulleyDetail::elastic, PulleyDetail::rigid}) {
        const PulleyModel pulleys(scene(detail));
        const auto block = at_rest(pulleys);
        auto slope = block;
        pulleys.slope(block.data(), pulleys.inputs(0.0, block.data()), {}, slope.data(), nullptr);
        // 1+ lies at +z and is pushed to -z; 2- the other way round. A sheave weighs 3 kg.
        EXPECT_NEAR(slope[static_cast<std::size_t>(pulleys.size() + pulleys.movable(0))], -27.1e3 / 3.0, 1e-9);
        EXPECT_NEAR(slope[static_cast<std::size_t>(pulleys.size() + pulleys.movable(1))], 20e3 / 3.0, 1e-9);
    }
}

TEST(Pulleys, AttachmentsOnlyResistMotionAgainstTheShaft) {
    const Parameters p;
    const PulleyModel pulleys(p);
    const double tilt = 1e-3, away = 0.5 * p.half.length;
    auto block = at_rest(pulleys);
    const auto set = [&](int body, int freedom, double value) { block[static_cast<std::size_t>(body_freedom(body, freedom))] = value; };
    for (const int body : {0, sheave_body(0, 0), sheave_body(0, 1)}) {
        const double z = body == 0 ? 0.0 : body == sheave_body(0, 0) ? -away : away;
        set(body, 0, 1e-4 + tilt * z);  // shaft 1 as one rigid body: moved, tilted about y, turned
        set(body, 3, tilt);
        set(body, 4, 2e-4);
        set(body, 5, 7.0);
    }
    Account account;
    auto slope = block;
    pulleys.slope(block.data(), {}, {}, slope.data(), &account);
    const auto& u = p.pulley;
    const double bearings = 0.5 * (u.bearing_radial * 1e-8 + u.bearing_axial * 4e-8 + u.bearing_tilt * tilt * tilt);
    EXPECT_NEAR(account[Energy::supports], bearings, 1e-12 * bearings);
}

TEST(Pulleys, LoseWhatTheirForcesTakeAndGyroscopicForcesDoNoWork) {
    const Parameters p;
    const PulleyModel pulleys(p);
    const auto energy = [&](const std::vector<double>& block) {
        Account account;
        auto slope = block;
        pulleys.slope(block.data(), {}, {}, slope.data(), &account);
        return account[Energy::supports] + pulleys.kinetic(block.data());
    };
    for (unsigned seed = 1; seed <= 5; ++seed) {
        const auto block = random_block(pulleys, seed);
        const Inputs inputs{12.0, -7.0, {1e3, 2e3}, {}};
        Account account;
        auto slope = block;
        pulleys.slope(block.data(), inputs, {}, slope.data(), &account);
        auto before = block, after = block;
        const double step = 1e-9;  // energies are quadratic: the central difference is exact up to rounding, 1e-16 · 20 J / step
        for (std::size_t k = 0; k < block.size(); ++k) before[k] -= step * slope[k], after[k] += step * slope[k];
        const double rate = (energy(after) - energy(before)) / (2.0 * step);
        const WorkRates works = pulleys.works(block.data(), inputs);
        const double expected = works[0] + works[1] + works[2] - account[Loss::supports] - account[Loss::cylinder];
        EXPECT_GT(account[Loss::supports], 0.0);
        EXPECT_GT(account[Loss::cylinder], 0.0);
        EXPECT_NEAR(rate, expected, 1e-5 + 1e-9 * std::abs(expected)) << seed;
    }
}

TEST(Pulleys, RigidOnesTurnAndCloseOnly) {
    const PulleyModel pulleys(scene(PulleyDetail::rigid));
    ASSERT_EQ(pulleys.size(), 4);
    EXPECT_NEAR(pulleys.inertia(0), 0.02 + 2.0 * 8e-3, 1e-17);
    EXPECT_NEAR(pulleys.inertia(2), 3.0, 0.0);
    const double block[8] = {0.1, 0.2, 1e-3, 2e-3, 10.0, 20.0, 0.3, 0.4};
    SheaveMotion sheaves[4];
    pulleys.motions(block, sheaves);
    EXPECT_EQ(sheaves[0].z, -18e-3);
    EXPECT_EQ(sheaves[1].z, 18e-3 + 1e-3);
    EXPECT_EQ(sheaves[2].z, -18e-3 + 2e-3);
    EXPECT_EQ(sheaves[3].z, 18e-3);
    EXPECT_EQ(sheaves[2].x, 0.17);
    EXPECT_EQ(sheaves[1].vz, 0.3);
    EXPECT_EQ(sheaves[3].vz, 0.0);
    EXPECT_EQ(sheaves[3].spin_z, 20.0);
}

}  // namespace
}  // namespace cvtflow::model
