/// Controllers of the machine at work on a whole chain, among them the scene `manoeuvre`: claims of docs/time_tables.md.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "tests/claims/operating_point_fixture.hpp"

namespace cvtflow::claims {
namespace {

/// 2 mu r/cos(beta): torque that a newton of clamping force carries, with the chain at the arc's nominal place [N·m/N].
double carried_per_force(const tasks::Scene& scene) {
    const auto& p = scene.parameters;
    return 2.0 * p.tip.friction.coefficient * p.pulley.arc_position / std::cos(p.tip.angle);
}

/// Whether the table presses with more or with less than is target: the force that carries the target multiple of 150 N·m.
TEST(Controllers, TheOneOfTheSafetyFactorBringsTheDrivenClampingForceToWhatTheoryAsksFor) {
    for (const char* target : {"1.2", "1.6"}) {
        const tasks::Scene scene =
            ready_scene("manoeuvre", {"clamping.driven=20 kN", "control.quantity=safety", std::string("control.safety=") + target,
                                      "control.integral=2e7 N/s", "control.proportional=0", "run.until=12 ms"});
        const Operation run(scene);
        ASSERT_FALSE(run.fault) << run.fault.message();
        const double factor = std::strtod(target, nullptr), force = run.mean(run.clamping_driven, 8e-3, 12e-3);
        // The sheaves give way by some 10 um, which is 0.1 % of the radius; the time constant is 1 ms.
        EXPECT_NEAR(force, factor * 150.0 / carried_per_force(scene), 5e-3 * force) << target;
        EXPECT_NEAR(carried_per_force(scene) * force / std::abs(run.mean(run.driven_torque, 8e-3, 12e-3)), factor, 0.02 * factor)
            << "by the chain's own torque, which swings";
    }
}

/// The second controller lets S_2 down to where the chain carries 1.2 times the load; the first one follows with S_1 and keeps the ratio.
TEST(NightlyControllers, HoldRatioAndSafetyFactorAtOnce) {
    const tasks::Scene scene = ready_scene("control", {"control.driven=safety", "control.safety=1.2", "control.driven_proportional=0",
                                                       "control.driven_integral=2e6 N/s", "run.until=120 ms"});
    const Operation run(scene);
    ASSERT_FALSE(run.fault) << run.fault.message();
    const double end = run.time.back(), force = run.mean(run.clamping_driven, end - 20e-3, end);
    EXPECT_NEAR(force, 1.2 * 150.0 / carried_per_force(scene), 5e-3 * force);
    EXPECT_NEAR(run.mean(run.ratio, end - 20e-3, end), 1.0023, 5e-4) << "swings of the first controller, as without the second";
}

/// The file's 18 kN carry 2 mu S r/cos(beta) = 180 N·m, the load steps to 185 N·m.
TEST(Manoeuvre, SlipControlKeepsTheChainFromSlippingThroughAfterTheStepOfTorque) {
    const Operation with(ready_scene("manoeuvre", {"run.until=45 ms"}));
    const Operation without(ready_scene("manoeuvre", {"run.until=45 ms", "control.enabled=false"}));
    ASSERT_FALSE(with.fault) << with.fault.message();
    ASSERT_FALSE(without.fault) << without.fault.message();
    EXPECT_LT(with.mean(with.slip, 20e-3, 30e-3), 0.006);
    EXPECT_LT(with.mean(with.slip, 40e-3, 45e-3), 0.009) << "it comes back to the target";
    EXPECT_GT(without.mean(without.slip, 40e-3, 45e-3), 0.015);
    EXPECT_GT(without.mean(without.slip, 42e-3, 45e-3), 1.1 * without.mean(without.slip, 37e-3, 40e-3)) << "slip grows on and on";
    const auto driven = [](const Operation& run, double from, double to) {
        return 0.5 * (run.mean(run.axial_force[3], from, to) - run.mean(run.axial_force[2], from, to));
    };
    EXPECT_GT(driven(with, 40e-3, 45e-3), 19.5e3);
}

}  // namespace
}  // namespace cvtflow::claims
