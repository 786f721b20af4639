#include "bench/method/analysis/tableau.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/method/product_names.hpp"
#include "engine/method/catalogue.hpp"
#include "tests/engine/method/plan_fixture.hpp"

namespace cvtflow::bench {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::Pointwise;

TEST(Tableau, OfAChainedPlanIsUnrolled) {
    const Tableau tableau = unroll(engine::test::two_half_euler_steps());
    EXPECT_THAT(tableau.times, ElementsAre(0.0, 0.5));
    EXPECT_THAT(tableau.matrix, ElementsAre(0.0, 0.0, 0.5, 0.0));
    EXPECT_THAT(tableau.weights, ElementsAre(0.5, 0.5));
    EXPECT_TRUE(tableau.embedded.empty());
}

TEST(Tableau, StageTimesOfDumkaAreTheSumsOfItsSubsteps) {
    const double e1 = 0.1042566436020026, e2 = 0.3892933924117778, e3 = 0.1231817161250036;
    const double start = e1 + e2 + e3;
    const std::vector<double> times{0.0, e1, e1 + e2, start, start - 0.4314789924333955, start + 0.4933498959876315 - 0.2911642035969445};
    EXPECT_THAT(unroll(engine::test::dumka3_degree_6()).times, Pointwise(DoubleNear(1e-15), times));
}

TEST(Tableau, EmbeddedWeightsAreTheResultMinusTheErrorEstimate) {
    EXPECT_THAT(unroll(*find_method("heun")).embedded, ElementsAre(1.0, 0.0));
}

}  // namespace
}  // namespace cvtflow::bench
