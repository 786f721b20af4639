/// Claims about the order and the stability of methods on smooth motions of the variator: the classical Runge-Kutta method converges with
/// its order, 4; the linearly implicit methods and the trapezoidal rule have theirs, with the whole state (chain and elastic pulleys);
/// leapfrogs are stable while ω h < 2.

#include <gtest/gtest.h>

#include <cmath>

#include "bench/study/spectrum.hpp"
#include "tasks/method/method.hpp"
#include "tests/claims/method_trial_fixture.hpp"
#include "tests/claims/rig_fixture.hpp"

namespace cvtflow::claims {
namespace {

/// A scene whose right-hand side is smooth where it goes: friction everywhere below saturation, so linear in speed; all else in contact.
struct Smooth {
    model::Parameters parameters;
    std::vector<double> state;
    std::vector<model::Phase> phases;
};

constexpr double smooth_span = 1.6e-6;  ///< s: a period of the fastest waves, too short for a tip to come or go

void soften(model::Parameters& p) {
    p.detail.friction = model::FrictionLaw::smoothed;
    p.detail.smoothing = 0.5;
    for (model::Friction* friction : {&p.plate.friction, &p.joint.friction, &p.tip.friction}) friction->saturation_speed = 1e3;
    p.joint.clearance = 1e-3;  // the opening's spring begins beyond reach
}

/// Every coordinate of the chain gets a speed of its own.
void jolt(const model::ChainLayout& at, std::vector<double>& state) {
    for (int link = 0; link < at.links; ++link) {
        for (int k = 0; k < at.link_size(); ++k)
            state[static_cast<std::size_t>(at.link_begin(link) + at.link_size() + k)] += 0.02 * std::sin(1.0 + link + 3.0 * k);
    }
}

/// A free ring that turns fast, every coordinate with a speed of its own.
Smooth disturbed_ring() {
    model::Parameters p;
    p.detail.pulleys = model::PulleyDetail::absent;
    p.start.layout = model::StartLayout::ring;
    p.chain.pins = 24;
    p.start.ring_speed = 600.0;
    soften(p);
    Rig rig(p);
    Smooth scene{p, rig.state_copy(), rig.phases()};
    jolt(rig.variator().layout(), scene.state);
    return scene;
}

/// A ring around shaft 1, clamped between its elastic sheaves and turning: every tip deep in contact, none about to leave.
Smooth clamped_ring() {
    model::Parameters p;
    soften(p);
    p.start.layout = model::StartLayout::ring;
    p.start.ring_speed = 200.0;
    p.start.settling_time = p.start.ramp_time = 1e-3;
    p.chain.pins = 13;
    p.pulley.arc_position = 16.8e-3;
    p.pulley.innermost = 10e-3;
    p.drive.speed = model::TimeTable(200.0);
    p.load.torque = model::TimeTable(0.0);
    p.clamping = {model::TimeTable(15e3), model::TimeTable(0.0)};
    Rig rig(p);
    EXPECT_FALSE(rig.run({-1e-3, 0.0, 5e-8, 1e-3}));
    Smooth scene{p, rig.state_copy(), rig.phases()};
    for (const model::Phase phase : scene.phases) EXPECT_EQ(phase, model::Phase::touching);
    jolt(rig.variator().layout(), scene.state);
    return scene;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double square = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) square += (a[k] - b[k]) * (a[k] - b[k]);
    return std::sqrt(square);
}

std::vector<double> solution(const Smooth& scene, double step) {
    Rig rig(scene.parameters, scene.state, scene.phases);
    EXPECT_FALSE(rig.run({0.0, smooth_span, step, smooth_span}));
    EXPECT_EQ(rig.counters().truncated, 0);
    return rig.state_copy();
}

void expect_fourth_order(const Smooth& scene) {
    const std::vector<double> reference = solution(scene, smooth_span / 256);  // its own error is 4⁴ times smaller than the finest one's
    std::vector<double> errors;
    for (const int steps : {8, 16, 32, 64}) errors.push_back(distance(solution(scene, smooth_span / steps), reference));
    for (std::size_t k = 1; k < errors.size(); ++k) {
        EXPECT_NEAR(std::log2(errors[k - 1] / errors[k]), 4.0, 0.25) << "errors " << errors[k - 1] << " and " << errors[k];
    }
}

TEST(Rk4, ConvergesWithOrderFourOnAFreeRing) { expect_fourth_order(disturbed_ring()); }
TEST(Rk4, ConvergesWithOrderFourOnAChainClampedBetweenElasticSheaves) { expect_fourth_order(clamped_ring()); }

/// Slopes of the error over these numbers of steps in the span, against 512 steps of rk4.
void expect_order(const Smooth& scene, const std::string& method, const std::vector<int>& numbers) {
    const tasks::FrozenStart start{0.0, scene.state, scene.phases};
    const auto solution = [&](const std::string& name, int steps) {
        const bench::TrialEnd end = bench::try_method(scene.parameters, start, name, smooth_span / steps, smooth_span);
        EXPECT_FALSE(end.fault) << name;
        EXPECT_EQ(end.counters.truncated, 0);
        return end.state;
    };
    static const std::vector<double> nothing;
    const std::vector<double> reference = solution("rk4", 512);
    double above = 0.0;
    for (const int steps : numbers) {
        const double error = distance(solution(method, steps), reference);
        if (above > 0.0) {
            EXPECT_NEAR(std::log2(above / error), tasks::find_program(method)->order, 0.15)
                << method << ": " << steps << " steps, error " << error;
        }
        above = error;
    }
}

TEST(ImplicitOrder, OnAChainClampedBetweenElasticSheaves) {
    const Smooth scene = clamped_ring();
    for (const char* method : {"trapezoidal-analytic", "sw2", "w-x2", "ros34pw2", "w-x3"}) expect_order(scene, method, {48, 96, 192});
}

TEST(ImplicitOrder, OnAFreeRing) {
    const Smooth scene = disturbed_ring();
    for (const char* method : {"trapezoidal-analytic", "sw2", "ros34pw2"}) expect_order(scene, method, {48, 96, 192});
}

/// A ring without friction and damping swings; its fastest mode (extension of the pins) does not depend on where it is.
TEST(FrictionOrder, LeapfrogsAreStableToTheImaginaryBoundaryWithinTwoPercent) {
    model::Parameters p;
    p.detail.pulleys = model::PulleyDetail::absent;
    p.detail.order = 1;
    p.start.layout = model::StartLayout::ring;
    p.chain.pins = 12;
    p.start.ring_speed = 600.0;
    make_conservative(p);
    const Rig start(p);
    double fastest = 0.0;
    for (const auto& value : bench::spectrum(start.variator(), 0.0, start.state_copy(), start.phases()))
        fastest = std::max(fastest, std::abs(value.imag()));
    // Saturating contacts bound what is unstable: two runs are compared that begin a picometre apart.
    const auto grows = [&](const std::string& method, double share) {
        std::vector<double> state = start.state_copy();
        const double h = share * 2.0 / fastest;
        const bench::TrialEnd one = bench::try_method(p, {0.0, state, start.phases()}, method, h, 60.0 * h);
        for (std::size_t k = 0; k < state.size(); ++k) state[k] += 1e-12 * std::sin(1.0 + 2.399 * static_cast<double>(k));
        const bench::TrialEnd other = bench::try_method(p, {0.0, state, start.phases()}, method, h, 60.0 * h);
        return one.fault || other.fault || distance(one.state, other.state) > 1e-3;
    };
    for (const std::string method : {"leapfrog-chebyshev", "leapfrog-sweep", "leapfrog-rkc"}) {
        EXPECT_FALSE(grows(method, 0.98)) << method << " " << fastest;
        EXPECT_TRUE(grows(method, 1.02)) << method << " " << fastest;
    }
}

}  // namespace
}  // namespace cvtflow::claims
