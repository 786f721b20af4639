#include <gtest/gtest.h>

#include <algorithm>

#include "tests/oracle/oracle_cases.hpp"
#include "tests/oracle/system.hpp"

namespace cvtflow::oracle {
namespace {

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

/// Shafts and sheaves that are free to tilt and spin, with no springs against tilting, no tips, everything else at rest.
TEST(GyroscopicForce, KeepsTheAngularMomentumOfAFreeRotor) {
    model::Parameters p = small_scene();
    make_conservative(p);
    p.pulley.bearing_tilt = p.pulley.attachment_tilt = p.pulley.attachment_radial = 0.0;
    const auto layout = model::layout_of(p);
    ExactState at = exact_random_state(p, 3);
    for (const int index : rate_indices(layout)) at.state[index] = 0.0L;
    std::fill(at.phases.begin(), at.phases.end(), model::Phase::free);
    const Real spin = 200.0L, step = 2e-5L;
    for (const int body : {0, model::sheave_body(0, 1)}) {
        const bool shaft = body == 0;
        const Real polar = shaft ? p.pulley.shaft_polar_inertia + p.drive.inertia : p.pulley.sheave_polar_inertia,
                   tilting = shaft ? p.pulley.shaft_tilt_inertia : p.pulley.sheave_tilt_inertia;
        const auto acceleration = [&](Vec2 rate) {
            ExactState now = at;
            const int first = layout.pulley_begin() + layout.pulley_size + model::body_freedom(body, 2);
            now.state[first] = rate.x;
            now.state[first + 1] = rate.y;
            now.state[first + 3] = spin;
            const auto slope = exact_right_hand_side(p, 0.0, now.state, now.phases).slope;
            return Vec2{slope[first], slope[first + 1]};
        };
        Vec2 tau, rate{0.1L, 0.0L};
        for (int k = 0; k < 300; ++k) {  // midpoint rule
            const Vec2 middle = rate + (step / 2.0L) * acceleration(rate);
            tau += step * middle;
            rate += step * acceleration(middle);
        }
        // H = J_t τ' + J_p φ' (axis), axis = (τ_y, -τ_x): conserved from the kick J_t (0.1, 0).
        const double kick = static_cast<double>(tilting * 0.1L);
        EXPECT_NEAR(static_cast<double>(tilting * rate.x + polar * spin * tau.y), kick, 1e-6 * kick) << body;
        EXPECT_NEAR(static_cast<double>(tilting * rate.y - polar * spin * tau.x), 0.0, 1e-6 * kick) << body;
        EXPECT_GT(norm(tau), 0.0L) << body;
    }
}

}  // namespace
}  // namespace cvtflow::oracle
