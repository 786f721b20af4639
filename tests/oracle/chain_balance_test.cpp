#include "tests/oracle/oracle_cases.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace cvtflow::oracle {
namespace {

/// Total force and moment about the origin's z axis on the chain [N, N·m], and the sum of magnitudes that makes up each.
struct Sum {
    Vec3 force;
    Real moment = 0.0L;
    Real magnitude = 0.0L;
};

Sum sum_over_chain(const model::ChainLayout& layout, const std::vector<Real>& state, const std::vector<Real>& forces) {
    Sum sum;
    for (int link = 0; link < layout.links; ++link) {
        const Real* q = &state[layout.link_begin(link)];
        const Real* f = &forces[link * layout.link_size()];
        for (int body = 0; body < layout.bodies(); ++body) {
            const auto end = static_cast<model::End>(body);
            sum.force += Vec3{f[layout.x(end, 0)], f[layout.y(end, 0)], f[layout.z(end)]};
            for (int m = 0; m <= layout.order; ++m) {
                const Vec2 place{q[layout.x(end, m)], q[layout.y(end, m)]};
                const Vec2 force{f[layout.x(end, m)], f[layout.y(end, m)]};
                sum.moment += cross(place, force);
                sum.magnitude += norm(force);
            }
        }
    }
    return sum;
}

/// Halves; and rigid pins without pulleys, as their tips have no phases.
std::vector<Case> chains_by_themselves() {
    std::vector<Case> cases = all_details(small_scene());
    for (Case& one : rigid_details(small_scene()))
        if (one.parameters.detail.pulleys == model::PulleyDetail::absent) cases.push_back(std::move(one));
    return cases;
}

TEST(ChainBalance, InternalForcesOfTheChainSumToZeroForceAndMoment) {
    std::uint64_t seed = 500;
    for (const Case& one : chains_by_themselves()) {
        SCOPED_TRACE(one.name);
        ExactState at = exact_random_state(one.parameters, seed++);
        std::fill(at.phases.begin(), at.phases.end(), model::Phase::free);
        const auto layout = model::layout_of(one.parameters);
        const auto result = exact_right_hand_side(one.parameters, 0.0, at.state, at.phases, false);
        const Sum sum = sum_over_chain(layout, at.state, result.forces);
        ASSERT_GT(sum.magnitude, 1e3L);
        const double tolerance = 1e-15 * static_cast<double>(sum.magnitude);  // rounding only
        EXPECT_NEAR(static_cast<double>(sum.force.x), 0.0, tolerance);
        EXPECT_NEAR(static_cast<double>(sum.force.y), 0.0, tolerance);
        EXPECT_NEAR(static_cast<double>(sum.force.z), 0.0, tolerance);
        EXPECT_NEAR(static_cast<double>(sum.moment), 0.0, tolerance);
    }
}

/// Forces on the six bodies without bearings: only attachments, tips and clamping, which all act between bodies and chain.
TEST(ChainBalance, ChainAndPulleysTogetherAreOnlyPushedByBearingsDriveAndLoad) {
    for (int order = 0; order <= 4; ++order) {
        model::Parameters parameters = small_scene();
        parameters.detail.order = order;
        parameters.detail.stick_slip = order >= 2;
        if (order == 4) parameters = with_rigid_pins(parameters);
        parameters.pulley.bearing_radial = 0.0;
        parameters.pulley.bearing_axial = 0.0;
        const ExactState at = exact_random_state(parameters, 40);
        const auto layout = model::layout_of(parameters);
        const auto result = exact_right_hand_side(parameters, 0.0, at.state, at.phases, false);
        Sum sum = sum_over_chain(layout, at.state, result.forces);
        const Real* q = &at.state[layout.pulley_begin()];
        const Real* f = &result.forces[layout.links * layout.link_size()];
        for (int b = 0; b < 6; ++b) {
            const auto k = [b](int freedom) { return model::body_freedom(b, freedom); };
            const Vec3 force{f[k(0)], f[k(1)], f[k(4)]};
            sum.force += force;
            const bool driven = b == 1 || b >= 4;
            const Vec2 place{q[k(0)] + (driven ? parameters.pulley.centre_distance : 0.0), q[k(1)]};
            sum.moment += cross(place, in_plane(force)) + f[k(5)];
            sum.magnitude += norm(force);
        }
        const double tolerance = 1e-15 * static_cast<double>(sum.magnitude);
        EXPECT_NEAR(static_cast<double>(sum.force.x), 0.0, tolerance);
        EXPECT_NEAR(static_cast<double>(sum.force.y), 0.0, tolerance);
        EXPECT_NEAR(static_cast<double>(sum.force.z), 0.0, tolerance);
        // About z only to first order of the tilts (1e-6): the normal force has no moment about the tilted axis, not about z; nor do
        // radial attachments balance at second order of the displacements.
        const Real drive = result.powers.works[0] / at.state[layout.pulley_begin() + 36 + model::body_freedom(0, 5)];
        EXPECT_NEAR(static_cast<double>(sum.moment), static_cast<double>(drive) - parameters.load.torque.at(0.0),
                    1e-6 * static_cast<double>(sum.magnitude));
    }
}

}  // namespace
}  // namespace cvtflow::oracle
