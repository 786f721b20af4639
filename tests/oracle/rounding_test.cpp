#include "tests/oracle/oracle_cases.hpp"
#include "tests/oracle/system.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace cvtflow::oracle {
namespace {

/// δ = R_c + R_p - d as written, in double.
double depth_as_written(const model::Parameters& p, double radius, double height, double s) {
    const double h1 = radius - (p.pulley.arc_position - p.pulley.arc_radius * std::sin(p.tip.angle));
    const double h2 = height - s * p.pulley.arc_radius * std::cos(p.tip.angle);
    return p.pulley.arc_radius + p.tip.radius - std::sqrt(h1 * h1 + h2 * h2);
}

/// Depth ((R_c + R_p)² - d²)/(R_c + R_p + d), with the large squares cancelled algebraically.
double depth_without_cancellation(const model::Parameters& p, double radius, double height, double s) {
    const double sine = std::sin(p.tip.angle);
    const double cosine = std::cos(p.tip.angle);
    const double both = p.pulley.arc_radius + p.tip.radius;
    const double along = radius - p.pulley.arc_position - p.tip.radius * sine;
    const double axial = height + s * p.tip.radius * cosine;
    const double h1 = along + both * sine;
    const double h2 = axial - s * both * cosine;
    const double excess = 2.0 * both * (along * sine - s * axial * cosine) + along * along + axial * axial;
    return -excess / (both + std::sqrt(h1 * h1 + h2 * h2));
}

TEST(Rounding, OfTheTipDepthAsWrittenExceeds1e12AndVanishesWithoutCancellation) {
    const model::Parameters p;
    const ExactState at = exact_random_state(p, 30);
    const System system = unpack(p, 0.0, at.state, at.phases);
    Real as_written = 0.0L;
    Real cancelled = 0.0L;
    for (const Link& link : system.links) {
        for (const int side : {0, 1}) {
            const TipContact c = tip_contact(system, link, model::End::rear, side);
            if (c.depth < 3e-6L) continue;
            const Vec3 l = c.r - cross(in_space(system.body[c.sheave].tau, 0.0L), c.r);
            // Rounded inputs, then the exact depth of just these inputs by the same algebra in full precision.
            const double radius = static_cast<double>(norm(in_plane(l)));
            const double height = static_cast<double>(l.z);
            const double s = static_cast<double>(c.s);
            const Real h1 = Real{radius} - (p.pulley.arc_position - p.pulley.arc_radius * std::sin(Real{p.tip.angle}));
            const Real h2 = Real{height} - c.s * p.pulley.arc_radius * std::cos(Real{p.tip.angle});
            const Real exact = Real{p.pulley.arc_radius} + p.tip.radius - std::sqrt(h1 * h1 + h2 * h2);
            as_written = std::max(as_written, std::abs(depth_as_written(p, radius, height, s) / exact - 1.0L));
            cancelled = std::max(cancelled, std::abs(depth_without_cancellation(p, radius, height, s) / exact - 1.0L));
        }
    }
    EXPECT_GT(as_written, 1e-11L);
    EXPECT_LT(cancelled, 3e-12L);
    RecordProperty("as_written", std::to_string(static_cast<double>(as_written * 1e12L)));
    RecordProperty("cancelled", std::to_string(static_cast<double>(cancelled * 1e12L)));
}

}  // namespace
}  // namespace cvtflow::oracle
