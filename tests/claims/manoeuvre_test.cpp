/// The scene `manoeuvre`: claims of docs/manoeuvre.md.

#include <gtest/gtest.h>

#include "tests/claims/operating_point_fixture.hpp"

namespace cvtflow::claims {
namespace {

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
