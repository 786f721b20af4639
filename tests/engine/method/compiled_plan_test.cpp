#include "engine/method/compiled_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "plan_fixture.hpp"

namespace cvtflow::engine {
namespace {

bool same(std::span<const Term> a, const std::vector<Term>& b) { return std::equal(a.begin(), a.end(), b.begin(), b.end()); }

TEST(CompiledPlan, CarriesEveryTermOfThePlan) {
    const StagePlan plan = test::dumka3_degree_3();
    const CompiledPlan compiled(plan);
    ASSERT_EQ(compiled.stages(), 4);
    for (int i = 0; i < compiled.stages(); ++i) {
        const Stage& stage = plan.stages[static_cast<std::size_t>(i)];
        const PlanStep step = compiled.stage(i);
        EXPECT_TRUE(same(step.states, stage.states) && same(step.slopes, stage.slopes)) << i;
        EXPECT_EQ(step.keep, stage.keep);
        EXPECT_EQ(step.slope, stage.slope);
    }
    EXPECT_TRUE(same(compiled.result().states, plan.result.states));
    ASSERT_TRUE(compiled.has_error());
    EXPECT_TRUE(same(compiled.error().slopes, plan.error->slopes));
}

TEST(CompiledPlan, TheResultBelongsToTheEndOfTheStep) {
    EXPECT_NEAR(CompiledPlan(test::dumka3_degree_3()).result().time, 1.0, 1e-14);
    EXPECT_NEAR(CompiledPlan(test::dumka3_degree_6()).result().time, 1.0, 1e-14);
}

TEST(CompiledPlan, CopiesReferToTheirOwnTerms) {
    auto original = std::make_unique<CompiledPlan>(test::dumka3_degree_6());
    const CompiledPlan copy = *original;
    original.reset();
    EXPECT_TRUE(same(copy.stage(5).states, test::dumka3_degree_6().stages[5].states));
}

/// A chain of Euler substeps over two state slots, the form of the largest stabilised schemes.
TEST(CompiledPlan, CarriesLongLowStorageSchemes) {
    constexpr int substeps = 324;
    StagePlan plan{"chain", "", "", 3, 3, {{{{0, 1.0}}, {}, -1, 0}}, {}, {}};
    int state = 0;
    int slope = 0;
    for (int i = 1; i < substeps; ++i) {
        const int next = state == 1 ? 2 : 1;
        plan.stages.push_back({{{state, 1.0}}, {{slope, 1.0 / substeps}}, next, next});
        state = slope = next;
    }
    plan.result = {{{state, 1.0}}, {{slope, 1.0 / substeps}}};
    const CompiledPlan compiled(plan);
    for (int i = 0; i < substeps; ++i) EXPECT_NEAR(compiled.stage(i).time, static_cast<double>(i) / substeps, 1e-13);
}

}  // namespace
}  // namespace cvtflow::engine
