#include "model/rigid/rigid_chain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>
#include <vector>

#include "model/rigid/rigid_plates.hpp"
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
        for (double* const slip : {columns.joint.slip, columns.joint.slip_before}) slip[pin] = between(-0.03, 0.03);
        columns.plate.tension[pin] = std::max(0.0, between(-1000.0, 3000.0));
        for (double* const slip :
             {columns.plate.slip_low, columns.plate.slip_high, columns.plate.slip_low_before, columns.plate.slip_high_before})
            slip[pin] = between(-0.03, 0.03);
        columns.tip.lengthening[pin] = between(-0.03, 0.03);
    }
    columns.wrap(RowRange{columns.velocity.z, columns.velocity.slide});
    columns.wrap(RowRange{columns.force.z, columns.force.slide});
    columns.wrap(RowRange{columns.tip.force.z, columns.tip.force.slide});
    columns.wrap(RowRange{columns.plate.tension});
    columns.wrap(RowRange{columns.plate.slip_low, columns.plate.slip_high_before});
    columns.wrap(RowRange{columns.tip.lengthening});
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

/// Sliding speeds of all pins or links, extrapolated from the last two steps.
std::vector<double> expected_slips(const RigidColumns& columns, const double* slip, const double* before) {
    std::vector<double> speeds;
    for (int pin = 0; pin < columns.pins(); ++pin) speeds.push_back(std::abs(2.0 * slip[pin] - before[pin]));
    return speeds;
}

/// The equations of the friction along the pins, link by link and pin by pin.
struct AxialFriction {
    AxialFriction(const Parameters& of, const RigidModel& rigid, const RigidColumns& at, double h)
        : p(of), model(rigid), columns(at), step(h), pins(at.pins()), friction(number(pins)) {}
    static std::size_t number(int n) { return static_cast<std::size_t>(n); }
    int around(int pin) const { return (pin + pins) % pins; }
    /// ζ' of a pin and sliding speed of a link by all forces but friction.
    double apart(int pin) const {
        const RigidCoefficients& c = model.coefficients();
        return columns.velocity.slide[pin] + step / c.slide_mass * (columns.force.slide[pin] + columns.tip.force.slide[pin]);
    }
    double along(int pin) const {
        return columns.velocity.z[pin] + step / model.coefficients().mass * (columns.force.z[pin] + columns.tip.force.z[pin]);
    }
    double parting(int link) const {
        return model.coefficients().plate_reach * (columns.tip.lengthening[around(link + 1)] - columns.tip.lengthening[link]);
    }
    void grip(const std::vector<double>& at_low, const std::vector<double>& at_high, const std::vector<double>& at_joint) {
        for (auto* each : {&low, &high, &joint}) each->clear();
        for (int k = 0; k < pins; ++k) {
            low.push_back(grip_of(p, p.plate.friction, 0.5 * columns.plate.tension[k], at_low[number(k)]));
            high.push_back(grip_of(p, p.plate.friction, 0.5 * columns.plate.tension[k], at_high[number(k)]));
            joint.push_back(grip_of(p, p.joint.friction, columns.joint.normal[k], at_joint[number(k)]));
        }
    }
    /// ζ' and the sliding speed that frictions of links leave, the joints' among them.
    double apart_after(int pin) const {
        const double slower = step / model.coefficients().slide_mass;
        return (apart(pin) - 0.5 * slower * (friction[number(around(pin - 1))] + friction[number(pin)])) /
               (1.0 + slower * joint[number(pin)]);
    }
    double slides_after(int link) const {
        const auto change = [&](int pin) { return friction[number(around(pin))] - friction[number(around(pin - 1))]; };
        const int next = around(link + 1);
        return along(next) - along(link) + step / model.coefficients().mass * (change(next) - change(link)) +
               0.5 * (apart_after(link) + apart_after(next));
    }
    /// Friction of a link for which it is that of the sliding speed it leaves, beside its neighbours'.
    double beside_neighbours(int link) {
        double& mine = friction[number(link)];
        const double given = mine, both = low[number(link)] + high[number(link)];
        const auto excess = [&](double of) {
            mine = of;
            return of - both * slides_after(link) - (high[number(link)] - low[number(link)]) * parting(link);
        };
        const double at_zero = excess(0.0), at_one = excess(1.0);
        mine = given;
        return at_zero / (at_zero - at_one);
    }
    void solve() {
        for (int sweep = 0; sweep < 3000; ++sweep) {
            for (int link = 0; link < pins; ++link) friction[number(link)] = beside_neighbours(link);
        }
    }
    const Parameters& p;
    const RigidModel& model;
    const RigidColumns& columns;
    double step;
    int pins;
    std::vector<double> friction, low, high, joint;
};

