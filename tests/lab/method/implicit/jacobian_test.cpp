/// Jacobians by colours, exact and by Broyden's rule; model/jacobian against differences of the production kernels, at states that run
/// under load. (Here since only tasks can settle a scene.)

#include "bench/method/jacobian/jacobian.hpp"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "bench/method/implicit/trapezoidal.hpp"
#include "jacobian_fixture.hpp"

namespace cvtflow::bench {
namespace {

using Vector = Eigen::Vector4d;
using Matrix = Eigen::Matrix4d;

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
    for (const char* plates : {"each", "lumped"}) {
        Settled settled({std::string("detail.plates=") + plates});
        EXPECT_LT(difference(settled), difference_error) << plates << ", rolling";
        settled.stir(0.02);
        EXPECT_LT(difference(settled), difference_error) << plates << ", slipping";
    }
}

TEST(ExactJacobian, KnowsEveryLawAndKindOfPulley) {
    const std::vector<std::vector<std::string>> scenes{
        {"detail.friction=smoothed"},
        {"detail.stick_slip=true"},
        {"detail.pulleys=rigid"},
        {"detail.plates=each", "detail.joint_points=8"},
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

Matrix some_matrix() {
    Matrix a;
    a << 4, 1, 0, -1, 0.5, 3, 1, 0, -1, 0.2, 5, 1, 0.3, 0, -0.7, 2;
    return a;
}

TEST(Broyden, MeetsTheSecantEquation) {
    // From B_0 = 1: after a step s that changed the residual by y, B⁻¹ y = s.
    const Vector s{1.0, -2.0, 0.5, 0.3};
    const Vector y = some_matrix() * s;
    Broyden update(4, 3);
    const Vector w = y;
    update.add(s.data(), w.data());
    Vector x = y;
    update.apply(x.data());
    EXPECT_LT((x - s).norm(), 1e-14);
    EXPECT_EQ(update.count(), 1);
}

TEST(Broyden, SolvesALinearSystemInTwiceItsUnknowns) {
    // Gay 1979: Broyden's method ends after at most 2n steps on a linear system.
    const Matrix a = some_matrix();
    const Vector b{1.0, 2.0, -1.0, 0.5};
    Vector x = Vector::Zero(), r = a * x - b;
    Broyden inverse(4, 8);
    for (int k = 0; k < 8 && r.norm() > 1e-12; ++k) {
        Vector s = -r;
        inverse.apply(s.data());
        x += s;
        const Vector next = a * x - b;
        Vector w = next - r;
        inverse.apply(w.data());
        inverse.add(s.data(), w.data());
        r = next;
    }
    EXPECT_LT(r.norm(), 1e-11);
}

TEST(Broyden, LeavesOutWhatHasNoRoomOrNoDirection) {
    Broyden update(2, 1);
    const double s[2] = {1.0, 0.0}, across[2] = {0.0, 1.0}, along[2] = {2.0, 0.0};
    update.add(s, across);
    EXPECT_EQ(update.count(), 0);
    update.add(s, along);
    update.add(s, along);
    EXPECT_EQ(update.count(), 1);
    EXPECT_TRUE(update.full());
}

}  // namespace
}  // namespace cvtflow::bench
