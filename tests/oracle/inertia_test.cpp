#include <gtest/gtest.h>

#include <algorithm>

#include "tests/oracle/legendre.hpp"
#include "tests/oracle/oracle_cases.hpp"
#include "tests/oracle/system.hpp"

namespace cvtflow::oracle {
namespace {

Vec3 velocity_at(const Half& half, Real xi) { return in_space(half.rate_at(xi), half.z_rate + xi * half.e_rate); }

/// ½ ∫ |V|² dm over the half, its mass spread evenly along ξ.
Real energy_of_half(const model::Parameters& p, const Half& half) {
    Real sum = 0.0L;
    for (const auto& point : gauss_legendre(20)) {
        const Vec3 v = velocity_at(half, point.at);
        sum += 0.5L * p.half.mass * point.weight * dot(v, v);
    }
    return sum;
}

/// ½ ∫ |V|² dm along a plate that spans from rear to front half.
Real energy_of_plate(const Link& link, const PlateSpring& plate) {
    Real sum = 0.0L;
    for (const auto& point : gauss_legendre(5)) {
        const Real share = (1.0L + point.at) / 2.0L;
        const Vec3 v = (1.0L - share) * velocity_at(link.rear, plate.xi) + share * velocity_at(link.front, plate.xi);
        sum += 0.5L * plate.mass * point.weight * dot(v, v);
    }
    return sum;
}

Real energy_of_pulleys(const model::Parameters& p, const System& system) {
    if (p.detail.pulleys == model::PulleyDetail::absent) return 0.0L;
    const bool elastic = p.detail.pulleys == model::PulleyDetail::elastic;
    Real sum = 0.0L;
    for (int b = 0; b < bodies; ++b) {
        const Body& body = system.body[b];
        const Real added = b == 0 ? p.drive.inertia : b == 1 ? p.load.inertia : 0.0;
        const Real polar = added + (b < 2 ? p.pulley.shaft_polar_inertia : p.pulley.sheave_polar_inertia);
        const Real tilt = b < 2 ? p.pulley.shaft_tilt_inertia : p.pulley.sheave_tilt_inertia;
        const Real mass = b < 2 ? p.pulley.shaft_mass : p.pulley.sheave_mass;
        sum += 0.5L * polar * body.phi_rate * body.phi_rate + 0.5L * mass * body.w_rate * body.w_rate;
        if (elastic) sum += 0.5L * mass * dot(body.u_rate, body.u_rate) + 0.5L * tilt * dot(body.tau_rate, body.tau_rate);
    }
    return sum;
}

Real integrated_energy(const model::Parameters& p, const ExactState& at) {
    const System system = unpack(p, 0.0, at.state, at.phases);
    Real sum = energy_of_pulleys(p, system);
    for (const Link& link : system.links) {
        sum += energy_of_half(p, link.rear) + energy_of_half(p, link.front);
        for (const PlateSpring& plate : plate_springs(p)) sum += energy_of_plate(link, plate);
    }
    return sum;
}

TEST(Inertia, KineticEnergyIsThatOfTheMassesSpreadAlongHalvesAndPlates) {
    std::uint64_t seed = 700;
    for (const Case& one : all_details(small_scene())) {
        const ExactState at = exact_random_state(one.parameters, seed++);
        const auto result = exact_right_hand_side(one.parameters, 0.0, at.state, at.phases, false);
        const double expected = static_cast<double>(integrated_energy(one.parameters, at));
        EXPECT_NEAR(static_cast<double>(result.energies.kinetic), expected, 1e-14 * expected) << one.name;
    }
}

/// v·A·a by polarization of the integrated energy must be v·Q, for random v.
TEST(Inertia, AccelerationsTimesInertiaAreTheForces) {
    std::uint64_t seed = 900;
    for (const Case& one : all_details(small_scene())) {
        const auto layout = model::layout_of(one.parameters);
        const auto rates = rate_indices(layout);
        const ExactState at = exact_random_state(one.parameters, seed++);
        const auto result = exact_right_hand_side(one.parameters, 0.0, at.state, at.phases);
        ExactState plus = at;
        ExactState minus = at;
        Real expected = 0.0L;
        Real magnitude = 0.0L;
        for (int k = 0; k < layout.coordinates(); ++k) {
            // Scattered directions of the size of accelerations.
            const Real v = 1e6L * std::sin(static_cast<Real>(k * k + 1));
            plus.state[rates[k]] = result.slope[rates[k]] + v;
            minus.state[rates[k]] = result.slope[rates[k]] - v;
            expected += v * result.forces[k];
            magnitude += std::abs(v * result.forces[k]);
        }
        const Real product = 0.5L * (integrated_energy(one.parameters, plus) - integrated_energy(one.parameters, minus));
        EXPECT_NEAR(static_cast<double>(product), static_cast<double>(expected), 1e-11 * static_cast<double>(magnitude)) << one.name;
    }
}

TEST(Inertia, LumpedPlatesKeepMassStiffnessAndSecondMomentOfThePack) {
    model::Parameters parameters;
    const auto each = plate_springs(parameters);
    parameters.detail.plates = model::PlateDetail::lumped;
    const auto lumped = plate_springs(parameters);
    ASSERT_EQ(each.size(), 14u);
    ASSERT_EQ(lumped.size(), 2u);
    const auto moment = [](const std::vector<PlateSpring>& plates, int power) {
        Real sum = 0.0L;
        for (const auto& plate : plates) sum += plate.stiffness * std::pow(plate.xi, power);
        return static_cast<double>(sum);
    };
    for (const int power : {0, 1, 2}) EXPECT_NEAR(moment(lumped, power), moment(each, power), 1e-6) << power;
    EXPECT_NEAR(static_cast<double>(lumped[0].mass + lumped[1].mass), 14 * 0.65e-3, 1e-15);
}

/// Pulleys whose shafts and sheaves are free to tilt: no springs against tilting, no tips.
model::Parameters free_rotors() {
    model::Parameters p = small_scene();
    make_conservative(p);
    p.pulley.bearing_tilt = 0.0;
    p.pulley.attachment_tilt = 0.0;
    p.pulley.attachment_radial = 0.0;
    return p;
}

/// Everything at rest, tips free.
ExactState state_at_rest(const model::Parameters& p) {
    ExactState at = exact_random_state(p, 3);
    for (const int index : rate_indices(model::layout_of(p))) at.state[index] = 0.0L;
    std::fill(at.phases.begin(), at.phases.end(), model::Phase::free);
    return at;
}

/// Acceleration of a body's tilt for given tilting rates and spin [rad/s²], everything else at rest.
Vec2 tilt_acceleration(const model::Parameters& p, ExactState at, int body, Vec2 tilt_rate, Real spin) {
    const auto layout = model::layout_of(p);
    const auto rate = [&](int freedom) { return layout.pulley_begin() + layout.pulley_size + model::body_freedom(body, freedom); };
    at.state[rate(2)] = tilt_rate.x;
    at.state[rate(3)] = tilt_rate.y;
    at.state[rate(5)] = spin;
    const auto slope = exact_right_hand_side(p, 0.0, at.state, at.phases).slope;
    return {slope[rate(2)], slope[rate(3)]};
}

TEST(GyroscopicForce, DoesNoWork) {
    const model::Parameters p = free_rotors();
    const ExactState rest = state_at_rest(p);
    for (int body = 0; body < 6; ++body) {
        const Vec2 rate{0.3L, -0.7L};
        const Vec2 acceleration = tilt_acceleration(p, rest, body, rate, 200.0L);
        EXPECT_GT(norm(acceleration), 1.0L);
        EXPECT_NEAR(static_cast<double>(dot(rate, acceleration)), 0.0, 1e-12);
    }
}

TEST(GyroscopicForce, TurnsTheAxisOfAFastRotorTowardsTheMomentThatPushesIt) {
    const model::Parameters p = free_rotors();
    const ExactState rest = state_at_rest(p);
    // A kick about x makes the axis (τ_y, -τ_x, 1) move towards -y; the spin must bend this towards +x, the axis of the kick.
    for (int body = 0; body < 6; ++body) EXPECT_GT(tilt_acceleration(p, rest, body, {1.0L, 0.0L}, 200.0L).y, 0.0L) << body;
    for (int body = 0; body < 6; ++body) EXPECT_LT(tilt_acceleration(p, rest, body, {0.0L, 1.0L}, 200.0L).x, 0.0L) << body;
}

TEST(GyroscopicForce, KeepsTheAngularMomentumOfAFreeRotor) {
    const model::Parameters p = free_rotors();
    const ExactState rest = state_at_rest(p);
    const int body = model::sheave_body(0, 1);
    const Real spin = 200.0L;
    const Real polar = p.pulley.sheave_polar_inertia;
    const Real tilting = p.pulley.sheave_tilt_inertia;
    Vec2 tau;
    Vec2 rate{0.1L, 0.0L};
    const Real step = 2e-5L;
    for (int k = 0; k < 300; ++k) {  // midpoint rule
        const Vec2 middle = rate + (step / 2.0L) * tilt_acceleration(p, rest, body, rate, spin);
        tau += step * middle;
        rate += step * tilt_acceleration(p, rest, body, middle, spin);
    }
    // H = J_t τ' + J_p φ' (axis), axis = (τ_y, -τ_x): conserved from the kick J_t (0.1, 0).
    EXPECT_NEAR(static_cast<double>(tilting * rate.x + polar * spin * tau.y), static_cast<double>(tilting * 0.1L), 1e-6 * 4.2e-4);
    EXPECT_NEAR(static_cast<double>(tilting * rate.y - polar * spin * tau.x), 0.0, 1e-6 * 4.2e-4);
    EXPECT_GT(norm(tau), 0.0L);
}

}  // namespace
}  // namespace cvtflow::oracle