/// Frictions of all links after a solution with grips at extrapolated speeds, and grips at the speeds that it leaves.
void solve_as_a_step(AxialFriction& found) {
    const RigidColumns& columns = found.columns;
    found.grip(expected_slips(columns, columns.plate.slip_low, columns.plate.slip_low_before),
               expected_slips(columns, columns.plate.slip_high, columns.plate.slip_high_before),
               expected_slips(columns, columns.joint.slip, columns.joint.slip_before));
    found.solve();
    std::vector<double> at_low, at_high, at_joint, renewed;
    for (int pin = 0; pin < found.pins; ++pin) {
        at_low.push_back(std::abs(found.slides_after(pin) - found.parting(pin)));
        at_high.push_back(std::abs(found.slides_after(pin) + found.parting(pin)));
        at_joint.push_back(std::abs(found.apart_after(pin)));
    }
    found.grip(at_low, at_high, at_joint);
    for (int pin = 0; pin < found.pins; ++pin) renewed.push_back(found.beside_neighbours(pin));
    found.friction = renewed;
}

/// The friction of each half of a link's plates, and of the halves of a pin, is its grip times the sliding speed that all frictions
/// together leave behind, with the grip at the sliding speed extrapolated from the last two. Then grips are those at the speeds found, and
/// the friction of each link follows beside that of its neighbours.
void expect_friction(int pins, FrictionLaw law) {
    const RigidKick kick{5e-6};
    const Parameters p = chain_of(pins, law);
    const RigidModel model(p);
    RigidColumns columns = filled_columns(model, static_cast<unsigned>(pins));
    const RigidColumns before = columns;
    AxialFriction found(p, model, before, kick.until_friction());
    solve_as_a_step(found);
    Account account;
    plate_friction(model.coefficients(), kick, columns, account);
    joint_friction(model.coefficients(), kick, columns, account);
    double largest = 0.0, held = 0.0;
    for (int pin = 0; pin < pins; ++pin) {
        const std::size_t k = AxialFriction::number(pin);
        const double parts = found.apart_after(pin), slides = found.slides_after(pin), parting = found.parting(pin);
        EXPECT_NEAR(columns.plate.friction[pin], found.friction[k], 1e-8) << pin;
        EXPECT_NEAR(columns.joint.friction[pin], found.joint[k] * parts, 1e-8) << pin;
        EXPECT_NEAR(columns.joint.slip[pin], parts, 1e-11) << pin;
        EXPECT_NEAR(columns.plate.moment[pin], 2.0 * found.high[k] * (slides + parting) - found.friction[k], 1e-7) << pin;
        EXPECT_NEAR(columns.plate.slip_low[pin], slides - parting, 1e-11) << pin;
        EXPECT_NEAR(columns.plate.slip_high[pin], slides + parting, 1e-11) << pin;
        largest = std::max(largest, std::abs(columns.plate.friction[pin]));
        held = std::max(held, std::abs(columns.joint.friction[pin]));
    }
    EXPECT_GT(std::min(largest, held), 10.0);
}

TEST(RigidPlates, FrictionFollowsFromTheVelocitiesThatTheWholeChainLeavesBehind) {
    for (const FrictionLaw law : {FrictionLaw::piecewise, FrictionLaw::smoothed}) {
        for (int pins = 3; pins < 210; pins += pins < 40 ? 1 : 37) {  // lanes have parts of equal and of different lengths
            SCOPED_TRACE(pins);
            expect_friction(pins, law);
        }
    }
}

