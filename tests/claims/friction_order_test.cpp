/// Claim: methods that solve for friction have their order where friction is smooth and counts, with the whole state; and the leapfrog is
/// stable while ω h < 2.

#include <gtest/gtest.h>

#include <cmath>

#include "bench/study/spectrum.hpp"
#include "engine/linear/eigenvalues.hpp"
#include "tasks/method/method_choice.hpp"
#include "tests/claims/method_trial_fixture.hpp"
#include "tests/claims/rig_fixture.hpp"
#include "tests/claims/smooth_fixture.hpp"

namespace cvtflow::claims {
namespace {

/// Friction below saturation, but as fast as elastic waves: λ of about 1e6 1/s.
Smooth with_friction(Smooth scene, double saturation_speed) {
    model::Parameters& p = scene.parameters;
    for (model::Friction* friction : {&p.plate.friction, &p.joint.friction, &p.tip.friction}) friction->saturation_speed = saturation_speed;
    return scene;
}

void expect_order(const Smooth& scene, const std::string& method, double order, const std::vector<int>& numbers) {
    const tasks::FrozenStart start{0.0, scene.state, scene.phases};
    const auto solution = [&](const std::string& name, int steps) {
        const bench::TrialEnd end = bench::try_method(scene.parameters, start, name, smooth_span / steps, smooth_span);
        EXPECT_FALSE(end.fault) << name;
        EXPECT_EQ(end.counters.truncated, 0);
        EXPECT_EQ(end.report.find("did not converge"), std::string::npos) << end.report;
        return end.state;
    };
    const std::vector<double> reference = solution("rk4", 1024);
    double above = 0.0;
    for (const int steps : numbers) {
        const double error = distance(solution(method, steps), reference);
        if (above > 0.0) {
            EXPECT_NEAR(std::log2(above / error), order, 0.15) << method << ": " << steps << " steps, error " << error;
        }
        above = error;
    }
}

/// Backward Euler shows its order where elasticity no longer covers it; below 1e-10 the reference ends.
TEST(FrictionOrder, OnAFreeRing) {
    const Smooth scene = with_friction(disturbed_ring(), 0.3);
    expect_order(scene, "leapfrog-be", 1.0, {192, 384, 768});
    expect_order(scene, "leapfrog-sdirk2", 2.0, {48, 96, 192});
    expect_order(scene, "ars343", 3.0, {48, 96});
    expect_order(scene, "ark436", 4.0, {6, 12, 24});
}

TEST(FrictionOrder, OnAChainClampedBetweenElasticSheaves) {
    const Smooth scene = with_friction(clamped_ring(), 1.0);
    expect_order(scene, "leapfrog-be", 1.0, {48, 96, 192});
    expect_order(scene, "leapfrog-sdirk2", 2.0, {48, 96, 192});
    expect_order(scene, "ars343", 3.0, {48, 96});
    expect_order(scene, "ark436", 4.0, {6, 12, 24});
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
    for (const std::string method : {"leapfrog-be", "leapfrog-sdirk2", "leapfrog-rkc"}) {
        EXPECT_FALSE(grows(method, 0.98)) << method << " " << fastest;
        EXPECT_TRUE(grows(method, 1.02)) << method << " " << fastest;
    }
}

}  // namespace
}  // namespace cvtflow::claims
