#include "bench/method/analysis/order.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include "engine/method/catalogue.hpp"
#include "tests/engine/method/plan_fixture.hpp"

namespace cvtflow::bench {
namespace {

using testing::AllOf;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pointwise;

TEST(Order, RootedTreesAreAsManyAsTheoryCounts) {
    const std::vector<RootedTree> trees = rooted_trees(highest_order);
    const std::vector<int> counts{1, 1, 2, 4, 9, 20, 48, 115};
    for (int nodes = 1; nodes <= highest_order; ++nodes) {
        const auto of_size = std::count_if(trees.begin(), trees.end(), [&](const RootedTree& tree) { return tree.nodes == nodes; });
        EXPECT_EQ(of_size, counts[static_cast<std::size_t>(nodes - 1)]) << nodes;
    }
}

TEST(Order, DensityOfTheTallTreeIsAFactorialAndOfTheBushItsSize) {
    const std::vector<RootedTree> trees = rooted_trees(5);
    const auto [bush, tall] = std::minmax_element(trees.end() - 9, trees.end(), [](auto& a, auto& b) { return a.density < b.density; });
    EXPECT_EQ(tall->density, 120.0);
    EXPECT_EQ(bush->density, 5.0);
}

TEST(Order, OfKnownMethods) {
    EXPECT_EQ(order_of(*find_method("euler")), 1);
    EXPECT_EQ(order_of(*find_method("heun")), 2);
    EXPECT_EQ(order_of(*find_method("rk4")), 4);
    EXPECT_EQ(order_of(*find_method("rk38")), 4);
    EXPECT_EQ(embedded_order_of(*find_method("heun")), 1);
    EXPECT_EQ(embedded_order_of(*find_method("rk4")), 0);
}

TEST(Order, OfChainedPlans) {
    EXPECT_EQ(order_of(engine::test::two_half_euler_steps()), 1);
    EXPECT_EQ(order_of(engine::test::dumka3_degree_3()), 3);
    EXPECT_EQ(order_of(engine::test::dumka3_degree_6()), 3);
    EXPECT_EQ(embedded_order_of(engine::test::dumka3_degree_3()), 2);
}

TEST(Order, OfAnInconsistentMethodIsZero) { EXPECT_EQ(order_of(butcher_plan("half", "", "", {}, {0.5})), 0); }

TEST(Order, InconsistentTimesAreNotForgiven) {
    Tableau tableau = unroll(*find_method("rk4"));
    tableau.times[1] = 0.25;
    EXPECT_EQ(order_of(tableau, tableau.weights), 0);
}

TEST(Order, EveryMethodOfTheCatalogueHasConsistentTimes) {
    for (const StagePlan& plan : methods()) EXPECT_LE(time_defect(unroll(plan)), 1e-12) << plan.name;
}

TEST(Order, ReusableLastSlopesAreRecognised) {
    EXPECT_TRUE(last_stage_is_result(unroll(engine::test::dumka3_degree_3())));
    EXPECT_FALSE(last_stage_is_result(unroll(engine::test::dumka3_degree_6())));
    EXPECT_FALSE(last_stage_is_result(unroll(*find_method("rk4"))));
    EXPECT_FALSE(last_stage_is_result(unroll(*find_method("euler"))));
}

/// Methods of order 5 and more leave the pre-asymptotic steps only three halvings before rounding: their measure is read as near rounding
/// as each problem allows and may be off by 0.3. The derived order is what counts for them. Long chains amplify rounding and are read
/// earlier; so are sums of stages with large weights (serk2) and fitted methods, whose condition b·c² = 1/3 holds to some 1e-5 only.
double clear_of_rounding(const StagePlan& plan) {
    if (plan.name.starts_with("serk2") || plan.name.starts_with("fitted")) return 1e-7;
    return plan.stages.size() > 20 ? 1e-9 : 1e-10;
}

void expect_measured(const StagePlan& plan) {
    const int order = order_of(plan, plan.name.starts_with("fitted") ? 4e-5 : 1e-10);
    const bool high = order >= 5;
    const double tolerance = high ? 0.3 : 0.15;
    const double clear = clear_of_rounding(plan);
    EXPECT_NEAR(measured_order(plan, engine::test::kepler(), high ? 2e-13 : clear), order, tolerance) << plan.name << ", autonomous";
    EXPECT_NEAR(measured_order(plan, engine::test::driven(), high ? 5e-12 : clear), order, tolerance) << plan.name << ", non-autonomous";
}

TEST(Order, MeasuredIsDerivedForEveryMethodOfTheCatalogue) {
    for (const StagePlan& plan : methods()) expect_measured(plan);
}

/// The cubic through both ends of a cut step is wrong by h⁴: with transitions, no method has an order above 4.
TEST(Order, CutStepsKeepTheOrderUpToFour) {
    for (const StagePlan& plan : methods()) {
        const int order = std::min(4, order_of(plan, plan.name.starts_with("fitted") ? 4e-5 : 1e-10));
        const double clear = clear_of_rounding(plan);
        EXPECT_NEAR(measured_order(plan, engine::test::kepler(), clear, engine::test::integrate_with_cuts), order, 0.15)
            << plan.name << ", autonomous";
        EXPECT_NEAR(measured_order(plan, engine::test::driven(), clear, engine::test::integrate_with_cuts), order, 0.15)
            << plan.name << ", non-autonomous";
    }
}

TEST(Order, MeasuredIsDerivedForChainedPlans) {
    for (const StagePlan& plan : {engine::test::two_half_euler_steps(), engine::test::dumka3_degree_3(), engine::test::dumka3_degree_6()})
        expect_measured(plan);
}

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

/// Message of validate() about the two half Euler steps after one change.
std::string complaint(const std::function<void(StagePlan&)>& change) {
    StagePlan plan = engine::test::two_half_euler_steps();
    change(plan);
    try {
        validate(plan);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

TEST(PlanCheck, EveryTableOfTheCatalogueIsSound) {
    for (const StagePlan& plan : methods()) EXPECT_NO_THROW(validate(plan)) << plan.name;
}

TEST(PlanCheck, ComplaintsNamePlanAndStage) {
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].slopes[0].slot = 7; }),
                AllOf(HasSubstr("two half Euler steps"), HasSubstr("stage 1")));
}

TEST(PlanCheck, NothingIsReadBeforeItIsWritten) {
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].states[0].slot = 1; }), HasSubstr("before it is written"));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].slopes[0].slot = 1; }), HasSubstr("before it is written"));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].keep = -1; }),
                AllOf(HasSubstr("result"), HasSubstr("before it is written")));
}

TEST(PlanCheck, ButcherTableauxMustBeExplicitAndComplete) {
    EXPECT_THROW((void)butcher_plan("wide", "", "", {{0.5, 0.5}}, {0.5, 0.5}), std::invalid_argument);
    EXPECT_THROW((void)butcher_plan("short", "", "", {{0.5}}, {1.0}), std::invalid_argument);
    EXPECT_THROW((void)butcher_plan("embedded", "", "", {{0.5}}, {0.0, 1.0}, {1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace cvtflow::bench
