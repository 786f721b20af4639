#include "tests/oracle/oracle_cases.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace cvtflow::oracle {
namespace {

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