constexpr double wave_step = 8e-6, ring_spin = 150.0, ring_pitch = 8e-3;  // [s], [rad/s], [m]

/// A spinning ring, with the forces that keep its pins on their circle, or with any.
void fill_ring(const RigidModel& model, bool balanced, RigidColumns& columns) {
    const int pins = columns.pins();
    const double angle = 2.0 * std::acos(-1.0) / pins, radius = 0.5 * ring_pitch / std::sin(0.5 * angle);
    std::mt19937 random(7);
    const auto other = [&](double of_balance) { return balanced ? of_balance : static_cast<double>(random() % 2001) - 1000.0; };
    for (int pin = 0; pin < pins; ++pin) {
        columns.line.direction.x[pin] = std::cos(angle * (pin + 0.5));
        columns.line.direction.y[pin] = std::sin(angle * (pin + 0.5));
        columns.line.inverse[pin] = 1.0 / ring_pitch;
        columns.line.turn[pin] = ring_spin;
        const double inward = model.coefficients().mass * ring_spin * ring_spin * radius;
        columns.wave.force.x[pin] = other(-inward * std::sin(angle * pin));
        columns.wave.force.y[pin] = other(inward * std::cos(angle * pin));
        columns.wave.end_force.x[pin] = other(0.0);
        columns.wave.end_force.y[pin] = other(0.0);
    }
    columns.wrap(columns.line.rows());
}

/// The filter of the waves adds to the forces of stretch and yaw of each link what β h² u'' adds to these, and nothing to a chain whose
/// links neither lengthen nor yaw faster: a ring that spins.
TEST(RigidLinks, FilterAddsTheForcesOfWhatLinksAccelerateBy) {
    const RigidModel model(chain_of(21, FrictionLaw::piecewise));
    const RigidCoefficients& c = model.coefficients();
    for (const bool balanced : {true, false}) {
        RigidColumns columns = model.columns();
        fill_ring(model, balanced, columns);
        Account account;
        filter_waves(c, {wave_step}, columns, account);
        const PlaneRowOf<double>& t = columns.line.direction;
        const double share = wave_filter * wave_step * wave_step;
        const auto along = [&](const PlaneRowOf<double>& of, int link) {
            const int next = (link + 1) % columns.pins();
            return t.x[link] * (of.x[next] - of.x[link]) + t.y[link] * (of.y[next] - of.y[link]);
        };
        const auto pull = [&](int link) {
            return share * c.pull.stiffness * (along(columns.wave.force, link) / c.mass + ring_spin * ring_spin * ring_pitch);
        };
        const auto yaw = [&](int link) {
            return share * columns.constants.yaw_stiffness[link] * along(columns.wave.end_force, link) / c.tilt_mass;
        };
        double largest = 0.0;
        for (int pin = 0; pin < columns.pins(); ++pin) {
            const int behind = (pin + columns.pins() - 1) % columns.pins();
            EXPECT_NEAR(columns.force.middle.x[pin], pull(pin) * t.x[pin] - pull(behind) * t.x[behind], 1e-9) << pin;
            EXPECT_NEAR(columns.force.middle.y[pin], pull(pin) * t.y[pin] - pull(behind) * t.y[behind], 1e-9) << pin;
            EXPECT_NEAR(columns.force.end.x[pin], yaw(pin) * t.x[pin] - yaw(behind) * t.x[behind], 1e-9) << pin;
            EXPECT_NEAR(columns.force.end.y[pin], yaw(pin) * t.y[pin] - yaw(behind) * t.y[behind], 1e-9) << pin;
            largest = std::max(largest, std::abs(columns.force.middle.x[pin]));
        }
        EXPECT_TRUE(balanced ? largest < 1e-9 : largest > 10.0) << largest;
    }
}

}  // namespace
}  // namespace cvtflow::model
