#include "model/law/phase_rule.hpp"

#include <gtest/gtest.h>

namespace cvtflow::model {
namespace {

constexpr double saturation = 0.01;

PhaseRule rule(bool stick_slip) {
    PhaseRule r;
    r.saturation_speed = saturation;
    r.stick_slip = stick_slip;
    return r;
}

TEST(PhaseRule, ATipTouchesAsSoonAsItHasDepthAndLeavesBeyondTheRelease) {
    const PhaseRule r = rule(false);
    EXPECT_EQ(r.next(Phase::free, {1e-15, 0.0}), Phase::touching);
    EXPECT_EQ(r.next(Phase::free, {0.0, 0.0}), Phase::free);
    EXPECT_EQ(r.next(Phase::free, {-1e-15, 0.0}), Phase::free);
    EXPECT_EQ(r.next(Phase::touching, {-0.5 * r.release, 0.0}), Phase::touching);
    EXPECT_EQ(r.next(Phase::touching, {-1.5 * r.release, 0.0}), Phase::free);
    EXPECT_EQ(r.next(Phase::touching, {1e-6, 100.0}), Phase::touching);
}

TEST(PhaseRule, StickAndSlipAreToldBySpeedOnlyIfAskedFor) {
    const PhaseRule r = rule(true);
    EXPECT_EQ(r.next(Phase::free, {1e-9, 0.5 * saturation}), Phase::stick);
    EXPECT_EQ(r.next(Phase::free, {1e-9, 1.5 * saturation}), Phase::slip);
    EXPECT_EQ(r.next(Phase::stick, {1e-9, 1.01 * saturation}), Phase::slip);
    EXPECT_EQ(r.next(Phase::slip, {1e-9, 0.99 * saturation}), Phase::stick);
    for (const Phase phase : {Phase::stick, Phase::slip}) EXPECT_EQ(r.next(phase, {-2e-9, saturation}), Phase::free);
}

TEST(PhaseRule, NoTipFlipsBackAtOnce) {
    for (const bool stick_slip : {false, true}) {
        const PhaseRule r = rule(stick_slip);
        for (const double depth : {-3e-9, -1e-9, -1e-12, 0.0, 1e-12, 1e-6}) {
            for (const double slip : {0.0, 0.9999995 * saturation, saturation, 1.0000005 * saturation, 2.0 * saturation}) {
                for (const Phase phase : {Phase::free, Phase::touching, Phase::stick, Phase::slip}) {
                    if (!stick_slip && (phase == Phase::stick || phase == Phase::slip)) continue;
                    const Phase next = r.next(phase, {depth, slip});
                    EXPECT_EQ(r.next(next, {depth, slip}), next) << "depth " << depth << ", slip " << slip;
                }
            }
        }
    }
}

TEST(PhaseRule, TheGapFunctionIsPositiveExactlyWhereTheTransitionIsDue) {
    for (const bool stick_slip : {false, true}) {
        const PhaseRule r = rule(stick_slip);
        for (const double depth : {-3e-9, -2e-9, -5e-10, -1e-12, 1e-12, 1e-6}) {
            for (const double slip : {0.0, 0.999 * saturation, 1.001 * saturation, 2.0 * saturation}) {
                for (const Phase phase : {Phase::free, Phase::touching, Phase::stick, Phase::slip}) {
                    const TipIndicator tip{depth, slip};
                    const Phase next = r.next(phase, tip);
                    if (next != phase) {
                        EXPECT_GT(r.due(phase, next, tip), 0.0);
                    }
                }
                EXPECT_EQ(r.next(Phase::free, {depth, slip}) != Phase::free, r.due(Phase::free, Phase::touching, {depth, slip}) > 0.0);
                EXPECT_EQ(r.next(Phase::touching, {depth, slip}) == Phase::free, r.due(Phase::touching, Phase::free, {depth, slip}) > 0.0);
            }
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
