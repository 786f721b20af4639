/// Recipe "a linearly implicit method": a table of stages, each with one linear system.

#include <gtest/gtest.h>

#include <cmath>

#include "bench/method/implicit/linear_plan.hpp"
#include "tasks/method/method.hpp"

namespace cvtflow::recipes {
namespace {

/// The linearly implicit Euler method: (I - h J) u = h f, y⁺ = y + u.
bench::LinearPlan implicit_euler() { return {"w-euler", "linearly implicit Euler", "textbook", 1, {{1.0, {}, {}}}, {{0, 1.0}}}; }

TEST(LinearMethodRecipe, ItsTimesAreDerivedAndConsistent) {
    const bench::LinearTimes times = bench::times_of(implicit_euler());
    ASSERT_EQ(times.stage.size(), 1u);
    EXPECT_EQ(times.stage[0], 0.0);
    EXPECT_DOUBLE_EQ(times.result, 1.0);
}

/// On y' = λy with z = hλ the row above means (1 - γz) u = γz y, y⁺ = y + m u, by the header's own formula.
TEST(LinearMethodRecipe, DampsWhatIsStiffAsTheoryTells) {
    const bench::LinearPlan plan = implicit_euler();
    const double gamma = plan.stages[0].gamma, weight = plan.result[0].factor;
    for (const double z : {-0.1, -1.0, -1e6}) {
        const double growth = 1.0 + weight * gamma * z / (1.0 - gamma * z);
        EXPECT_NEAR(growth, 1.0 / (1.0 - z), 1e-10) << z;  // cancellation of 1 + z/(1 - z): some ulps of 1
    }
}

TEST(LinearMethodRecipe, TheCatalogueHasARowForEveryPlan) {
    for (const bench::LinearPlan& plan : bench::linear_plans()) EXPECT_NE(tasks::find_program(plan.name), nullptr) << plan.name;
}

}  // namespace
}  // namespace cvtflow::recipes
