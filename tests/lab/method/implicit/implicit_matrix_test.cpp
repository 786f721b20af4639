#include "bench/method/implicit/implicit_matrix.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "settled_fixture.hpp"

namespace cvtflow::bench {
namespace {

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
