/// Recipe "an explicit method": a table, from which order, stability and stage times are derived.

#include <gtest/gtest.h>

#include <cmath>

#include "bench/method/analysis/order.hpp"
#include "bench/method/analysis/plan_check.hpp"
#include "engine/method/stage_plan.hpp"

namespace cvtflow::recipes {
namespace {

/// A file of engine/method contains one function like this. Ralston's method, with the smallest error bound of all of order 2 and two
/// stages.
engine::StagePlan ralston() {
    return engine::butcher_plan("ralston", "order 2 with the smallest error bound", "Ralston, Math. Comp. 16 (1962) 431-437", {{2.0 / 3.0}},
                                {0.25, 0.75});
}

TEST(MethodRecipe, OrderIsDerivedFromTheTable) {
    const engine::StagePlan plan = ralston();
    EXPECT_NO_THROW(bench::validate(plan));
    EXPECT_EQ(bench::order_of(plan), 2);
    EXPECT_EQ(plan.stages.size(), 2u);
}

TEST(MethodRecipe, AWrongTableIsFoundOut) {
    engine::StagePlan wrong = ralston();
    wrong.result.slopes[0].factor = 0.3;  // weights no longer sum to 1
    EXPECT_EQ(bench::order_of(wrong), 0);
}

}  // namespace
}  // namespace cvtflow::recipes
