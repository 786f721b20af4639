/// Claims about methods of the laboratory on smooth motions of the variator: the linearly implicit ones and the trapezoidal rule have their
/// order, with the whole state (chain and elastic pulleys); leapfrogs are stable while ω h < 2.

#include <gtest/gtest.h>

#include <cmath>

#include "bench/study/spectrum.hpp"
#include "tasks/method/method.hpp"
#include "tasks/method/spectral_bound.hpp"
#include "tests/claims/method_trial_fixture.hpp"
#include "tests/claims/rig_fixture.hpp"

namespace cvtflow::claims {
namespace {

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
    model::Parameters p = free_ring(12, 600.0);
    make_conservative(p);
    const Rig start(p);
    double fastest = 0.0;
    for (const auto& value : bench::spectrum(start.variator(), 0.0, start.state_copy(), start.phases()))
        fastest = std::max(fastest, std::abs(value.imag()));
    // Where links are held: that of K - 4 K_held (model/EQUATIONS.md section 2).
    const std::vector<double> begin = start.state_copy();
    tasks::SpectralBound held(start.variator(), tasks::MovedPart::all, nullptr,
                              tasks::held_links("leapfrog-sweep", start.variator().chain()));
    held.estimate_oscillation(0.0, begin.data(), start.phases().data());
    // Saturating contacts bound what is unstable: two runs are compared that begin a picometre apart. Forces rounded to floats part them by
    // 5e-3, what grows by more than 1.
    const auto grows = [&](const std::string& method, double share) {
        std::vector<double> state = start.state_copy();
        const double h = share * 2.0 / held.imaginary();
        const bench::TrialEnd one = bench::try_method(p, {0.0, state, start.phases()}, method, h, 60.0 * h);
        for (std::size_t k = 0; k < state.size(); ++k) state[k] += 1e-12 * std::sin(1.0 + 2.399 * static_cast<double>(k));
        const bench::TrialEnd other = bench::try_method(p, {0.0, state, start.phases()}, method, h, 60.0 * h);
        return one.fault || other.fault || distance(one.state, other.state) > 0.1;
    };
    EXPECT_FALSE(grows("leapfrog-sweep", 0.98)) << fastest;
    EXPECT_TRUE(grows("leapfrog-sweep", 1.02)) << fastest;
    EXPECT_LT(held.imaginary(), fastest / 1.2);
}

}  // namespace
}  // namespace cvtflow::claims
