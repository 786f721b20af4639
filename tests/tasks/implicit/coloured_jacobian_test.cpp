#include "tasks/implicit/coloured_jacobian.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "settled_fixture.hpp"

namespace cvtflow::tasks {
namespace {

using model::Near;
using model::With;

model::AccelerationJacobian coloured(const Settled& at, int batches) {
    model::AccelerationJacobian jacobian(at.variator().layout());
    ColouredJacobian differences(at.variator(), batches);
    for (int batch = 0; batch < batches; ++batch) differences.evaluate(batch, at.base(), jacobian);
    return jacobian;
}

/// Entry of the sparse form that belongs to accelerations `row` (links, then border) and unknown `column` of the same kind; 0 where there is none.
class Unpacked {
public:
    Unpacked(const model::AccelerationJacobian& jacobian, With with) : j_(jacobian), with_(with) {}
    [[nodiscard]] double operator()(int row, int column) const {
        const int n = j_.size(), edge = j_.links() * n, m = j_.border();
        if (row >= edge && column >= edge) return j_.corner(with_)[(row - edge) * m + column - edge];
        if (row >= edge) return j_.rows(column / n, with_)[(row - edge) * n + column % n];
        if (column >= edge) return j_.columns(row / n, with_)[row % n * m + column - edge];
        const int apart = (column / n - row / n + j_.links()) % j_.links();
        const auto in = [&](Near near) { return j_.link(row / n, near, with_)[row % n * n + column % n]; };
        if (apart == 0) return in(Near::same);
        if (apart == 1) return in(Near::after);
        return apart == j_.links() - 1 ? in(Near::before) : 0.0;
    }

private:
    const model::AccelerationJacobian& j_;
    With with_;
};

/// Place in the state of the acceleration (or, as a column, the velocity or coordinate) with this number.
int place(const model::ChainLayout& at, int number, With with) {
    const int edge = at.links * at.link_size();
    const bool velocity = with == With::velocity;
    if (number < edge) return at.link_begin(number / at.link_size()) + (velocity ? at.link_size() : 0) + number % at.link_size();
    if (number == edge + at.pulley_size) return velocity ? at.control_begin() : -1;   // I has no coordinate
    return at.pulley_begin() + (velocity ? at.pulley_size : 0) + number - edge;
}

/// Largest difference from differences taken one by one, relative to the largest entry.
double worst(const Settled& at, const model::AccelerationJacobian& jacobian) {
    const model::ChainLayout& layout = at.variator().layout();
    const std::vector<double> dense = at.dense();
    const int unknowns = layout.links * layout.link_size() + jacobian.border();
    double worst = 0.0;
    for (const With with : {With::position, With::velocity}) {
        const Unpacked sparse(jacobian, with);
        double error = 0.0, largest = 0.0;
        for (int column = 0; column < unknowns; ++column) {
            if (place(layout, column, with) < 0) continue;
            for (int row = 0; row < unknowns; ++row) {
                const double should = dense[static_cast<std::size_t>(place(layout, column, with) * layout.size() + place(layout, row, With::velocity))];
                error = std::max(error, std::abs(sparse(row, column) - should));
                largest = std::max(largest, std::abs(should));
            }
        }
        worst = std::max(worst, error / largest);
    }
    return worst;
}

TEST(ColouredJacobian, IsTheOneTakenColumnByColumn) {
    // The same differences; only the way from a tip's reaction to a pulley's acceleration rounds differently, at 1e-16/ε of it.
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
    const model::AccelerationJacobian one = coloured(settled, 1), seven = coloured(settled, 7);
    const int unknowns = one.links() * one.size() + one.border();
    for (const With with : {With::position, With::velocity}) {
        const Unpacked a(one, with), b(seven, with);
        for (int row = 0; row < unknowns; ++row) {
            for (int column = 0; column < unknowns; ++column) ASSERT_EQ(a(row, column), b(row, column));
        }
    }
}

}  // namespace
}  // namespace cvtflow::tasks
