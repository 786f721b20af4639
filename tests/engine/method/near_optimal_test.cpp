#include "engine/method/near_optimal.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "engine/method/catalogue.hpp"
#include "engine/method/order.hpp"
#include "engine/method/stability.hpp"

namespace cvtflow::engine {
namespace {

TEST(NearOptimal, IsStableOnItsIntervalOfEightyOneHundredthsDegreeSquared) {
    for (const int degree : {5, 6, 7, 10, 20, 50, 100, 400}) {
        const NearOptimalPolynomial p = near_optimal_polynomial(degree);
        const double length = p.real_length(), square = degree * degree;
        EXPECT_GT(length / square, degree < 8 ? 0.77 : 0.79) << degree;
        EXPECT_LT(length / square, 0.82) << degree;   // 0.8222 is the optimum without damping
        long double largest = 0.0L, ripple = 0.0L;
        for (int i = 1; i <= 4000; ++i) {
            const long double z = -length * i / 4000;
            largest = std::max(largest, std::abs(p.value(z)));
            if (z < -0.2 * length) ripple = std::max(ripple, std::abs(p.value(z)));
        }
        EXPECT_LE(largest, 1.0L) << degree;
        EXPECT_LT(ripple, degree < 10 ? 0.99L : 0.97L) << degree;   // damped: 0.985 for degree 5, 0.964 for many
    }
}

TEST(NearOptimal, MethodsAreOfOrderTwoToTheLastDigits) {
    for (const char* name : {"rock2-s5", "rock2-s24", "rock2-s150", "rock2-s400", "serk2-s10", "serk2-s60", "serk2-s250"}) {
        const StagePlan plan = *make_method(name);
        EXPECT_EQ(order_of(plan, 5e-13), 2) << name;
        EXPECT_LE(time_defect(unroll(plan)), 5e-13) << name;
    }
}

/// Both methods carry the same polynomial, if they have the same degree.
TEST(NearOptimal, StabilityFunctionsAreThePolynomial) {
    const NearOptimalPolynomial p = near_optimal_polynomial(20);
    for (const double z : {-0.5, -7.0, -100.0, -300.0}) {
        EXPECT_NEAR(stability_function(*make_method("rock2-s20"), z).real(), static_cast<double>(p.value(z)), 1e-10) << z;
        EXPECT_NEAR(stability_function(*make_method("serk2-s20"), z).real(), static_cast<double>(p.value(z)), 1e-10) << z;
    }
}

/// ROCK2 and SERK2 multiply what happens in a stage by thousands; why they are not the choice where friction saturates.
TEST(NearOptimal, ErrorsOfStagesGrow) {
    EXPECT_GT(perturbation_gain(*make_method("rock2-s24"), 400.0), 2e4);
    EXPECT_GT(perturbation_gain(*make_method("serk2-s20"), 300.0), 1e3);
}

TEST(NearOptimal, DegreesHaveLimits) {
    EXPECT_THROW((void)near_optimal_polynomial(4), std::invalid_argument);
    EXPECT_THROW((void)near_optimal_polynomial(401), std::invalid_argument);
    for (const char* name : {"rock2-s4", "rock2-s401", "rock2-s10.5", "rock2", "rock2-s", "serk2-s15", "serk2-s260", "serk2-s0"})
        EXPECT_FALSE(make_method(name)) << name;
}

}  // namespace
}  // namespace cvtflow::engine
