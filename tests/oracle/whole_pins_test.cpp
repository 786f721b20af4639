#include "tests/oracle/oracle_cases.hpp"
#include "tests/oracle/system.hpp"

#include <gtest/gtest.h>

namespace cvtflow::oracle {
namespace {

/// Point fixed to a half that turns with a pitch line: where it is and how fast.
struct Moving {
    Vec2 point, rate;
};
Moving at_arm(const Half& half, const PitchLine& line, Vec2 arm) {
    return {half.shape[0] + arm, half.shape_rate[0] + line.turning * left_of(arm)};
}

/// Lengths are ~0.1 m and speeds ~10 m/s, each with the rounding of 1e-19 of their parts.
constexpr double rounding = 1e-16;

TEST(WholePins, HaveHalvesThatRollOnEachOtherWithoutGapOrSliding) {
    for (const Case& one : whole_pins(small_scene())) {
        SCOPED_TRACE(one.name);
        const ExactState at = exact_random_state(one.parameters, 31);
        const System system = unpack(one.parameters, 0.0, at.state, at.phases);
        const Real radius = one.parameters.joint.radius, arm = radius - Real{one.parameters.half.width} / 2.0L;
        for (int pin = 0; pin < system.layout.links; ++pin) {
            const int before = system.layout.previous(pin);
            const Half &left = system.links[before].front, &right = system.links[pin].rear;
            const Moving centre_left = at_arm(left, system.lines[before], arm * system.lines[before].t);
            const Moving centre_right = at_arm(right, system.lines[pin], -arm * system.lines[pin].t);
            const Vec2 gap = centre_left.point - centre_right.point;
            ASSERT_NEAR(static_cast<double>(norm(gap) - 2.0L * radius), 0.0, rounding);
            const Vec2 contact = centre_right.point + 0.5L * gap;
            const Moving on_left = at_arm(left, system.lines[before], contact - left.shape[0]);
            const Moving on_right = at_arm(right, system.lines[pin], contact - right.shape[0]);
            ASSERT_NEAR(static_cast<double>(norm(on_left.rate - on_right.rate)), 0.0, rounding);
        }
    }
}

TEST(WholePins, HaveTheirHalvesInTheMiddleBetweenThem) {
    const Case one = whole_pins(small_scene()).front();
    const ExactState at = exact_random_state(one.parameters, 32);
    const System system = unpack(one.parameters, 0.0, at.state, at.phases);
    for (int pin = 0; pin < system.layout.links; ++pin) {
        const Half &left = system.links[system.layout.previous(pin)].front, &right = system.links[pin].rear;
        const Vec2 middle = 0.5L * (left.shape[0] + right.shape[0]);
        EXPECT_NEAR(static_cast<double>(norm(middle - system.pins[pin].rear.shape[0])), 0.0, rounding);
        EXPECT_GT(static_cast<double>(dot(left.shape[0] - right.shape[0], system.pins[pin].t)), 0.0);  // the front half lies ahead
    }
}

}  // namespace
}  // namespace cvtflow::oracle
