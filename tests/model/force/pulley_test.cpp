#include <gtest/gtest.h>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "model/force/pulley.hpp"
#include "model/variator/variator.hpp"
#include "tests/oracle/oracle_cases.hpp"

namespace cvtflow::model {
namespace {

constexpr double pi = std::numbers::pi;

std::vector<double> at_rest(const PulleyModel& pulleys) {
    return std::vector<double>(static_cast<std::size_t>(2 * pulleys.coordinates().size()), 0.0);
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
    const auto share = [&](double t) { return pulleys.inputs().at(t, block.data()).clamping[1] / 20e3; };
    EXPECT_EQ(share(-0.02), 0.0);
    EXPECT_NEAR(share(-0.01875), 0.15625, 1e-12);  // a quarter: x²(3 - 2x)
    EXPECT_NEAR(share(-0.0175), 0.5, 1e-12);
    for (const double t : {-0.015, -0.001, 0.0, 1.0}) EXPECT_EQ(share(t), 1.0) << t;
    EXPECT_NEAR(pulleys.inputs().at(-0.0175, block.data()).load_torque, -75.0, 1e-9);
    EXPECT_NEAR(pulleys.inputs().at(-0.0175, block.data()).clamping[0], 13.55e3, 1e-8);
}

TEST(PulleyInputs, TablesAreLinearAndTakenAtZeroBeforeZero) {
    Parameters p;
    p.load.torque = TimeTable({0.0, 0.01}, {100.0, 200.0});
    p.clamping.driving = TimeTable({0.002, 0.004}, {20e3, 30e3});
    const PulleyModel pulleys(p);
    const auto block = at_rest(pulleys);
    const auto inputs = [&](double t) { return pulleys.inputs().at(t, block.data()); };
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
            const auto drive = [&] { return pulleys.inputs().at(t, block.data()).drive_torque; };
            block[static_cast<std::size_t>(pulleys.coordinates().rotation(0))] = angle;
            block[static_cast<std::size_t>(pulleys.coordinates().size() + pulleys.coordinates().rotation(0))] =
                std::min(200.0 + 1000.0 * now, 300.0);
            EXPECT_NEAR(drive(), 0.0, 1e-9) << t;  // angles of 55 rad are known to 7e-15, the stiffness is 7e4
            block[static_cast<std::size_t>(pulleys.coordinates().rotation(0))] -= 150.0 / stiffness;
            EXPECT_NEAR(drive(), 150.0, 1e-8) << t;
            block[static_cast<std::size_t>(pulleys.coordinates().size() + pulleys.coordinates().rotation(0))] -= 1.0;
            EXPECT_NEAR(drive(), 150.0 + 2.0 * 0.046 * 2.0 * pi * 200.0, 1e-8) << "critically damped";
        }
    }
}

