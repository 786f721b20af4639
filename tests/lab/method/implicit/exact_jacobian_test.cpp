/// model/jacobian against differences of the production kernels, at states that run under load. (Here since only tasks can settle a scene.)

#include "bench/method/jacobian/exact_jacobian.hpp"

#include <gtest/gtest.h>

#include "jacobian_fixture.hpp"

namespace cvtflow::bench {
namespace {

bench::AccelerationJacobian exact(const Settled& at, int ranges = 1) {
    const model::ChainLayout& layout = at.variator().layout();
    bench::AccelerationJacobian jacobian(layout);
    bench::ExactJacobian derivatives(at.variator());
    const BasePoint base = at.base();
    for (int r = 0; r < ranges; ++r)
        derivatives.links(base.state, base.phases, layout.links * r / ranges, layout.links * (r + 1) / ranges, jacobian);
    derivatives.corner(base.time, base.state, base.phases, jacobian);
    return jacobian;
}

double difference(const Settled& at) { return largest_difference(at.variator().layout(), exact(at), at.dense(), at.dense(-1.0)); }

// The derivative lies between forward and backward differences, also at a kink: their errors of first order have opposite signs. Outside
// remain those of second order, for a tip 0.1 µm deep (ε/δ)²/24 = 4e-6, and rounding, 1e-7.
constexpr double difference_error = 1e-5;

TEST(ExactJacobian, IsThatOfTheKernelsAtEveryDetail) {
    for (const char* order : {"0", "1", "2", "3"}) {
        Settled settled({std::string("detail.order=") + order});
        EXPECT_LT(difference(settled), difference_error) << "order " << order << ", rolling";
        settled.stir(0.02);
        EXPECT_LT(difference(settled), difference_error) << "order " << order << ", slipping";
    }
}

TEST(ExactJacobian, KnowsEveryLawAndKindOfPulley) {
    const std::vector<std::vector<std::string>> scenes{
        {"detail.friction=smoothed"},
        {"detail.stick_slip=true"},
        {"detail.pulleys=rigid"},
        {"detail.plates=each", "detail.joint_points=8"},
        {"detail.mass_scaling=10"},
        {"guide.stiffness=1e8", "guide.clearance=0", "guide.friction_coefficient=0.5"},
        {"control.enabled=true", "control.ratio=1.0", "record.ledger=true"},
        {"control.enabled=true", "control.driven=safety", "control.ratio=1.0", "record.ledger=true"}};
    for (const auto& extra : scenes) {
        Settled settled(extra);
        settled.stir(0.01);
        EXPECT_LT(difference(settled), difference_error) << extra.front();
    }
}

TEST(ExactJacobian, IsTheSameToTheBitForAnyRanges) {
    const Settled settled;
    const bench::AccelerationJacobian one = exact(settled), five = exact(settled, 5);
    const int unknowns = one.links() * one.size() + one.border();
    for (const bench::With with : {bench::With::position, bench::With::velocity}) {
        for (int row = 0; row < unknowns; ++row) {
            for (int column = 0; column < unknowns; ++column) ASSERT_EQ(entry(one, with, row, column), entry(five, with, row, column));
        }
    }
}

}  // namespace
}  // namespace cvtflow::bench
