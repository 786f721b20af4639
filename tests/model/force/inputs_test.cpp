/// Inputs that depend on the motion: load by speed, clamping by torque, control of slip.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "model/variator/variator.hpp"
#include "tests/oracle/oracle_cases.hpp"

namespace cvtflow::model {
namespace {

/// Pulleys that turn at 200 and 180 rad/s; behind them integrals of two controllers.
std::vector<double> turning(const PulleyModel& pulleys, double first = 0.0, double second = 0.0) {
    std::vector<double> block(static_cast<std::size_t>(2 * pulleys.size()));
    block.insert(block.end(), {first, second});
    block[static_cast<std::size_t>(pulleys.size() + pulleys.rotation(0))] = 200.0;
    block[static_cast<std::size_t>(pulleys.size() + pulleys.rotation(1))] = 180.0;
    return block;
}

TEST(Inputs, LoadGrowsWithSpeedAndItsSquareAgainstTheTravel) {
    Parameters p;
    p.load.torque = TimeTable(10.0);
    p.load.linear = 0.1;
    p.load.quadratic = 1e-3;
    const PulleyModel pulleys(p);
    auto block = turning(pulleys);
    EXPECT_NEAR(pulleys.inputs(0.0, block.data()).load_torque, -(10.0 + 18.0 + 32.4), 1e-12);
    block[static_cast<std::size_t>(pulleys.size() + pulleys.rotation(1))] = -180.0;
    EXPECT_NEAR(pulleys.inputs(0.0, block.data()).load_torque, -(10.0 - 18.0 - 32.4), 1e-12);
}

/// What one-dimensional theory has as the torque that slips: 2 mu S r/cos(beta).
TEST(Inputs, ClampingBySafetyCarriesThatManyTimesTheLoad) {
    Parameters p;
    p.clamping.safety = 1.5;
    p.load.torque = TimeTable(200.0);
    const PulleyModel pulleys(p);
    auto block = turning(pulleys);
    const double carried = 2.0 * p.tip.friction.coefficient * p.pulley.arc_position / std::cos(p.tip.angle);
    EXPECT_NEAR(pulleys.inputs(0.0, block.data()).clamping[1], 1.5 * 200.0 / carried, 1e-6);
    EXPECT_EQ(pulleys.inputs(0.0, block.data()).clamping[0], 27.1e3);
    // The movable driven sheave, at -z, 1 mm further out: the chain runs 1 mm/(2 tan 11°) further in.
    block[static_cast<std::size_t>(pulleys.movable(1))] = -1e-3;
    const double radius = p.pulley.arc_position - 0.5e-3 / std::tan(p.tip.angle);
    EXPECT_NEAR(pulleys.running_radius(block.data(), 1), radius, 1e-15);
    EXPECT_NEAR(pulleys.inputs(0.0, block.data()).clamping[1], 300.0 / (carried * radius / p.pulley.arc_position), 1e-6);
    p.load.torque = TimeTable(20.0);
    EXPECT_EQ(PulleyModel(p).inputs(0.0, block.data()).clamping[1], 20e3) << "no less than the table";
}

TEST(Inputs, ControlOfSlipClampsTheDrivenSideHarderWhereItSlipsMore) {
    Parameters p;
    p.control.enabled = true;
    p.control.quantity = ControlledQuantity::slip;
    p.control.slip = TimeTable(0.02);
    p.control.proportional = 1e5;
    p.control.integral = 2e7;
    const PulleyModel pulleys(p);
    const Inputs in = pulleys.inputs(0.0, turning(pulleys, 3e-5).data());  // equal radii: slip 0.1
    EXPECT_NEAR(in.control_rate[0], 0.08, 1e-15);
    EXPECT_NEAR(in.clamping[1], 20e3 + 1e5 * 0.08 + 2e7 * 3e-5, 1e-6);
    EXPECT_EQ(in.clamping[0], 27.1e3);
    EXPECT_EQ(pulleys.inputs(0.0, turning(pulleys, 1.0).data()).control_rate[0], 0.0) << "it does not wind up";
    EXPECT_EQ(pulleys.inputs(0.0, std::vector<double>(2 * static_cast<std::size_t>(pulleys.size()) + 2).data()).control_rate[0], 0.0)
        << "at rest nothing slips";
}

/// S_2 of a controller of the safety factor alone, whose integral starts at zero, after `time`, with everything else at rest [N].
double controlled_force(const Parameters& p, double time, int steps) {
    const PulleyModel pulleys(p);
    const auto rate = [&](double integral) { return pulleys.inputs(0.0, turning(pulleys, integral).data()).control_rate[0]; };
    const double h = time / steps;
    double integral = 0.0;
    for (int k = 0; k < steps; ++k) {  // Runge-Kutta of order 4
        const double a = rate(integral), b = rate(integral + 0.5 * h * a), c = rate(integral + 0.5 * h * b), d = rate(integral + h * c);
        integral += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
    }
    return pulleys.inputs(0.0, turning(pulleys, integral).data()).clamping[1];
}

Parameters with_safety(double required, double torque) {
    Parameters p;
    p.load.torque = TimeTable(torque);
    p.control.enabled = true;
    p.control.quantity = ControlledQuantity::safety;
    p.control.safety = TimeTable(required);
    p.control.proportional = 1e4;
    p.control.integral = 5e6;
    p.control.authority = 5e4;
    return p;
}

double carried_per_force(const Parameters& p) { return 2.0 * p.tip.friction.coefficient * p.pulley.arc_position / std::cos(p.tip.angle); }

/// S' = K_I (1 - S/S_w) below the force that is required, S' = K_I (S_w/S - 1) above it: solved by hand.
TEST(Inputs, ControlOfTheSafetyFactorApproachesItAsTheoryHasIt) {
    const Parameters low = with_safety(1.5, 200.0);
    const double required = 1.5 * 200.0 / carried_per_force(low), time = 4e-3;
    ASSERT_GT(required, 20e3);
    const double from_below = required - (required - 20e3) * std::exp(-5e6 * time / required);
    EXPECT_NEAR(controlled_force(low, time, 200), from_below + 1e4 * (1.0 - from_below / required), 1e-3)
        << "the proportional part comes on top";

    Parameters high = with_safety(1.5, 100.0);
    high.control.proportional = 0.0;
    const double target = 1.5 * 100.0 / carried_per_force(high);
    ASSERT_LT(target, 20e3);
    const double force = controlled_force(high, time, 200);
    // t = ∫ S dS/(K_I (S_w - S)) from 20 kN down to S
    EXPECT_NEAR((20e3 - force + target * std::log((20e3 - target) / (force - target))) / 5e6, time, 1e-9);
}

TEST(Inputs, ControlOfTheSafetyFactorEndsAtTheWantedFactor) {
    for (const double torque : {100.0, 150.0, 200.0, -150.0}) {
        const Parameters p = with_safety(1.4, torque);
        const double force = controlled_force(p, 0.1, 1000);  // 20 time constants
        EXPECT_NEAR(carried_per_force(p) * force / std::abs(torque), 1.4, 1e-6) << torque;
    }
    Parameters unloaded = with_safety(1.4, 0.0);
    unloaded.control.authority = 1e4;
    EXPECT_NEAR(controlled_force(unloaded, 0.1, 1000), 20e3 - unloaded.control.authority, 1e-6) << "no further than it may";
    Parameters nothing = unloaded;
    nothing.clamping.driven = TimeTable(0.0);
    EXPECT_EQ(controlled_force(nothing, 0.1, 10), 0.0);
}

TEST(Inputs, TwoControllersHoldBothShaftsEachWithAnIntegralAndGainsOfItsOwn) {
    Parameters p;
    p.control.enabled = true;
    p.control.ratio = TimeTable(1.0);
    p.control.proportional = 1e4, p.control.integral = 2e7;
    p.control.slip = TimeTable(0.02);
    p.control.driven_proportional = 3e4, p.control.driven_integral = 4e7;
    const PulleyModel first(p);
    p.control.driven = DrivenControl::slip;
    const PulleyModel both(p);
    const auto block = turning(both, 3e-5, 5e-5);
    const Inputs alone = first.inputs(0.0, block.data()), together = both.inputs(0.0, block.data());
    EXPECT_EQ(together.clamping[0], alone.clamping[0]) << "what the first one does, it does beside the second";
    EXPECT_EQ(together.control_rate[0], alone.control_rate[0]);
    EXPECT_EQ(alone.clamping[1], 20e3);
    EXPECT_EQ(alone.control_rate[1], 0.0);
    EXPECT_NEAR(together.control_rate[1], 0.08, 1e-15);
    EXPECT_NEAR(together.clamping[1], 20e3 + 3e4 * 0.08 + 4e7 * 5e-5, 1e-6);
    EXPECT_FALSE(together.control_limited);
    EXPECT_TRUE(both.inputs(0.0, turning(both, 0.0, 1.0).data()).control_limited) << "the second one alone";
    EXPECT_GT(both.inputs(0.0, turning(both, 0.0, 1.0).data()).control_rate[0], 0.0);
}

/// Accelerations, and with them powers and the control's rate, are the oracle's, to 1e-12 of the largest.
TEST(Inputs, AreTheOracles) {
    const std::pair<const char*, std::function<void(Parameters&)>> changes[] = {
        {"load by speed", [](Parameters& p) { p.load.linear = 0.3, p.load.quadratic = 2e-3; }},
        {"clamping by torque", [](Parameters& p) { p.clamping.safety = 3.0; }},
        {"control of slip", [](Parameters& p) { p.control.enabled = true, p.control.quantity = ControlledQuantity::slip; }},
        {"control of safety", [](Parameters& p) { p.control.enabled = true, p.control.quantity = ControlledQuantity::safety; }},
        {"ratio and slip", [](Parameters& p) { p.control.enabled = true, p.control.driven = DrivenControl::slip; }},
        {"ratio and safety", [](Parameters& p) { p.control.enabled = true, p.control.driven = DrivenControl::safety; }},
        {"all", [](Parameters& p) {
             p.load.quadratic = 2e-3, p.clamping.safety = 3.0;
             p.control.enabled = true, p.control.quantity = ControlledQuantity::slip;
         }}};
    for (const auto& [name, change] : changes) {
        for (const PulleyDetail detail : {PulleyDetail::elastic, PulleyDetail::rigid}) {
            SCOPED_TRACE(name);
            Parameters p = oracle::small_scene();
            p.detail.pulleys = detail;
            change(p);
            const Variator variator(p);
            const auto at = oracle::random_state(p, 5);
            EvaluationScratch scratch(variator.layout());
            std::vector<double> slope(at.state.size());
            right_hand_side(variator, 1e-3, at.state.data(), at.phases.data(), slope.data(), scratch);
            const auto expected = oracle::right_hand_side(p, 1e-3, at.state, at.phases).slope;
            double largest = 0.0;
            for (const double each : expected) largest = std::max(largest, std::abs(each));
            for (int k = variator.layout().pulley_begin(); k < variator.layout().size(); ++k) {
                const std::size_t n = static_cast<std::size_t>(k);
                EXPECT_NEAR(slope[n], expected[n], 1e-12 * largest) << k;
            }
            for (int k = variator.layout().control_begin(); k < variator.layout().ledger_begin(); ++k) {
                const std::size_t n = static_cast<std::size_t>(k);
                EXPECT_NEAR(slope[n], expected[n], 1e-14) << "I'";
            }
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
