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

/// Of every link, A v against a unit translation: order 0 of both halves.
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
        const model::ChainLayout& at = rig.variator().layout();
        for (int link = 0; link < at.links; ++link) {
            for (int k = 0; k < at.link_size(); ++k)
                rig.mutable_state()[at.link_begin(link) + at.link_size() + k] += 0.02 * std::sin(1.0 + link + 3.0 * k);
        }
        const Momentum before = momentum(rig.variator(), rig.state());
        ASSERT_GT(std::abs(before.sum[0]), 1e-6 * before.size[0]);
        ASSERT_FALSE(rig.run({0.0, 2e-7, 1e-8, 1e-7})) << plan.name;
        const Momentum after = momentum(rig.variator(), rig.state());
        // Rounding of 20 steps of up to 325 stages; forces move 1e-3 of this between links.
        for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(after.sum[k], before.sum[k], 1e-12 * before.size[k]) << plan.name;
    }
}

}  // namespace
}  // namespace cvtflow::claims
