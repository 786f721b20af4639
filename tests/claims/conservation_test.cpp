/// Claim: every method keeps what all forces of a free chain keep: its momentum.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "engine/method/catalogue.hpp"
#include "tests/claims/rig_fixture.hpp"

namespace cvtflow::claims {
namespace {

/// A spinning ring whose links are pushed in all directions; friction, damping and all.
model::Parameters ring() {
    model::Parameters p;
    p.detail.pulleys = model::PulleyDetail::absent;
    p.start.layout = model::StartLayout::ring;
    p.start.ring_speed = 600.0;
    p.chain.pins = 12;
    return p;
}

struct Momentum {
    std::array<double, 2> sum{};   ///< in x and y [kg·m/s]
    std::array<double, 2> size{};  ///< sum of magnitudes over links
};

/// Momentum of rotation about z, of every coordinate of links: Σ x × A v [kg·m²/s].
double spin(const model::Variator& variator, const double* state) {
    const model::ChainLayout& at = variator.layout();
    const auto& matrix = variator.chain().inertia().lateral_matrix;
    const int size = at.bodies() * at.lateral();
    double total = 0.0;
    for (int link = 0; link < at.links; ++link) {
        const double *q = state + at.link_begin(link), *v = q + at.link_size();
        for (int row = 0; row < size; ++row) {
            for (int column = 0; column < size; ++column)
                total += matrix[static_cast<std::size_t>(row * size + column)] * (q[row] * v[size + column] - q[size + row] * v[column]);
        }
    }
    return total;
}

void push_links(Rig& rig) {
    const model::ChainLayout& at = rig.variator().layout();
    for (int link = 0; link < at.links; ++link) {
        for (int k = 0; k < at.link_size(); ++k)
            rig.mutable_state()[at.link_begin(link) + at.link_size() + k] += 0.02 * std::sin(1.0 + link + 3.0 * k);
    }
}

/// Momentum of every link, A v against a unit translation: order 0 of both halves.
Momentum momentum(const model::Variator& variator, const double* state) {
    const model::ChainLayout& at = variator.layout();
    const auto& matrix = variator.chain().inertia().lateral_matrix;
    const int size = 2 * at.lateral();
    Momentum total;
    for (int link = 0; link < at.links; ++link) {
        const double* v = state + at.link_begin(link) + at.link_size();
        for (int direction = 0; direction < 2; ++direction) {
            const int begin = direction * size;
            double own = 0.0;
            for (const model::End end : {model::End::rear, model::End::front}) {
                const int row = at.x(end, 0);
                for (int column = 0; column < size; ++column)
                    own += matrix[static_cast<std::size_t>(row * size + column)] * v[begin + column];
            }
            total.sum[static_cast<std::size_t>(direction)] += own;
            total.size[static_cast<std::size_t>(direction)] += std::abs(own);
        }
    }
    return total;
}

TEST(EveryMethod, KeepsTheMomentumOfAFreeChain) {
    for (const engine::StagePlan& plan : engine::methods()) {
        Rig rig(ring(), 1, plan.name);
        push_links(rig);
        const Momentum before = momentum(rig.variator(), rig.state());
        ASSERT_GT(std::abs(before.sum[0]), 1e-6 * before.size[0]);
        ASSERT_FALSE(rig.run({0.0, 2e-7, 1e-8, 1e-7})) << plan.name;
        const Momentum after = momentum(rig.variator(), rig.state());
        // Rounding of 20 steps of up to 325 stages; forces move 1e-3 of this between links.
        for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(after.sum[k], before.sum[k], 1e-12 * before.size[k]) << plan.name;
    }
}

TEST(MassScaling, KeepsTheMomentumOfRotationOfAFreeChain) {
    model::Parameters p = ring();
    const double own = spin(Rig(p).variator(), Rig(p).state());
    p.detail.mass_scaling = 10.0;
    Rig rig(p);
    EXPECT_EQ(spin(rig.variator(), rig.state()), own);  // pins start parallel to the axis
    push_links(rig);
    const double before = spin(rig.variator(), rig.state());
    ASSERT_FALSE(rig.run({0.0, 1e-6, 1e-8, 1e-7}));
    // A product of coordinates and speeds is kept to the method's order: (1e6 1/s · 1e-8 s)^5 in each of 100 steps.
    EXPECT_NEAR(spin(rig.variator(), rig.state()), before, 1e-8 * std::abs(before));
}

}  // namespace
}  // namespace cvtflow::claims
