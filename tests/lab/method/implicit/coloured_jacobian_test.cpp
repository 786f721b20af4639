#include "bench/method/implicit/coloured_jacobian.hpp"

#include <gtest/gtest.h>

#include "jacobian_fixture.hpp"

namespace cvtflow::bench {
namespace {

bench::AccelerationJacobian coloured(const Settled& at, int batches) {
    bench::AccelerationJacobian jacobian(at.variator().layout());
    ColouredJacobian differences(at.variator(), batches);
    for (int batch = 0; batch < batches; ++batch) differences.evaluate(batch, at.base(), jacobian);
    return jacobian;
}

double worst(const Settled& at, const bench::AccelerationJacobian& jacobian) {
    const std::vector<double> dense = at.dense();
    return largest_difference(at.variator().layout(), jacobian, dense, dense);
}

TEST(ColouredJacobian, IsTheOneTakenColumnByColumn) {
    // Both use equal differences; only the path from a tip's reaction to a pulley's acceleration rounds differently, at 1e-16/ε of it.
    const Settled settled;
    EXPECT_LT(worst(settled, coloured(settled, 1)), 1e-8);
}

TEST(ColouredJacobian, KnowsControlLedgerAndRigidPulleys) {
    const Settled settled({"control.enabled=true", "control.ratio=1.0", "detail.pulleys=rigid", "record.ledger=true"});
    EXPECT_LT(worst(settled, coloured(settled, 2)), 1e-8);
}

TEST(ColouredJacobian, TakesRingsThatThreeDoesNotDivide) {
    for (const int pins : {25, 26}) {
        const Settled settled({"chain.pins=" + std::to_string(pins), "pulley.centre_distance=51mm"});
        EXPECT_LT(worst(settled, coloured(settled, 3)), 1e-8) << pins;
    }
}

TEST(ColouredJacobian, IsTheSameToTheBitForAnyNumberOfBatches) {
    const Settled settled;
    const bench::AccelerationJacobian one = coloured(settled, 1), seven = coloured(settled, 7);
    const int unknowns = one.links() * one.size() + one.border();
    for (const bench::With with : {bench::With::position, bench::With::velocity}) {
        for (int row = 0; row < unknowns; ++row) {
            for (int column = 0; column < unknowns; ++column) ASSERT_EQ(entry(one, with, row, column), entry(seven, with, row, column));
        }
    }
}

}  // namespace
}  // namespace cvtflow::bench
