#include "bench/method/implicit/linear_plan.hpp"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>
#include <complex>

#include "bench/method/implicit/implicit_matrix.hpp"
#include "jacobian_fixture.hpp"

namespace cvtflow::bench {
namespace {

using SmallVector = Eigen::Vector3d;
using SmallMatrix = Eigen::Matrix3d;

/// y' = f(t, y), nonlinear and non-autonomous.
SmallVector slope(double t, const SmallVector& y) {
    return {y(1) * y(2) + std::cos(t), -y(0) * y(2), -0.5 * y(0) * y(1) - y(2) * y(2) + 0.3 * t};
}

/// One step of the table as it is written down, with any J.
SmallVector step(const LinearPlan& plan, const SmallMatrix& j, double t, double h, const SmallVector& y) {
    const LinearTimes times = times_of(plan);
    std::vector<SmallVector> u;
    const auto sum = [&](const std::vector<engine::Term>& terms) {
        SmallVector total = SmallVector::Zero();
        for (const engine::Term& term : terms) total += term.factor * u[static_cast<std::size_t>(term.slot)];
        return total;
    };
    for (std::size_t i = 0; i < plan.stages.size(); ++i) {
        const LinearStage& stage = plan.stages[i];
        const SmallMatrix w = SmallMatrix::Identity() - stage.gamma * h * j;
        u.push_back(w.partialPivLu().solve(stage.gamma * (h * slope(t + times.stage[i] * h, y + sum(stage.states)) + sum(stage.right))));
    }
    return y + sum(plan.result);
}

SmallVector integrated(const LinearPlan& plan, const SmallMatrix& j, int steps) {
    SmallVector y{1.0, 0.5, -0.4};
    for (int k = 0; k < steps; ++k) y = step(plan, j, k * 1.0 / steps, 1.0 / steps, y);
    return y;
}

TEST(LinearPlan, HasItsOrderWithAnyJacobian) {
    SmallMatrix wrong;  // of the size of the true one, and nothing like it
    wrong << 0.7, -1.1, 0.4, 0.2, -0.5, 1.3, -0.8, 0.6, 0.1;
    for (const LinearPlan& plan : linear_plans()) {
        for (const SmallMatrix& j : {SmallMatrix(SmallMatrix::Zero()), wrong}) {
            const SmallVector coarse = integrated(plan, j, 16), middle = integrated(plan, j, 32), fine = integrated(plan, j, 64);
            EXPECT_NEAR(std::log2((coarse - middle).norm() / (middle - fine).norm()), plan.order, 0.2) << plan.name;
        }
    }
}

/// R(z) of y' = λy with J = share λ.
std::complex<double> stability(const LinearPlan& plan, std::complex<double> z, double share) {
    std::vector<std::complex<double>> u;
    const auto sum = [&](const std::vector<engine::Term>& terms) {
        std::complex<double> total = 0.0;
        for (const engine::Term& term : terms) total += term.factor * u[static_cast<std::size_t>(term.slot)];
        return total;
    };
    for (const LinearStage& stage : plan.stages)
        u.push_back(stage.gamma * (z * (1.0 + sum(stage.states)) + sum(stage.right)) / (1.0 - stage.gamma * share * z));
    return 1.0 + sum(plan.result);
}

TEST(LinearPlan, DampsWhatIsInfinitelyStiff) {
    for (const LinearPlan& plan : linear_plans()) EXPECT_LT(std::abs(stability(plan, -1e8, 1.0)), 1e-6) << plan.name;
}

TEST(LinearPlan, TwoAreStableOnTheWholeImaginaryAxis) {
    for (const LinearPlan& plan : {steihaug_wolfbrandt(), ros34pw2()}) {
        for (double y = 0.01; y < 1e4; y *= 1.1)
            EXPECT_LE(std::abs(stability(plan, {0.0, y}, 1.0)), 1.0 + 1e-12) << plan.name << " at " << y;
    }
}

TEST(LinearPlan, WithoutJacobianReachesAsFarUpAsPublished) {
    // ROS34PW2 with J = 0 is an explicit method: |R(iy)| ≤ 1 up to 1.504.
    EXPECT_LE(std::abs(stability(ros34pw2(), {0.0, 1.500}, 0.0)), 1.0);
    EXPECT_GT(std::abs(stability(ros34pw2(), {0.0, 1.508}, 0.0)), 1.0);
}

TEST(LinearPlan, TimesAreConsistent) {
    for (const LinearPlan& plan : linear_plans()) {
        const LinearTimes times = times_of(plan);
        EXPECT_NEAR(times.result, 1.0, 1e-13) << plan.name;
        EXPECT_EQ(times.stage.front(), 0.0) << plan.name;
    }
    EXPECT_NEAR(times_of(steihaug_wolfbrandt()).stage[1], 0.5, 1e-15);
}

TEST(ImplicitMatrix, SolvesForTheWholeStateInVelocitiesAlone) {
    // (I - θJ) (u_q, u_v) = (0, r)  ⇔  G u_v = r, u_q = θ u_v.
    const Settled settled;
    const model::ChainLayout& at = settled.variator().layout();
    bench::AccelerationJacobian jacobian(at);
    ColouredJacobian(settled.variator(), 1).evaluate(0, settled.base(), jacobian);
    ImplicitMatrix matrix(settled.variator());
    const double theta = 1e-6;
    const ContactMap contacts{settled.base().phases, settled.base().loads};
    std::vector<std::optional<int>> shafts;
    for (int link = 0; link < at.links; ++link) shafts.push_back(contacts.shaft(link));
    for (int chunk = 0; chunk < matrix.chunks(); ++chunk) matrix.eliminate(chunk, theta, jacobian, shafts.data());
    matrix.join(theta, jacobian);
    ASSERT_TRUE(matrix.sound());

    std::vector<double> r(static_cast<std::size_t>(matrix.unknowns()));
    for (std::size_t k = 0; k < r.size(); ++k) r[k] = static_cast<double>(k % 17) - 8.0;
    std::vector<double> x(r.size());
    for (int chunk = 0; chunk < matrix.chunks(); ++chunk) matrix.forward(chunk, r.data());
    matrix.join_solution(r.data());
    for (int chunk = 0; chunk < matrix.chunks(); ++chunk) matrix.backward(chunk, x.data());

    const std::vector<double> dense = settled.dense();
    const Eigen::Index n = at.size();
    const Eigen::Map<const Eigen::MatrixXd> j(dense.data(), n, n);
    Eigen::VectorXd rhs = Eigen::VectorXd::Zero(n);
    const auto velocity = [&](int number) {
        const int edge = at.links * at.link_size();
        return number < edge ? at.link_begin(number / at.link_size()) + at.link_size() + number % at.link_size()
                             : at.pulley_begin() + at.pulley_size + number - edge;
    };
    for (int k = 0; k < matrix.unknowns(); ++k) rhs(velocity(k)) = r[static_cast<std::size_t>(k)];
    const Eigen::VectorXd should = (Eigen::MatrixXd::Identity(n, n) - theta * j).partialPivLu().solve(rhs);
    double error = 0.0, largest = 0.0;
    for (int k = 0; k < matrix.unknowns(); ++k) {
        error = std::max(error, std::abs(x[static_cast<std::size_t>(k)] - should(velocity(k))));
        largest = std::max(largest, std::abs(should(velocity(k))));
    }
    EXPECT_LT(error / largest, 1e-8);
}

}  // namespace
}  // namespace cvtflow::bench
