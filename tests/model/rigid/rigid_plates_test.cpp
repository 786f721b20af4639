#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "model/rigid/rigid_chain.hpp"
#include "tests/oracle/oracle_cases.hpp"

namespace cvtflow::model {
namespace {

Parameters chain_of(int pins, FrictionLaw law) {
    Parameters p;
    p.chain.pins = pins;
    p.detail.friction = law;
    return oracle::with_rigid_pins(p);
}

/// Velocities, forces and kept sliding speeds without any order; a quarter of the links does not pull.
void fill(RigidColumns& columns, unsigned seed) {
    std::mt19937 random(seed);
    const auto between = [&](double low, double high) { return low + (high - low) * static_cast<double>(random() % 1000) / 999.0; };
    for (int pin = 0; pin < columns.pins(); ++pin) {
        columns[Column::vz][pin] = between(-0.05, 0.05);
        columns[Column::vslide][pin] = between(-0.05, 0.05);
        columns[Column::force_z][pin] = between(-300.0, 300.0);
        columns[Column::tip_force_z][pin] = between(-300.0, 300.0);
        columns[Column::force_slide][pin] = between(-150.0, 150.0);
        columns[Column::tip_force_slide][pin] = between(-150.0, 150.0);
        columns[Column::joint_normal][pin] = std::max(0.0, between(-1000.0, 3000.0));
        columns[Column::joint_slip][pin] = between(0.0, 0.03);
        columns[Column::tension][pin] = std::max(0.0, between(-1000.0, 3000.0));
        columns[Column::plate_slip_low][pin] = between(0.0, 0.03);
        columns[Column::plate_slip_high][pin] = between(0.0, 0.03);
        columns[Column::lengthening][pin] = between(-0.03, 0.03);
    }
    columns.wrap(Column::vz, Column::vslide);
    columns.wrap(Column::force_z, Column::force_slide);
    columns.wrap(Column::tip_force_z, Column::tip_force_slide);
    columns.wrap(Column::tension, Column::tension);
    columns.wrap(Column::plate_slip_low, Column::plate_slip_high);
    columns.wrap(Column::lengthening, Column::lengthening);
}

/// Friction per sliding speed at a kept speed. (model/EQUATIONS.md section 7)
double grip_of(const Parameters& p, const Friction& friction, double normal, double speed) {
    const double v0 = friction.saturation_speed, d = p.detail.friction == FrictionLaw::piecewise ? 0.0 : p.detail.smoothing;
    const double beyond = speed - (1.0 - d) * v0;
    double secant = 1.0 / std::max(speed, v0);
    if (std::abs(speed - v0) < d * v0) secant = 1.0 / v0 - beyond * beyond / (4.0 * d * v0 * v0) / speed;
    return friction.coefficient * normal * secant;
}

/// Speed of the front (+1) or rear (-1) half of pin `of` behind a step: half of the pin's mass each, held by its link (of the front half
/// that of pin `from`) and by the other half.
double speed_behind(const RigidModel& model, const RigidColumns& columns, int of, int from, double half, double step) {
    const double both = columns[Column::force_z][of] + columns[Column::tip_force_z][of];
    const double apart = columns[Column::force_slide][of] + columns[Column::tip_force_slide][of];
    const double plates = half > 0.0 ? -columns[Column::plate_friction][from] : columns[Column::plate_friction][of];
    const double force = 0.5 * both + half * (apart - columns[Column::joint_friction][of]) + plates;
    const double speed = columns[Column::vz][of] + 0.5 * half * columns[Column::vslide][of];
    return speed + step / (0.5 * model.coefficients().mass) * force;
}

/// The friction of each half of a link's plates, and of the halves of a pin, is its grip times the sliding speed that all frictions
/// together leave behind.
TEST(RigidPlates, FrictionFollowsFromTheVelocitiesThatTheWholeChainLeavesBehind) {
    constexpr double step = 5e-6;
    for (const FrictionLaw law : {FrictionLaw::piecewise, FrictionLaw::smoothed}) {
        for (const int pins : {3, 4, 7, 8, 9, 15, 16, 17, 23, 24, 84, 85, 200}) {
            SCOPED_TRACE(pins);
            const Parameters p = chain_of(pins, law);
            const RigidModel model(p);
            RigidColumns columns = model.columns();
            fill(columns, static_cast<unsigned>(pins));
            const auto copy_of = [&](Column c) { return std::vector<double>(columns[c], columns[c] + pins); };
            const auto low = copy_of(Column::plate_slip_low), high = copy_of(Column::plate_slip_high), kept = copy_of(Column::joint_slip);
            Account account;
            model.kernels().plate_friction(model.coefficients(), {step}, columns, account);
            model.kernels().joint_friction(model.coefficients(), {step}, columns, account);
            const double *friction = columns[Column::plate_friction], *joint = columns[Column::joint_friction];
            double largest = 0.0, held = 0.0;
            for (int pin = 0; pin < pins; ++pin) {
                const int next = (pin + 1) % pins, before = (pin + pins - 1) % pins;
                const auto after = [&](int of, int from, double half) { return speed_behind(model, columns, of, from, half, step); };
                const double slides = after(next, pin, 1.0) - after(pin, before, -1.0);
                const double parts = after(pin, before, 1.0) - after(pin, before, -1.0);
                const double holds = grip_of(p, p.joint.friction, columns[Column::joint_normal][pin], kept[static_cast<std::size_t>(pin)]);
                EXPECT_NEAR(joint[pin], holds * parts, 1e-9) << pin;
                EXPECT_NEAR(columns[Column::joint_slip][pin], std::abs(parts), 1e-12) << pin;
                const double parting =
                    model.coefficients().plate_reach * (columns[Column::lengthening][next] - columns[Column::lengthening][pin]);
                const double tension = 0.5 * columns[Column::tension][pin];
                const double at_low = grip_of(p, p.plate.friction, tension, low[static_cast<std::size_t>(pin)]) * (slides - parting);
                const double at_high = grip_of(p, p.plate.friction, tension, high[static_cast<std::size_t>(pin)]) * (slides + parting);
                EXPECT_NEAR(friction[pin], at_low + at_high, 1e-9) << pin;
                EXPECT_NEAR(columns[Column::plate_friction_moment][pin], at_high - at_low, 1e-9) << pin;
                EXPECT_NEAR(columns[Column::plate_slip_low][pin], std::abs(slides - parting), 1e-12) << pin;
                EXPECT_NEAR(columns[Column::plate_slip_high][pin], std::abs(slides + parting), 1e-12) << pin;
                largest = std::max(largest, std::abs(friction[pin]));
                held = std::max(held, std::abs(joint[pin]));
            }
            EXPECT_GT(std::min(largest, held), 10.0);
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