/// Target and value of ratio, of slip between equal radii, and of the safety factor: friction 2 μ S r/cos β over the load.
TEST(PulleyInputs, ControlStatesWhatItHoldsAndHowFarItIsOff) {
    Parameters p;
    const auto controlled = [&](ControlledQuantity quantity) {
        p.control.quantity = quantity;
        const PulleyModel pulleys(p);
        auto block = at_rest(pulleys);
        block.push_back(0.0);  // the integral
        block[static_cast<std::size_t>(pulleys.coordinates().size() + pulleys.coordinates().rotation(0))] = 200.0;
        block[static_cast<std::size_t>(pulleys.coordinates().size() + pulleys.coordinates().rotation(1))] = 190.0;
        return pulleys.inputs().controlled(0.0, block.data(), pulleys.inputs().at(0.0, block.data()));
    };
    EXPECT_EQ(controlled(ControlledQuantity::ratio).miss(), 0.0) << "no controller";
    p.control.enabled = true;
    p.control.ratio = TimeTable(1.25);
    p.control.slip = TimeTable(0.04);
    p.control.safety = TimeTable(1.6);
    p.control.proportional = 0.0;
    EXPECT_NEAR(controlled(ControlledQuantity::ratio).miss(), 200.0 / 190.0 / 1.25 - 1.0, 1e-15);
    EXPECT_NEAR(controlled(ControlledQuantity::slip).value, 0.05, 1e-15);
    EXPECT_NEAR(controlled(ControlledQuantity::slip).miss(), 0.25, 1e-13);
    const double carried = 2.0 * p.tip.friction.coefficient * 20e3 * p.pulley.arc_position / std::cos(p.tip.angle);
    EXPECT_NEAR(controlled(ControlledQuantity::safety).value, carried / 150.0, 1e-12);
    EXPECT_EQ(controlled(ControlledQuantity::safety).target, 1.6);
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

/// A sheave that whirls with its shaft at rest: k u - m ω² u = U ω², along the unbalance, and nothing turns it.
TEST(Pulleys, UnbalanceWhirlsAsTheResonanceCurveHasIt) {
    Parameters p;
    p.imperfection = {.sheave = Sheave::driven_fixed, .unbalance = 2e-3};
    p.pulley.damping_ratio = 0.0;
    const PulleyModel pulleys(p);
    const double stiffness = p.pulley.attachment_radial, mass = p.pulley.sheave_mass;
    const auto at = [](int freedom) { return static_cast<std::size_t>(body_freedom(sheave_body(1, 1), freedom)); };
    const std::size_t size = static_cast<std::size_t>(pulleys.coordinates().size());
    for (const double share : {0.1, 0.5, 2.0}) {  // of the resonance
        const double omega = share * std::sqrt(stiffness / mass), angle = 0.7;
        const double amplitude = 2e-3 * omega * omega / (stiffness - mass * omega * omega);
        auto block = at_rest(pulleys), slope = at_rest(pulleys);
        block[at(0)] = amplitude * std::cos(angle), block[at(1)] = amplitude * std::sin(angle), block[at(5)] = angle;
        block[size + at(0)] = -omega * block[at(1)], block[size + at(1)] = omega * block[at(0)], block[size + at(5)] = omega;
        block[static_cast<std::size_t>(pulleys.coordinates().rotation(1))] = angle;  // no torsion
        pulleys.slope(block.data(), {}, {}, slope.data(), nullptr);
        const double largest = std::abs(amplitude) * omega * omega;
        EXPECT_NEAR(slope[size + at(0)], -omega * omega * block[at(0)], 1e-12 * largest);
        EXPECT_NEAR(slope[size + at(1)], -omega * omega * block[at(1)], 1e-12 * largest);
        EXPECT_NEAR(slope[size + at(5)] * std::sqrt(p.pulley.sheave_polar_inertia / mass), 0.0, 1e-12 * largest);
    }
}

/// Pulleys that turn at 200 and 180 rad/s; behind them integrals of two controllers.
std::vector<double> turning(const PulleyModel& pulleys, double first = 0.0, double second = 0.0) {
    std::vector<double> block(static_cast<std::size_t>(2 * pulleys.coordinates().size()));
    block.insert(block.end(), {first, second});
    block[static_cast<std::size_t>(pulleys.coordinates().size() + pulleys.coordinates().rotation(0))] = 200.0;
    block[static_cast<std::size_t>(pulleys.coordinates().size() + pulleys.coordinates().rotation(1))] = 180.0;
    return block;
}

/// Slipping torque of one-dimensional theory: 2 mu S r/cos(beta).
TEST(Inputs, ClampingBySafetyCarriesThatManyTimesTheLoad) {
    Parameters p;
    p.clamping.safety = 1.5;
    p.load.torque = TimeTable(200.0);
    const PulleyModel pulleys(p);
    auto block = turning(pulleys);
    const double carried = 2.0 * p.tip.friction.coefficient * p.pulley.arc_position / std::cos(p.tip.angle);
    EXPECT_NEAR(pulleys.inputs().at(0.0, block.data()).clamping[1], 1.5 * 200.0 / carried, 1e-6);
    EXPECT_EQ(pulleys.inputs().at(0.0, block.data()).clamping[0], 27.1e3);
    // The movable driven sheave, at -z, 1 mm further out: the chain runs 1 mm/(2 tan 11°) further in.
    block[static_cast<std::size_t>(pulleys.coordinates().movable(1))] = -1e-3;
    const double radius = p.pulley.arc_position - 0.5e-3 / std::tan(p.tip.angle);
    EXPECT_NEAR(pulleys.coordinates().running_radius(block.data(), 1), radius, 1e-15);
    EXPECT_NEAR(pulleys.inputs().at(0.0, block.data()).clamping[1], 300.0 / (carried * radius / p.pulley.arc_position), 1e-6);
    p.load.torque = TimeTable(20.0);
    EXPECT_EQ(PulleyModel(p).inputs().at(0.0, block.data()).clamping[1], 20e3) << "no less than the table";
}

/// S_2 of a controller of the safety factor alone, whose integral starts at zero, after `time`, with everything else at rest [N].
double controlled_force(const Parameters& p, double time, int steps) {
    const PulleyModel pulleys(p);
    const auto rate = [&](double integral) { return pulleys.inputs().at(0.0, turning(pulleys, integral).data()).control_rate[0]; };
    const double h = time / steps;
    double integral = 0.0;
    for (int k = 0; k < steps; ++k) {  // Runge-Kutta of order 4
        const double a = rate(integral), b = rate(integral + 0.5 * h * a), c = rate(integral + 0.5 * h * b), d = rate(integral + h * c);
        integral += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
    }
    return pulleys.inputs().at(0.0, turning(pulleys, integral).data()).clamping[1];
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

/// S' = K_I (1 - S/S_w) below the force that is required, S' = K_I (S_w/S - 1) above it: closed form.
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

/// Machines with other inputs, by what they change.
std::vector<std::pair<const char*, std::function<void(Parameters&)>>> other_inputs() {
    const auto controlled = [](ControlledQuantity quantity, DrivenControl driven, double authority = 1e9) {
        return [=](Parameters& p) {
            p.control.enabled = true;
            p.control.quantity = quantity;
            p.control.driven = driven;
            p.control.authority = p.control.driven_authority = authority;
        };
    };
    using enum ControlledQuantity;
    return {{"load by speed",
             [](Parameters& p) {
                 p.load.linear = 0.3;
                 p.load.quadratic = 2e-3;
             }},
            {"drag",
             [](Parameters& p) {
                 p.drag = {.driving = {0.2, 1e-3, 3e-6}, .driven = {0.3, 2e-3, 1e-6}, .bearing_friction = 0.0015};
             }},
            {"clamping by torque", [](Parameters& p) { p.clamping.safety = 3.0; }},
            {"control of ratio", controlled(ratio, DrivenControl::none)},
            {"control of slip", controlled(slip, DrivenControl::none)},
            {"control of safety", controlled(safety, DrivenControl::none)},
            {"ratio and slip", controlled(ratio, DrivenControl::slip)},
            {"ratio and safety", controlled(ratio, DrivenControl::safety)},
            {"limited ratio and slip", controlled(ratio, DrivenControl::slip, 1e-3)},
            {"limited safety", controlled(safety, DrivenControl::none, 1e-3)},
            {"a cylinder that cannot pull",
             [=](Parameters& p) {
                 controlled(ratio, DrivenControl::none)(p);
                 p.clamping.driving = TimeTable(1e-3);
             }},
            {"limited beside load and clamping by torque", [=](Parameters& p) {
                 controlled(slip, DrivenControl::none, 1e4)(p);
                 p.load.quadratic = 2e-3;
                 p.clamping.safety = 3.0;
             }}};
}

/// Accelerations, and with them forces, torques and the control's rate, are the oracle's, to 1e-12 of the largest; and control
/// reports where it demands more than its authority.
TEST(Inputs, AreTheOracles) {
    for (const auto& [name, change] : other_inputs()) {
        for (const PulleyDetail detail : {PulleyDetail::elastic, PulleyDetail::rigid}) {
            for (const std::uint64_t seed : {5u, 6u, 8u}) {
                SCOPED_TRACE(std::string(name) + ", seed " + std::to_string(seed));
                Parameters p = oracle::small_scene();
                p.detail.pulleys = detail;
                change(p);
                const Variator variator(p);
                const auto at = oracle::random_state(p, seed);
                EvaluationScratch scratch(variator.layout());
                std::vector<double> slope(at.state.size());
                right_hand_side(variator, 1e-3, at.state.data(), at.phases.data(), slope.data(), scratch);
                const auto expected = oracle::right_hand_side(p, 1e-3, at.state, at.phases).slope;
                double largest = 0.0;
                for (const double each : expected) largest = std::max(largest, std::abs(each));
                for (std::size_t k = static_cast<std::size_t>(variator.layout().pulley_begin()); k < slope.size(); ++k) {
                    const bool of_control = static_cast<int>(k) >= variator.layout().control_begin();
                    EXPECT_NEAR(slope[k], expected[k], of_control ? 1e-14 : 1e-12 * largest) << k;
                }
                const Inputs inputs = variator.pulleys().inputs().at(1e-3, at.state.data() + variator.layout().pulley_begin());
                EXPECT_EQ(inputs.control_limited, std::string(name).starts_with("limited"));
            }
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
