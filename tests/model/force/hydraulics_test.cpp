/// Cylinders, valves and pump against closed forms. (model/EQUATIONS.md section 8, hydraulics)

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "model/force/hydraulics.hpp"

namespace cvtflow::model {
namespace {

using Motion = std::array<CylinderMotion, 2>;

HydraulicModel model_of(const Hydraulics& hydraulics) {
    HydraulicModel model;
    model.adopt(hydraulics);
    return model;
}

Hydraulics usual_hydraulics() {
    Hydraulics h;
    h.mode = HydraulicMode::force;
    return h;
}

double& set_of(std::array<double, hydraulic_unknowns>& unknowns, std::size_t shaft) { return unknowns[shaft]; }
double& oil_of(std::array<double, hydraulic_unknowns>& unknowns, std::size_t shaft) { return unknowns[2 + shaft]; }
double stiffness(const Hydraulics& h, double area) { return area * h.oil_modulus / h.oil_volume; }

TEST(Hydraulics, RotatingOilPressesAsItsPressureOverTheRing) {
    Hydraulics h = usual_hydraulics();
    h.driving.inner = 31e-3;
    h.driven.compensation = 0.004;
    const HydraulicModel model = model_of(h);
    const double omega = 628.0;
    const auto summed = [&](double inner, double area) {  // midpoint rule over rings of equal width
        const double outer = std::sqrt(inner * inner + area / std::numbers::pi);
        constexpr int rings = 20000;
        const double width = (outer - inner) / rings;
        double force = 0.0;
        for (int k = 0; k < rings; ++k) {
            const double r = inner + (k + 0.5) * width;
            force += 0.5 * h.oil_density * omega * omega * (r * r - h.feed_radius * h.feed_radius) * 2.0 * std::numbers::pi * r * width;
        }
        return force;
    };
    const CylinderMotion turning{0.0, 0.0, omega};
    EXPECT_NEAR(model.other_force(0, turning), summed(31e-3, h.driving.area), 1e-6 * summed(31e-3, h.driving.area));
    EXPECT_NEAR(model.other_force(1, turning), summed(20e-3, 0.01) - summed(20e-3, 0.004), 1e-6 * summed(20e-3, 0.01));
    EXPECT_EQ(model.other_force(0, {}), 0.0);
}

TEST(Hydraulics, ASpringPushesLessTheFartherTheSheaveHasMoved) {
    Hydraulics h = usual_hydraulics();
    h.driven.spring = 1500.0;
    h.driven.spring_rate = 1e5;
    const HydraulicModel model = model_of(h);
    EXPECT_DOUBLE_EQ(model.other_force(1, {-5e-3, 0.0, 0.0}), 2000.0);
    EXPECT_EQ(model.other_force(1, {20e-3, 0.0, 0.0}), 0.0) << "it does not pull";
}

TEST(Hydraulics, FilledCylindersHaveTheForcesThatAreRequested) {
    const HydraulicModel model = model_of(usual_hydraulics());
    const Motion motion{CylinderMotion{1e-3, 0.0, 200.0}, CylinderMotion{-2e-3, 0.0, 150.0}};
    std::array<double, hydraulic_unknowns> unknowns{};
    model.fill(motion, {27e3, 20e3}, unknowns.data());
    const HydraulicInstant now = model.instant(unknowns.data(), motion, {27e3, 20e3}, 200.0);
    EXPECT_NEAR(now.force[0], 27e3, 1e-6);
    EXPECT_NEAR(now.force[1], 20e3, 1e-6);
    std::array<double, hydraulic_unknowns> rates{};
    model.rates(now, rates.data());
    EXPECT_NEAR(rates[2], 0.0, 1e-12) << "valves feed the leakage";
    EXPECT_NEAR(rates[3], 0.0, 1e-12);
}

/// A blocked piston fills through an open valve with the time constant C/(G + L).
TEST(Hydraulics, ABlockedCylinderFillsExponentially) {
    Hydraulics h = usual_hydraulics();
    h.leakage = 1e-10;
    const HydraulicModel model = model_of(h);
    std::array<double, hydraulic_unknowns> unknowns{}, rates{};
    const double capacity = h.oil_volume / h.oil_modulus, set = 1e5, step = 1e-8;
    set_of(unknowns, 1) = set / stiffness(h, h.driven.area);
    const double time_constant = capacity / (h.valve_conductance + h.leakage);
    HydraulicInstant now;
    for (int k = 0; k < 60000; ++k) {  // 0.6 ms, by Euler: errors of a step over a time constant
        now = model.instant(unknowns.data(), {}, {0.0, 0.0}, 1e4);
        model.rates(now, rates.data());
        oil_of(unknowns, 1) += step * rates[3];
    }
    const double end = set * h.valve_conductance / (h.valve_conductance + h.leakage);
    EXPECT_NEAR(now.pressure[1], end * (1.0 - std::exp(-0.6e-3 / time_constant)), 1e-4 * end);
}

/// A piston that moves against a constant force takes the whole flow of a small pump: its stroke lasts A Δy/Q.
TEST(Hydraulics, AStrokeLastsAsLongAsThePumpTakesToFillIt) {
    Hydraulics h = usual_hydraulics();
    h.leakage = 0.0;
    const HydraulicModel model = model_of(h);
    std::array<double, hydraulic_unknowns> unknowns{}, rates{};
    Motion motion{};
    const double force = 10e3, mass = 3.0, damping = 2e4, stroke = 5e-3, step = 2e-6, pump_speed = 100.0;
    set_of(unknowns, 0) = 5e6 / stiffness(h, h.driving.area);
    oil_of(unknowns, 0) = force / h.driving.area / stiffness(h, h.driving.area);
    double time = 0.0;
    for (; motion[0].position < stroke && time < 10.0; time += step) {
        const HydraulicInstant now = model.instant(unknowns.data(), motion, {1e6, 0.0}, pump_speed);
        model.rates(now, rates.data());
        motion[0].speed += step / mass * (now.force[0] - force - damping * motion[0].speed);
        motion[0].position += step * motion[0].speed;
        oil_of(unknowns, 0) += step * rates[2];
        EXPECT_EQ(now.spill, 0.0);
    }
    const double flow = h.pump_volumetric * h.pump_displacement * pump_speed / (2.0 * std::numbers::pi);
    EXPECT_NEAR(time, h.driving.area * stroke / flow, 0.01 * time);  // oil is compressed by c v/A, which takes 3e-4 of the time
}

/// Pump = losses + sheaves + change of the stored energy, at every instant, whatever the state.
TEST(Hydraulics, PowersBalanceAtEveryInstant) {
    Hydraulics h = usual_hydraulics();
    const HydraulicModel model = model_of(h);
    std::mt19937_64 random(7);
    const auto draw = [&](double from, double to) { return from + (to - from) * static_cast<double>(random() >> 11) * 0x1p-53; };
    const double capacity = h.oil_volume / h.oil_modulus;
    int starved = 0, sucking = 0;
    for (int k = 0; k < 1000; ++k) {
        std::array<double, hydraulic_unknowns> unknowns{}, rates{};
        Motion motion{CylinderMotion{draw(-5e-3, 5e-3), draw(-0.1, 0.1), 200.0}, CylinderMotion{draw(-5e-3, 5e-3), draw(-0.1, 0.1), 100.0}};
        for (std::size_t shaft = 0; shaft < 2; ++shaft) {
            const double area = shaft == 0 ? h.driving.area : h.driven.area;
            set_of(unknowns, shaft) = draw(0.0, 5e6) / stiffness(h, area);
            oil_of(unknowns, shaft) = motion[shaft].position + draw(-1e6, 5e6) / stiffness(h, area);
        }
        const HydraulicInstant now = model.instant(unknowns.data(), motion, {20e3, 20e3}, draw(0.0, 600.0));
        model.rates(now, rates.data());
        double stored = 0.0;
        for (std::size_t shaft = 0; shaft < 2; ++shaft) {
            const double area = shaft == 0 ? h.driving.area : h.driven.area;
            stored += capacity * now.pressure[shaft] * stiffness(h, area) * (rates[2 + shaft] - motion[shaft].speed);
        }
        const double scale = now.pump + std::abs(now.sheaves) + now.valves;
        EXPECT_NEAR(now.pump, now.lost() + now.sheaves + stored, 1e-11 * scale) << k;  // sums of terms that cancel
        for (const double loss : {now.mechanical, now.volumetric, now.relief, now.valves, now.leakage}) EXPECT_GE(loss, 0.0) << k;
        starved += now.spill == 0.0 ? 1 : 0;
        sucking += std::min(now.pressure[0], now.pressure[1]) < 0.0 ? 1 : 0;
    }
    EXPECT_GT(starved, 50);
    EXPECT_GT(sucking, 50);
}

TEST(Hydraulics, SetPressuresFollowWithinTheirRateAndEndAtTheReliefPressure) {
    Hydraulics h = usual_hydraulics();
    h.valve_rate = 2e7;
    const HydraulicModel model = model_of(h);
    std::array<double, hydraulic_unknowns> unknowns{}, rates{};
    const HydraulicInstant far = model.instant(unknowns.data(), {}, {1e6, 1e3}, 200.0);
    model.rates(far, rates.data());
    EXPECT_EQ(far.target[0], h.relief_pressure);
    EXPECT_DOUBLE_EQ(rates[0] * stiffness(h, h.driving.area), 2e7);
    EXPECT_DOUBLE_EQ(rates[1] * stiffness(h, h.driven.area), 1e3 / h.driven.area / h.valve_lag);
}

}  // namespace
}  // namespace cvtflow::model
