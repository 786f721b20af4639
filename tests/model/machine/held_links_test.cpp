#include "model/machine/held_links.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "model/kernels/link_lanes.hpp"

namespace cvtflow::model {
namespace {

constexpr int link_size = link_layout.link_size();
using Numbers = std::array<double, link_size>;

/// A link, with what holds it.
struct HeldLink {
    Parameters parameters;
    Coefficients coefficients{parameters};
    LinkInertia inertia = link_inertia(parameters);
    HeldLinks held{coefficients, inertia};
};

/// Coordinates of an unstretched link along (cos angle, sin angle), its halves straight.
Numbers straight_link(double length, double angle) {
    Numbers q{};
    q[static_cast<std::size_t>(link_layout.x(End::front, 0))] = length * std::cos(angle);
    q[static_cast<std::size_t>(link_layout.y(End::front, 0))] = length * std::sin(angle);
    return q;
}

/// Accelerations of the link at q that moves with v, by forces f.
Numbers accelerations(const HeldInverse& inverse, const Numbers& q, const Numbers& v, const Numbers& f) {
    std::vector<Lanes<1>> places(q.begin(), q.end()), speeds(v.begin(), v.end()), lanes(f.begin(), f.end());
    accelerate(inverse, link_frame(places.data(), speeds.data()), lanes.data());
    Numbers a;
    for (std::size_t k = 0; k < a.size(); ++k) a[k] = lanes[k][0];
    return a;
}

/// M a.
Numbers forces_for(const LinkInertia& inertia, const Numbers& a) {
    constexpr int size = 2 * axis_terms;
    Numbers f{};
    for (int axis = 0; axis < 2; ++axis) {
        for (int row = 0; row < size; ++row) {
            for (int k = 0; k < size; ++k)
                f[static_cast<std::size_t>(axis * size + row)] +=
                    inertia.lateral_matrix[static_cast<std::size_t>(row * size + k)] * a[static_cast<std::size_t>(axis * size + k)];
        }
    }
    for (int row = 0; row < 4; ++row) {
        for (int k = 0; k < 4; ++k)
            f[static_cast<std::size_t>(2 * size + row)] +=
                inertia.axial_matrix[static_cast<std::size_t>(4 * row + k)] * a[static_cast<std::size_t>(2 * size + k)];
    }
    return f;
}

double largest(const Numbers& numbers) {
    double most = 0.0;
    for (const double number : numbers) most = std::max(most, std::abs(number));
    return most;
}

/// Strands stay right: what turns steadily stretches by M a alone, as without holding. Plates' stretch has t·a + |d| θ'² = 0 then.
TEST(HeldLinks, LeaveALinkThatTurnsSteadilyAsItIs) {
    const HeldLink link;
    constexpr double length = 9e-3, rate = 300.0;
    for (const double angle : {0.0, 0.7, 2.5, -1.2}) {
        const Numbers q = straight_link(length, angle);
        Numbers v{}, a{};
        for (const End end : {End::rear, End::front}) {  // about the link's middle
            const double arm = (end == End::front ? 0.5 : -0.5) * length;
            v[static_cast<std::size_t>(link_layout.x(end, 0))] = -rate * arm * std::sin(angle);
            v[static_cast<std::size_t>(link_layout.y(end, 0))] = rate * arm * std::cos(angle);
            a[static_cast<std::size_t>(link_layout.x(end, 0))] = -rate * rate * arm * std::cos(angle);
            a[static_cast<std::size_t>(link_layout.y(end, 0))] = -rate * rate * arm * std::sin(angle);
        }
        const Numbers found = accelerations(link.held.inverse(3e-6), q, v, forces_for(link.inertia, a));
        for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(found[k], a[k], 1e-10 * largest(a)) << angle << ", " << k;
    }
}

/// (M + h² K) a = f for every step h, a link without one is free, and what is held does not turn the whole link or push it: with K a,
/// forces add up to nothing.
TEST(HeldLinks, AddStiffnessToInertiaAndKeepMomentum) {
    const HeldLink link;
    const Numbers q = straight_link(9e-3, 0.7), rest{};
    Numbers f{}, free{};
    for (std::size_t k = 0; k < f.size(); ++k) f[k] = std::sin(1.0 + 2.4 * static_cast<double>(k));
    for (const double step : {0.0, 2e-8, 2.5e-6}) {
        SCOPED_TRACE(step);
        const Numbers a = accelerations(link.held.inverse(step), q, rest, f);
        Numbers held = a, stiff{};
        link.held.add(step * step, q.data(), a.data(), held.data());
        const Numbers again = forces_for(link.inertia, held);
        for (std::size_t k = 0; k < f.size(); ++k) EXPECT_NEAR(again[k], f[k], 1e-10 * largest(f)) << k;
        link.held.add(1.0, q.data(), a.data(), stiff.data());
        const Numbers push = forces_for(link.inertia, stiff);
        EXPECT_GT(largest(push), 1.0);
        for (const auto& [rear, front] : {std::pair{link_layout.x(End::rear, 0), link_layout.x(End::front, 0)},
                                          std::pair{link_layout.y(End::rear, 0), link_layout.y(End::front, 0)},
                                          std::pair{link_layout.z(End::rear), link_layout.z(End::front)}})
            EXPECT_NEAR(push[static_cast<std::size_t>(rear)] + push[static_cast<std::size_t>(front)], 0.0, 1e-10 * largest(push)) << rear;
        if (step == 0.0) free = a;
        Numbers changed = a;
        for (std::size_t k = 0; k < a.size(); ++k) changed[k] -= free[k];
        EXPECT_TRUE(step < 1e-6 || largest(changed) > 0.1 * largest(free)) << "it acts";
    }
}

}  // namespace
}  // namespace cvtflow::model
