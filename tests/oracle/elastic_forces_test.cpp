#include "tests/oracle/oracle_cases.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace cvtflow::oracle {
namespace {

constexpr Real pi = std::numbers::pi_v<Real>;

/// Generalized forces on the pulleys that no potential has: drive, load, clamping with its control, and gyroscopic, at t ≥ 0.
std::vector<Real> input_forces(const model::Parameters& p, double t, const std::vector<Real>& state) {
    const auto layout = model::layout_of(p);
    std::vector<Real> force(layout.pulley_size, 0.0L);
    if (layout.pulley_size == 0) return force;
    const bool elastic = p.detail.pulleys == model::PulleyDetail::elastic;
    const auto q = [&](int k) { return state[layout.pulley_begin() + k]; };
    const auto v = [&](int k) { return state[layout.pulley_begin() + layout.pulley_size + k]; };
    const int phi[] = {elastic ? model::body_freedom(0, 5) : 0, elastic ? model::body_freedom(1, 5) : 1};
    const int movable[] = {elastic ? model::body_freedom(model::sheave_body(0, 1), 4) : 2,
                           elastic ? model::body_freedom(model::sheave_body(1, 0), 4) : 3};

    const Real inertia = Real{p.pulley.shaft_polar_inertia} + 2.0L * p.pulley.sheave_polar_inertia + p.drive.inertia;
    const Real omega = 2.0L * pi * p.drive.governor_frequency;
    force[phi[0]] +=
        inertia * omega * omega * (p.drive.speed.integral(t) - q(phi[0])) + 2.0L * inertia * omega * (p.drive.speed.at(t) - v(phi[0]));
    force[phi[1]] -= p.load.torque.at(t);
    Real clamping[] = {p.clamping.driving.at(t), p.clamping.driven.at(t)};
    if (layout.controls != 0) {
        const Real error = (v(phi[0]) - p.control.ratio.at(t) * v(phi[1])) / p.drive.speed.largest_magnitude();
        const Real integral = state[layout.control_begin()];
        const Real authority = p.control.authority;
        clamping[0] =
            std::max(0.0L, clamping[0] + std::clamp(p.control.proportional * error + p.control.integral * integral, -authority, authority));
    }
    force[movable[0]] -= clamping[0];
    force[movable[1]] += clamping[1];
    if (!elastic) return force;
    force[model::body_freedom(0, 4)] += clamping[0];
    force[model::body_freedom(1, 4)] -= clamping[1];
    const Real shaft_polar = p.pulley.shaft_polar_inertia;
    const Real sheave_polar = p.pulley.sheave_polar_inertia;
    const Real shafts[] = {shaft_polar + p.drive.inertia, shaft_polar + p.load.inertia};
    for (int b = 0; b < 6; ++b) {
        const Real spin = (b < 2 ? shafts[b] : sheave_polar) * v(model::body_freedom(b, 5));
        force[model::body_freedom(b, 2)] -= spin * v(model::body_freedom(b, 3));
        force[model::body_freedom(b, 3)] += spin * v(model::body_freedom(b, 2));
    }
    return force;
}

/// Central difference of the potential energy along one entry of the state.
Real gradient(const model::Parameters& parameters, ExactState at, int index, Real step) {
    const Real here = at.state[index];
    at.state[index] = here + step;
    const Real above = potential_energy(parameters, at);
    at.state[index] = here - step;
    const Real below = potential_energy(parameters, at);
    return (above - below) / (2.0L * step);
}

/// Rounding of depths against lengths of 2 m (2e-19 m · 1e4 N / h), with h = 1e-10 m and energies of ~1 J known to ~1e-19, leaves ~2e-5 N;
/// truncation h² V''' is largest where Hertz and Palmgren contacts open, K h²/sqrt(δ) and less: ~1e-5 N.
void expect_gradient(const model::Parameters& parameters, double t, std::uint64_t seed) {
    const auto layout = model::layout_of(parameters);
    const ExactState at = exact_random_state(parameters, seed);
    const auto result = exact_right_hand_side(parameters, t, at.state, at.phases, false);
    const auto inputs = input_forces(parameters, t, at.state);
    const auto indices = coordinate_indices(layout);
    const int first_pulley = layout.links * layout.link_size();
    for (int k = 0; k < layout.coordinates(); ++k) {
        const Real input = k < first_pulley ? 0.0L : inputs[k - first_pulley];
        const Real expected = input - gradient(parameters, at, indices[k], 1e-10L);
        const double tolerance = 5e-4 + 1e-9 * std::abs(static_cast<double>(expected));
        ASSERT_NEAR(static_cast<double>(result.forces[k]), static_cast<double>(expected), tolerance)
            << "coordinate " << k << " of " << layout.coordinates();
    }
    for (const Real loss : result.powers.losses) EXPECT_EQ(loss, 0.0L);
}

TEST(ElasticForces, AreTheNegativeGradientOfThePotentialEnergyPlusInputs) {
    model::Parameters base = small_scene();
    make_conservative(base);
    base.control.enabled = true;
    std::uint64_t seed = 1;
    for (const Case& one : all_details(base)) {
        SCOPED_TRACE(one.name);
        expect_gradient(one.parameters, 0.0, seed++);
    }
    for (Case& one : rigid_details(base)) {
        if (one.parameters.detail.mass_scaling != 1.0) continue;
        SCOPED_TRACE(one.name);
        make_conservative(one.parameters);
        expect_gradient(one.parameters, 0.0, seed++);
    }
}

TEST(ElasticForces, AreTheNegativeGradientForAFullChainInOneDirection) {
    for (const double ratio : {0.6, 1.0, 1.7}) {
        model::Parameters parameters;
        make_conservative(parameters);
        parameters.start.ratio = ratio;
        ExactState at = exact_random_state(parameters, 5);
        const auto layout = model::layout_of(parameters);
        const auto coordinates = coordinate_indices(layout);
        const auto rates = rate_indices(layout);
        const auto result = exact_right_hand_side(parameters, 0.0, at.state, at.phases, false);
        Real power = -result.powers.works[0] - result.powers.works[1] - result.powers.works[2];
        for (std::size_t k = 0; k < coordinates.size(); ++k) power += result.forces[k] * at.state[rates[k]];
        const Real step = 1e-11L;
        ExactState before = at;
        for (std::size_t k = 0; k < coordinates.size(); ++k) {
            before.state[coordinates[k]] -= step * at.state[rates[k]];
            at.state[coordinates[k]] += step * at.state[rates[k]];
        }
        const Real change = (potential_energy(parameters, at) - potential_energy(parameters, before)) / (2.0L * step);
        EXPECT_NEAR(static_cast<double>(power), static_cast<double>(-change), 1e-2) << "ratio " << ratio;
    }
}

}  // namespace
}  // namespace cvtflow::oracle
