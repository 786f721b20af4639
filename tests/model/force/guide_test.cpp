#include "model/force/guide.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace cvtflow::model {
namespace {

constexpr double rail_stiffness = 1e6, rail_play = 0.2e-3;  // [N/m], [m]

/// Pulleys of different radii, so that the strands are slanted.
GuideCoefficients guide_of_a_slanted_strand() {
    Parameters p;
    p.start.ratio = 1.6;
    p.guide = {.stiffness = rail_stiffness, .damping = 0.4, .clearance = rail_play, .friction = 0.2, .begin = 0.1, .end = 0.9};
    return Coefficients(p).guide;
}

/// A pin at the place (along, outward) of the upper strand, or mirrored, with its velocity.
struct GuidedPin {
    double along, outward, along_rate, outward_rate;  ///< [m], [m/s]
    [[nodiscard]] GuideContact<1> contact(const GuideCoefficients& g, double strand = 1.0) const {
        const double from_axis = g.radius + outward;
        return {g,
                1.0,
                g.cosine * along - g.sine * from_axis,
                strand * (g.sine * along + g.cosine * from_axis),
                g.cosine * along_rate - g.sine * outward_rate,
                strand * (g.sine * along_rate + g.cosine * outward_rate)};
    }
};

double middle_of_rails(const GuideCoefficients& g) { return 0.5 * (g.begin + g.end); }
/// Force along the strand and outwards [N].
double along_strand(const GuideCoefficients& g, const GuideContact<1>& c) { return g.cosine * c.fx[0] + g.sine * c.fy[0]; }
double out_of_strand(const GuideCoefficients& g, const GuideContact<1>& c) { return g.cosine * c.fy[0] - g.sine * c.fx[0]; }

/// k (|u| - c) beyond the clearance, at rest; places are known to 1e-17 m.
TEST(Guide, ActsOnlyBeyondTheClearance) {
    const GuideCoefficients g = guide_of_a_slanted_strand();
    for (const double u : {-1e-3, -0.3e-3, 0.3e-3, 1e-3}) {
        const double expected = std::copysign(rail_stiffness * (std::abs(u) - rail_play), -u);
        const auto contact = GuidedPin{middle_of_rails(g), u, 0.0, 0.0}.contact(g);
        EXPECT_NEAR(out_of_strand(g, contact), expected, 1e-9 * std::abs(expected)) << u;
        EXPECT_NEAR(along_strand(g, contact), 0.0, 1e-9 * std::abs(expected));
        EXPECT_NEAR(contact.offset[0], u, 1e-16);
    }
    for (const double u : {-0.19e-3, 0.0, 0.19e-3}) {
        const auto contact = GuidedPin{middle_of_rails(g), u, -10.0, 3.0}.contact(g);
        EXPECT_EQ(contact.fx[0], 0.0) << u;
        EXPECT_EQ(contact.fy[0], 0.0) << u;
    }
}

TEST(Guide, NeverPullsAndNeverBringsEnergy) {
    const GuideCoefficients g = guide_of_a_slanted_strand();
    for (double s = 0.0; s < 0.17; s += 1.3e-3) {
        for (const double u : {-2e-3, -0.4e-3, 0.4e-3, 2e-3}) {
            for (const double rate : {-30.0, -2.0, 0.0, 2.0, 30.0}) {
                for (const double speed : {-11.0, -0.3, 0.3, 11.0}) {
                    const auto c = GuidedPin{s, u, speed, rate}.contact(g);
                    EXPECT_GE(c.normal[0], 0.0);
                    EXPECT_LE(out_of_strand(g, c) * u, 1e-15 * std::abs(along_strand(g, c))) << "towards the middle";
                    EXPECT_GE(c.damping[0] * c.approach[0], 0.0);
                    EXPECT_GE(c.friction[0] * c.speed[0], 0.0);
                    EXPECT_LE(std::abs(c.friction[0]), 0.2 * c.normal[0] * (1.0 + 1e-15));
                    EXPECT_EQ(s > g.begin && s<g.end, c.share[0]> 0.0);
                }
            }
        }
    }
}

/// The force of a pin that runs in grows from zero without a step: at most in proportion to the square of the way into the rail.
TEST(Guide, BeginsWithoutAStep) {
    const GuideCoefficients g = guide_of_a_slanted_strand();
    const auto force = [&](double way) { return -out_of_strand(g, GuidedPin{g.begin + way, 1e-3, 11.0, 0.0}.contact(g)); };
    EXPECT_EQ(force(-1e-9), 0.0);
    const double full = rail_stiffness * (1e-3 - rail_play), ramp = 0.2 * (g.end - g.begin);
    for (const double share : {1e-3, 1e-2, 0.1}) {
        EXPECT_LT(force(share * ramp), 3.0 * share * share * full);
        EXPECT_GT(force(share * ramp), 2.5 * share * share * full);
    }
    EXPECT_NEAR(force(ramp), full, 1e-9 * full);
}

}  // namespace
}  // namespace cvtflow::model
