/// Order conditions of the tables that solve for friction, the coupling conditions between both parts included.

#include "tasks/method/friction/additive/additive_table.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "tasks/method/friction/implicit_leapfrog.hpp"

namespace cvtflow::tasks {
namespace {

constexpr double exact = 1e-13;
using Vector = std::vector<double>;

Vector product(const std::vector<Vector>& matrix, const Vector& v) {
    Vector out(v.size(), 0.0);
    for (std::size_t i = 0; i < v.size(); ++i) {
        for (std::size_t j = 0; j < matrix[i].size(); ++j) out[i] += matrix[i][j] * v[j];
    }
    return out;
}
double dot(const Vector& a, const Vector& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}
Vector times(const Vector& a, const Vector& b) {
    Vector out(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) out[i] = a[i] * b[i];
    return out;
}

/// Both parts as whole matrices, the implicit one with its diagonal.
std::array<std::vector<Vector>, 2> parts(const AdditiveTable& t) {
    std::array<std::vector<Vector>, 2> both{t.explicit_part, t.implicit_part};
    for (std::size_t stage = 1; stage < t.times.size(); ++stage) both[1][stage].push_back(t.gamma);
    return both;
}

/// All conditions up to an order, for every way to choose parts along the tree.
void expect_order(const AdditiveTable& t, const Vector& b, int order) {
    const Vector one(b.size(), 1.0), &c = t.times;
    EXPECT_NEAR(dot(b, one), 1.0, exact);
    if (order >= 2) {
        EXPECT_NEAR(dot(b, c), 1.0 / 2.0, exact);
    }
    if (order >= 3) {
        EXPECT_NEAR(dot(b, times(c, c)), 1.0 / 3.0, exact);
    }
    if (order >= 4) {
        EXPECT_NEAR(dot(b, times(c, times(c, c))), 1.0 / 4.0, exact);
    }
    for (const auto& outer : parts(t)) {
        const Vector ac = product(outer, c);
        if (order >= 3) {
            EXPECT_NEAR(dot(b, ac), 1.0 / 6.0, exact);
        }
        if (order < 4) continue;
        EXPECT_NEAR(dot(b, times(c, ac)), 1.0 / 8.0, exact);
        EXPECT_NEAR(dot(b, product(outer, times(c, c))), 1.0 / 12.0, exact);
        for (const auto& inner : parts(t)) EXPECT_NEAR(dot(b, product(outer, product(inner, c))), 1.0 / 24.0, exact);
    }
}

TEST(AdditiveTables, FulfilAllConditionsOfTheirOrderCouplingIncluded) {
    for (const AdditiveTable& t : {ark436(), ars343()}) {
        for (const auto& part : parts(t)) {
            const Vector sums = product(part, Vector(t.times.size(), 1.0));
            for (std::size_t stage = 0; stage < sums.size(); ++stage)
                EXPECT_NEAR(sums[stage], t.times[stage], exact) << t.name << " " << stage;
        }
        expect_order(t, t.weights, t.order);
        if (!t.embedded.empty()) expect_order(t, t.embedded, t.order - 1);
    }
}

/// The implicit part ends at its result, so what is stiff is gone after a step: R(-∞) = 0.
TEST(AdditiveTables, ImplicitPartsAreStifflyAccurateAndDampWhatIsStiff) {
    for (const AdditiveTable& t : {ark436(), ars343()}) {
        const auto implicit = parts(t)[1];
        for (std::size_t stage = 0; stage < t.times.size(); ++stage) EXPECT_NEAR(implicit.back()[stage], t.weights[stage], exact) << t.name;
        for (const double z : {-1.0, -10.0, -1e3, -1e9}) {
            Vector y;
            for (std::size_t stage = 0; stage < t.times.size(); ++stage) {
                double sum = 1.0;
                for (std::size_t j = 0; j < stage; ++j) sum += z * implicit[stage][j] * y[j];
                y.push_back(stage == 0 ? sum : sum / (1.0 - z * t.gamma));
            }
            EXPECT_LT(std::abs(y.back()), z < -1e8 ? 1e-6 : 1.0) << t.name << " " << z;
        }
    }
}

TEST(DirkTables, HaveTheirOrderAndTheSameImpulseOfAConstantForce) {
    for (const DirkTable& t : {backward_euler(), sdirk2()}) {
        double sum = 0.0;
        for (std::size_t stage = 0; stage < t.times.size(); ++stage) {
            sum += t.weight(static_cast<int>(stage));
            double time = t.gamma;
            for (const double a : t.weights[stage]) time += a;
            EXPECT_NEAR(time, t.times[stage], exact);
        }
        EXPECT_NEAR(sum, 1.0, exact);
        if (t.order == 2) {
            EXPECT_NEAR(t.centre(), 0.5, exact);
        }
    }
}

}  // namespace
}  // namespace cvtflow::tasks
