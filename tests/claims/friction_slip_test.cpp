/// Claim: slip by friction grows with the torque from zero, and what creep loses is never negative, at every ratio. (EQUATIONS section 9)

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/claims/operating_point_fixture.hpp"

namespace cvtflow::claims {
namespace {

/// A ratio, and the thrust ratio S_1/S_2 that holds it at three quarters of the load; control trims it.
struct Point {
    double ratio, thrust, driven_radius;  ///< [1], [1], [m]
};

/// Share of the torque at which the driven pulley slides in theory, 2 mu S_2 r_2/cos(beta).
[[nodiscard]] Operation run_at(const Point& point, double share, const std::string& settling) {
    const double clamping = 20e3, limit = 0.1834 * clamping * point.driven_radius;
    const auto set = [](const std::string& key, double value) { return key + "=" + std::to_string(value); };
    return Operation(
        scene_at_level("control", "medium",
                       {"start.settling_time=" + settling, "run.until=10 ms", "run.output_interval=20 us", set("start.ratio", point.ratio),
                        set("control.ratio", 1.002 * point.ratio), set("clamping.driven", clamping),
                        set("clamping.driving", point.thrust * clamping), set("load.torque", share * limit)}));
}

constexpr double no_slip = 5e-5;  // what friction transmits without load is the losses; the largest measured is 2.5e-5, at ratio 0.45

void expect_growth(const Point& point, const std::vector<double>& shares, const std::string& settling) {
    double before = -no_slip;
    for (const double share : shares) {
        const Operation run = run_at(point, share, settling);
        ASSERT_FALSE(run.fault) << run.fault.message();
        const double slip = run.mean(run.friction_slip);
        EXPECT_GT(slip, before) << point.ratio << " at " << share;
        EXPECT_LT(std::abs(slip), share == 0.0 ? no_slip : 1.0) << point.ratio;
        EXPECT_GE(*std::min_element(run.creep_power.begin(), run.creep_power.end()), 0.0) << point.ratio << " at " << share;
        EXPECT_GT(run.mean(run.creep_power), slip * run.mean(run.drive_power)) << "creep loses what slip takes, and more";
        before = slip;
    }
}

TEST(FrictionSlip, GrowsWithTheTorqueFromZero) { expect_growth({1.0, 1.355, 54.44e-3}, {0.0, 0.3}, "20 ms"); }

TEST(NightlyFrictionSlip, GrowsWithTheTorqueFromZeroAtEveryRatio) {
    for (const Point& point :
         {Point{0.45, 1.697, 32.6e-3}, {0.7, 1.507, 44.2e-3}, {1.0, 1.355, 54.44e-3}, {1.5, 1.274, 64.6e-3}, {2.3, 1.189, 73.7e-3}})
        expect_growth(point, {0.0, 0.05, 0.15, 0.3, 0.6, 0.9}, "60 ms");
}

}  // namespace
}  // namespace cvtflow::claims
