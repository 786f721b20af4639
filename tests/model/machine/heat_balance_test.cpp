#include "model/machine/heat_balance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

namespace cvtflow::model {
namespace {

Parameters warming() {
    Parameters p;
    p.heat.enabled = true;
    p.heat.pulley_capacity = 50.0;
    p.heat.oil_capacity = 10.0;
    p.heat.pulley_conductance = 20.0;
    p.heat.ambient_conductance = 5.0;
    p.oil.temperature = 300.0;
    p.heat.ambient = 290.0;
    return p;
}

/// Constant powers: of tips, and of joints [W].
std::array<double, loss_kinds> lost(double tips, double joints, double time) {
    std::array<double, loss_kinds> sums{};
    sums[static_cast<std::size_t>(Loss::tip_friction)] = 0.75 * tips * time;
    sums[static_cast<std::size_t>(Loss::tip_damping)] = 0.25 * tips * time;
    sums[static_cast<std::size_t>(Loss::joint_friction)] = joints * time;
    return sums;
}

HeatBalance after(double time, double step, double tips, double joints) {
    HeatBalance heat;
    heat.restart(warming());
    const long steps = std::lround(time / step);
    for (long k = 0; k <= steps; ++k) heat.advance(static_cast<double>(k) * step, lost(tips, joints, static_cast<double>(k) * step));
    return heat;
}

/// All heat passes the oil to ambient: G_a (T_oil - T_a) = P, and that of tips from the pulleys to the oil.
TEST(HeatBalance, EndsWhereFlowsBalanceTheLosses) {
    const HeatBalance heat = after(500.0, 0.1, 40.0, 10.0);
    EXPECT_NEAR(heat.oil(), 290.0 + 50.0 / 5.0, 1e-6);
    EXPECT_NEAR(heat.pulleys(), heat.oil() + 40.0 / 20.0, 1e-6);
    EXPECT_NEAR(heat.film(), heat.oil() + 1.0, 1e-6);
}

/// Pulleys without exchange warm by P t/C, to rounding for every step.
TEST(HeatBalance, AdiabaticPulleysWarmInProportionToTheHeat) {
    Parameters p = warming();
    p.heat.pulley_conductance = 0.0;
    HeatBalance heat;
    heat.restart(p);
    heat.advance(0.0, lost(40.0, 0.0, 0.0));
    heat.advance(2.5, lost(40.0, 0.0, 2.5));
    EXPECT_NEAR(heat.pulleys(), 300.0 + 40.0 * 2.5 / 50.0, 1e-10);
}

/// First order in the step: half the step, half the error, but for the second order.
TEST(HeatBalance, ConvergesWithTheStep) {
    const double exact = after(2.0, 1e-4, 40.0, 10.0).pulleys();
    const double coarse = std::abs(after(2.0, 0.02, 40.0, 10.0).pulleys() - exact),
                 fine = std::abs(after(2.0, 0.01, 40.0, 10.0).pulleys() - exact);
    EXPECT_NEAR(fine / coarse, 0.5, 0.01);
}

TEST(HeatBalance, WhatLossesGiveIsStoredOrGone) {
    const HeatBalance heat = after(3.0, 0.07, 40.0, 10.0);
    EXPECT_NEAR(heat.given(), 50.0 * 43 * 0.07, 1e-9);  // 43 steps of 0.07 s
    EXPECT_NEAR(heat.given(), heat.stored() + heat.taken(), 1e-9 * heat.given());
}

TEST(HeatBalance, RestsBeforeTimeZeroAndWhereItIsOff) {
    HeatBalance heat;
    heat.restart(warming());
    heat.advance(-2.0, lost(40.0, 0.0, 1.0));
    heat.advance(-1.0, lost(40.0, 0.0, 2.0));
    EXPECT_EQ(heat.pulleys(), 300.0);
    heat.restart(Parameters());
    heat.advance(0.0, lost(40.0, 0.0, 0.0));
    heat.advance(1.0, lost(40.0, 0.0, 1.0));
    EXPECT_EQ(heat.pulleys(), Parameters().oil.temperature);
    const auto never = [](const char* name, double) { FAIL() << name; };
    heat.visit(never);
}

TEST(HeatBalance, ContinuesFromWhatItSaved) {
    HeatBalance heat = after(1.0, 0.1, 40.0, 10.0), other;
    std::map<std::string, double> saved;
    const auto save = [&](const char* name, double number) { saved[name] = number; };
    const auto load = [&](const char* name, double& number) { number = saved.at(name); };
    heat.visit(save);
    other.restart(warming());
    other.visit(load);
    ASSERT_TRUE(other.valid());
    for (HeatBalance* one : {&heat, &other}) one->advance(1.3, lost(40.0, 10.0, 1.3));
    EXPECT_EQ(other.pulleys(), heat.pulleys());
    EXPECT_EQ(other.taken(), heat.taken());
    saved["temperature_oil"] = std::nan("");
    other.visit(load);
    EXPECT_FALSE(other.valid());
}

}  // namespace
}  // namespace cvtflow::model
