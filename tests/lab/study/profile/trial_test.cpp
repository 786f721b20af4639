#include "bench/study/profile/trial.hpp"

#include <gtest/gtest.h>

#include "tests/claims/operating_point_fixture.hpp"

namespace cvtflow::bench {

using namespace tasks;
namespace {

/// A run searches for its automatic step once, with a hundred evaluations or more; afterwards, from time to time, with a few more.
TEST(Trial, SearchesForItsAutomaticStepOnceAsARunDoes) {
    Trial trial(claims::ready_scene("baseline", {"run.method=leapfrog-chebyshev"}), Schedule{});
    const auto evaluations = [&] { return trial.simulation().part().step_choice()->evaluations(); };
    EXPECT_EQ(trial.run(50).steps, 50);
    const long first = evaluations();
    EXPECT_GT(first, 100);
    const TrialSample second = trial.run(200);
    EXPECT_EQ(second.steps, 200);
    EXPECT_GE(second.evaluations, 200);
    EXPECT_GT(evaluations(), first) << "began again";
    EXPECT_LT(evaluations(), 2 * first);
}

TEST(Trial, CountsEveryCallsStepsBeforeAStartHasSettledToo) {
    Trial trial(claims::ready_scene("baseline", {"run.method=leapfrog-chebyshev", "start.state="}), Schedule{});
    ASSERT_TRUE(trial.simulation().needs_settling());
    for (int call = 0; call < 3; ++call) EXPECT_EQ(trial.run(20).steps, 20) << call;
}

}  // namespace
}  // namespace cvtflow::bench
