/// Claim: leapfrogs are stable while ω h < 2.

#include <gtest/gtest.h>

#include <cmath>

#include "bench/study/spectrum.hpp"
#include "tasks/method/method.hpp"
#include "tests/claims/method_trial_fixture.hpp"
#include "tests/claims/rig_fixture.hpp"
#include "tests/claims/smooth_fixture.hpp"

namespace cvtflow::claims {
namespace {

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
