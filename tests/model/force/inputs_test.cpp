/// Inputs that depend on the motion: load by speed, clamping by torque, control of slip.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "model/variator.hpp"
#include "tests/oracle/oracle_cases.hpp"

namespace cvtflow::model {
namespace {

/// Pulleys that turn at 200 and 180 rad/s.
std::vector<double> turning(const PulleyModel& pulleys) {
    std::vector<double> block(static_cast<std::size_t>(2 * pulleys.size()));
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
    EXPECT_NEAR(pulleys.inputs(0.0, block.data(), 0.0).load_torque, -(10.0 + 18.0 + 32.4), 1e-12);
    block[static_cast<std::size_t>(pulleys.size() + pulleys.rotation(1))] = -180.0;
    EXPECT_NEAR(pulleys.inputs(0.0, block.data(), 0.0).load_torque, -(10.0 - 18.0 - 32.4), 1e-12);
}

/// What one-dimensional theory has as the torque that slips: 2 mu S r/cos(beta).
TEST(Inputs, ClampingBySafetyCarriesThatManyTimesTheLoad) {
    Parameters p;
    p.clamping.safety = 1.5;
    p.load.torque = TimeTable(200.0);
    const PulleyModel pulleys(p);
    auto block = turning(pulleys);
    const double carried = 2.0 * p.tip.friction.coefficient * p.pulley.arc_position / std::cos(p.tip.angle);
    EXPECT_NEAR(pulleys.inputs(0.0, block.data(), 0.0).clamping[1], 1.5 * 200.0 / carried, 1e-6);
    EXPECT_EQ(pulleys.inputs(0.0, block.data(), 0.0).clamping[0], 27.1e3);
    // The movable driven sheave, at -z, 1 mm further out: the chain runs 1 mm/(2 tan 11°) further in.
    block[static_cast<std::size_t>(pulleys.movable(1))] = -1e-3;
    const double radius = p.pulley.arc_position - 0.5e-3 / std::tan(p.tip.angle);
    EXPECT_NEAR(pulleys.running_radius(block.data(), 1), radius, 1e-15);
    EXPECT_NEAR(pulleys.inputs(0.0, block.data(), 0.0).clamping[1], 300.0 / (carried * radius / p.pulley.arc_position), 1e-6);
    p.load.torque = TimeTable(20.0);
    EXPECT_EQ(PulleyModel(p).inputs(0.0, block.data(), 0.0).clamping[1], 20e3) << "no less than the table";
}

TEST(Inputs, ControlOfSlipClampsTheDrivenSideHarderWhereItSlipsMore) {
    Parameters p;
    p.control.enabled = true;
    p.control.quantity = ControlledQuantity::slip;
    p.control.slip = TimeTable(0.02);
    p.control.proportional = 1e5;
    p.control.integral = 2e7;
    const PulleyModel pulleys(p);
    const auto block = turning(pulleys);  // equal radii: slip 0.1
    const Inputs in = pulleys.inputs(0.0, block.data(), 3e-5);
    EXPECT_NEAR(in.control_rate, 0.08, 1e-15);
    EXPECT_NEAR(in.clamping[1], 20e3 + 1e5 * 0.08 + 2e7 * 3e-5, 1e-6);
    EXPECT_EQ(in.clamping[0], 27.1e3);
    EXPECT_EQ(pulleys.inputs(0.0, block.data(), 1.0).control_rate, 0.0) << "it does not wind up";
    EXPECT_EQ(pulleys.inputs(0.0, std::vector<double>(block.size()).data(), 0.0).control_rate, 0.0) << "at rest nothing slips";
}

/// Accelerations, and with them powers and the control's rate, are the oracle's, to 1e-12 of the largest.
TEST(Inputs, AreTheOracles) {
    const std::pair<const char*, std::function<void(Parameters&)>> changes[] = {
        {"load by speed", [](Parameters& p) { p.load.linear = 0.3, p.load.quadratic = 2e-3; }},
        {"clamping by torque", [](Parameters& p) { p.clamping.safety = 3.0; }},
        {"control of slip", [](Parameters& p) { p.control.enabled = true, p.control.quantity = ControlledQuantity::slip; }},
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
            if (p.control.enabled) {
                EXPECT_NEAR(slope.back(), expected.back(), 1e-14) << "I'";
            }
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
