/// Coefficients, belts and held links of a machine.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "model/kernels/link_lanes.hpp"
#include "model/machine/belt.hpp"
#include "model/machine/coefficients.hpp"
#include "model/machine/held_links.hpp"

namespace cvtflow::model {
namespace {

/// A normal distribution that is cut at three deviations has 0.9733 of its variance: 1 - 6 φ(3)/(1 - 2 Φ(-3)).
TEST(Lengths, OfPinsAreNormalAndCutAtThreeDeviations) {
    Parameters p;
    EXPECT_TRUE(longer_halves(p).empty());
    p.chain.pins = 20000;
    p.imperfection.pin_length_spread = 2e-6;
    const std::vector<double> longer = longer_halves(p);
    ASSERT_EQ(longer.size(), 20000u);
    double sum = 0.0, squares = 0.0, largest = 0.0;
    for (const double half : longer) sum += half, squares += half * half, largest = std::max(largest, std::abs(half));
    const double deviation = 0.5 * 2e-6, root = std::sqrt(20000.0);
    EXPECT_NEAR(sum / 20000.0, 0.0, 4.0 * deviation / root);
    EXPECT_NEAR(squares / 20000.0 / (deviation * deviation), 0.9733, 4.0 * std::sqrt(2.0) / root);
    EXPECT_LE(largest, 3.0 * deviation);
    EXPECT_GT(largest, 2.7 * deviation) << "of 20,000, 130 are beyond 2.7";
    const double within = static_cast<double>(std::ranges::count_if(longer, [&](double half) { return std::abs(half) < deviation; }));
    EXPECT_NEAR(within / 20000.0, 0.6845, 4.0 * 0.465 / root) << "0.6827/0.9973";
    EXPECT_EQ(longer_halves(p), longer);
    p.imperfection.pin_length_seed = 2;
    EXPECT_NE(longer_halves(p), longer);
}

constexpr double distance = 0.17;

TEST(Belt, AtRatioOneItsLengthIsTwoStrandsAndACircle) {
    // Sums of a few terms below 1 m: rounding is some 1e-16.
    EXPECT_NEAR(belt_length({0.05, 0.05}, distance), 2.0 * distance + 2.0 * std::numbers::pi * 0.05, 1e-15);
}

/// Published: 54.444 mm at ratio 1, 30.984 and 74.361 mm at ratio 2.4, rounded.
TEST(Belt, RadiiGiveBackTheLengthAndTheRatio) {
    EXPECT_NEAR(belt_radii(84 * 8.12e-3, 1.0, distance)->driving, 54.444e-3, 5e-7);
    EXPECT_NEAR(belt_radii(84 * 8.12e-3, 2.4, distance)->driving, 30.984e-3, 5e-7);
    EXPECT_NEAR(belt_radii(84 * 8.12e-3, 2.4, distance)->driven, 74.361e-3, 5e-7);
    for (const double ratio : {0.4, 0.7, 1.0, 1.6, 2.5}) {
        const auto radii = belt_radii(0.68208, ratio, distance);
        ASSERT_TRUE(radii.has_value()) << ratio;
        EXPECT_NEAR(radii->driven, ratio * radii->driving, 1e-17);
        EXPECT_NEAR(belt_length(*radii, distance), 0.68208, 1e-15) << ratio;  // bisected to the last digit
    }
}

TEST(Belt, HasNoRadiiIfItIsTooShortOrTooLong) {
    EXPECT_FALSE(belt_radii(2.0 * distance, 1.0, distance).has_value());                                // nothing left for the arcs
    EXPECT_FALSE(belt_radii(2.0 * distance + std::numbers::pi * distance, 1.0, distance).has_value());  // the pulleys would meet
    EXPECT_TRUE(belt_radii(2.0 * distance + 0.99 * std::numbers::pi * distance, 1.0, distance).has_value());
}

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

/// For every step h accelerations are the free ones, held; a step of zero holds nothing. What is held does not turn the whole link or push
/// it: forces M a add up to those that act.
TEST(HeldLinks, TakePartOfTheAccelerationsAndKeepMomentum) {
    const HeldLink link;
    const Numbers q = straight_link(9e-3, 0.7), rest{};
    Numbers f{};
    for (std::size_t k = 0; k < f.size(); ++k) f[k] = std::sin(1.0 + 2.4 * static_cast<double>(k));
    const Numbers free = accelerations(link.held.inverse(0.0), q, rest, f), again = forces_for(link.inertia, free);
    for (std::size_t k = 0; k < f.size(); ++k) EXPECT_NEAR(again[k], f[k], 1e-10 * largest(f)) << k;
    for (const double step : {0.0, 2e-8, 5e-6}) {
        SCOPED_TRACE(step);
        const Numbers a = accelerations(link.held.inverse(step), q, rest, f), push = forces_for(link.inertia, a);
        Numbers held = free, changed = a;
        link.held.hold(link.held.inverse(step), q.data(), held.data());
        for (std::size_t k = 0; k < f.size(); ++k) EXPECT_NEAR(held[k], a[k], 1e-10 * largest(a)) << k;
        for (const auto& [rear, front] : {std::pair{link_layout.x(End::rear, 0), link_layout.x(End::front, 0)},
                                          std::pair{link_layout.y(End::rear, 0), link_layout.y(End::front, 0)},
                                          std::pair{link_layout.z(End::rear), link_layout.z(End::front)}}) {
            const auto net = [](const Numbers& of, int a, int b) {
                return of[static_cast<std::size_t>(a)] + of[static_cast<std::size_t>(b)];
            };
            EXPECT_NEAR(net(push, rear, front), net(f, rear, front), 1e-10 * largest(f)) << rear;
        }
        for (std::size_t k = 0; k < a.size(); ++k) changed[k] -= free[k];
        EXPECT_TRUE(step < 1e-6 || largest(changed) > 0.1 * largest(free)) << "it acts";
    }
}

}  // namespace
}  // namespace cvtflow::model
