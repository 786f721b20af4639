/// Recipe "a friction law": three functions of the slip over the saturation speed, and what they owe each other.

#include <gtest/gtest.h>

#include <cmath>

namespace cvtflow::recipes {
namespace {

/// Share of the saturated force at slip u = v/v0 ≥ 0 [1], its secant s/u and its tangent ds/du. Rises from 0 to 1 without a corner.
struct RationalLaw {
    static double share(double u) { return u / (1.0 + u); }
    static double secant(double u) { return 1.0 / (1.0 + u); }
    static double tangent(double u) { return 1.0 / ((1.0 + u) * (1.0 + u)); }
};

TEST(LawRecipe, ShareStartsAtZeroRisesAndSaturates) {
    EXPECT_EQ(RationalLaw::share(0.0), 0.0);
    double before = 0.0;
    for (double u = 0.1; u < 1e6; u *= 2.0) {
        EXPECT_GT(RationalLaw::share(u), before) << u;
        before = RationalLaw::share(u);
        EXPECT_LT(before, 1.0);
    }
    EXPECT_NEAR(RationalLaw::share(1e9), 1.0, 1e-9);  // 1 - share is 1/(1 + u)
}

TEST(LawRecipe, SecantAndTangentBelongToTheShare) {
    for (const double u : {0.01, 0.3, 1.0, 5.0}) {
        constexpr double step = 1e-6;
        EXPECT_NEAR(RationalLaw::secant(u) * u, RationalLaw::share(u), 1e-15);  // an ulp of 1
        const double difference = (RationalLaw::share(u + step) - RationalLaw::share(u - step)) / (2.0 * step);
        EXPECT_NEAR(RationalLaw::tangent(u), difference, 1e-9);  // central differences: step² and rounding over step
        EXPECT_LE(RationalLaw::tangent(u), RationalLaw::secant(u)) << "a concave law: implicit friction then has one solution";
    }
}

TEST(LawRecipe, FrictionNeverDrives) {
    for (const double v : {-3.0, -1e-3, 0.0, 2.0}) EXPECT_LE(-RationalLaw::secant(std::abs(v)) * v * v, 0.0);
}

}  // namespace
}  // namespace cvtflow::recipes
