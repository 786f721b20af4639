#include "model/rigid/rigid_chain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>
#include <vector>

#include "model/observe/observation.hpp"
#include "model/start/start_state.hpp"
#include "model/variator/variator.hpp"
#include "tests/oracle/oracle_cases.hpp"

namespace cvtflow::model {
namespace {

Parameters chain_of(int pins, FrictionLaw law) {
    Parameters p;
    p.chain.pins = pins;
    p.detail.friction = law;
    return oracle::with_rigid_pins(p);
}

/// Velocities, forces and sliding speeds of the last two steps without any order; a quarter of the links does not pull.
RigidColumns filled_columns(const RigidModel& model, unsigned seed) {
    RigidColumns columns = model.columns();
    std::mt19937 random(seed);
    const auto between = [&](double low, double high) { return low + (high - low) * static_cast<double>(random() % 1000) / 999.0; };
    for (int pin = 0; pin < columns.pins(); ++pin) {
        columns.velocity.z[pin] = between(-0.05, 0.05);
        columns.velocity.slide[pin] = between(-0.05, 0.05);
        columns.force.z[pin] = between(-300.0, 300.0);
        columns.tip.force.z[pin] = between(-300.0, 300.0);
        columns.force.slide[pin] = between(-150.0, 150.0);
        columns.tip.force.slide[pin] = between(-150.0, 150.0);
        columns.joint.normal[pin] = std::max(0.0, between(-1000.0, 3000.0));
        for (const Row slip : {columns.joint.slip, columns.joint.slip_before}) slip[pin] = between(-0.03, 0.03);
        columns.plate.tension[pin] = std::max(0.0, between(-1000.0, 3000.0));
        for (const Row slip :
             {columns.plate.slip_low, columns.plate.slip_high, columns.plate.slip_low_before, columns.plate.slip_high_before})
            slip[pin] = between(-0.03, 0.03);
        columns.tip.lengthening[pin] = between(-0.03, 0.03);
    }
    columns.wrap({columns.velocity.z, columns.velocity.slide});
    columns.wrap({columns.force.z, columns.force.slide});
    columns.wrap({columns.tip.force.z, columns.tip.force.slide});
    columns.wrap(columns.plate.tension);
    columns.wrap({columns.plate.slip_low, columns.plate.slip_high_before});
    columns.wrap(columns.tip.lengthening);
    return columns;
}

/// Friction per sliding speed at a speed. (model/EQUATIONS.md section 7)
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
    const double both = columns.force.z[of] + columns.tip.force.z[of];
    const double apart = columns.force.slide[of] + columns.tip.force.slide[of];
    const double plates = half > 0.0 ? -columns.plate.friction[from] : columns.plate.friction[of];
    const double force = 0.5 * both + half * (apart - columns.joint.friction[of]) + plates;
    const double speed = columns.velocity.z[of] + 0.5 * half * columns.velocity.slide[of];
    return speed + step / (0.5 * model.coefficients().mass) * force;
}

/// Sliding speeds of all pins or links, extrapolated from the last two steps.
std::vector<double> expected_slips(const RigidColumns& columns, const double* slip, const double* before) {
    std::vector<double> speeds;
    for (int pin = 0; pin < columns.pins(); ++pin) speeds.push_back(std::abs(2.0 * slip[pin] - before[pin]));
    return speeds;
}

/// The friction of each half of a link's plates, and of the halves of a pin, is its grip times the sliding speed that all frictions
/// together leave behind. The grip is that at the sliding speed extrapolated from the last two steps.
TEST(RigidPlates, FrictionFollowsFromTheVelocitiesThatTheWholeChainLeavesBehind) {
    constexpr double step = 5e-6;
    for (const FrictionLaw law : {FrictionLaw::piecewise, FrictionLaw::smoothed}) {
        for (int pins = 3; pins < 210; pins += pins < 70 ? 1 : 14) {  // lanes have parts of equal and of different lengths
            SCOPED_TRACE(pins);
            const Parameters p = chain_of(pins, law);
            const RigidModel model(p);
            RigidColumns columns = filled_columns(model, static_cast<unsigned>(pins));
            const auto low = expected_slips(columns, columns.plate.slip_low, columns.plate.slip_low_before);
            const auto high = expected_slips(columns, columns.plate.slip_high, columns.plate.slip_high_before);
            const auto apart = expected_slips(columns, columns.joint.slip, columns.joint.slip_before);
            Account account;
            model.kernels().plate_friction(model.coefficients(), {step}, columns, account);
            model.kernels().joint_friction(model.coefficients(), {step}, columns, account);
            const double *friction = columns.plate.friction, *joint = columns.joint.friction;
            double largest = 0.0, held = 0.0;
            for (int pin = 0; pin < pins; ++pin) {
                const int next = (pin + 1) % pins, before = (pin + pins - 1) % pins;
                const auto after = [&](int of, int from, double half) { return speed_behind(model, columns, of, from, half, step); };
                const double slides = after(next, pin, 1.0) - after(pin, before, -1.0);
                const double parts = after(pin, before, 1.0) - after(pin, before, -1.0);
                const double holds = grip_of(p, p.joint.friction, columns.joint.normal[pin], apart[static_cast<std::size_t>(pin)]);
                EXPECT_NEAR(joint[pin], holds * parts, 1e-9) << pin;
                EXPECT_NEAR(columns.joint.slip[pin], parts, 1e-12) << pin;
                const double parting = model.coefficients().plate_reach * (columns.tip.lengthening[next] - columns.tip.lengthening[pin]);
                const double tension = 0.5 * columns.plate.tension[pin];
                const double at_low = grip_of(p, p.plate.friction, tension, low[static_cast<std::size_t>(pin)]) * (slides - parting);
                const double at_high = grip_of(p, p.plate.friction, tension, high[static_cast<std::size_t>(pin)]) * (slides + parting);
                EXPECT_NEAR(friction[pin], at_low + at_high, 1e-9) << pin;
                EXPECT_NEAR(columns.plate.moment[pin], at_high - at_low, 1e-9) << pin;
                EXPECT_NEAR(columns.plate.slip_low[pin], slides - parting, 1e-12) << pin;
                EXPECT_NEAR(columns.plate.slip_high[pin], slides + parting, 1e-12) << pin;
                largest = std::max(largest, std::abs(friction[pin]));
                held = std::max(held, std::abs(joint[pin]));
            }
            EXPECT_GT(std::min(largest, held), 10.0);
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
