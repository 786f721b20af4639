#include "bench/method/implicit/broyden.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

namespace cvtflow::bench {
namespace {

using Vector = Eigen::Vector4d;
using Matrix = Eigen::Matrix4d;

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
