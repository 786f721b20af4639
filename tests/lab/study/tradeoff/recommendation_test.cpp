#include "bench/study/tradeoff/recommendation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tasks/run/simulation.hpp"
#include "tests/lab/study/brief_fixture.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

using Settings = std::vector<std::string>;

const std::vector<tasks::TradeoffPoint> tradeoffs{{"exact", 1e-6, 100.0},
                                                  {"good", 1e-4, 10.0},
                                                  {"beaten", 2e-4, 12.0},
                                                  {"fast", 1e-2, 1.0},
                                                  {"lost", std::numeric_limits<double>::infinity(), 0.1}};

TEST(ParetoFront, HoldsWhatNothingElseBeatsInBoth) {
    EXPECT_EQ(tasks::pareto_front(tradeoffs), (std::vector<bool>{true, true, false, true, false}));
}

TEST(Recommendation, IsTheFastestThatIsExactEnoughWithTheSafetyAsked) {
    EXPECT_EQ(recommended(tradeoffs, 1e-2, 1.0), 3U);
    EXPECT_EQ(recommended(tradeoffs, 1e-2, 3.0), 1U);
    EXPECT_EQ(recommended(tradeoffs, 1e-5, 3.0), 0U);
    EXPECT_EQ(recommended(tradeoffs, 1e-7, 1.0), std::nullopt);
}

const engine::Cancellation never;

ConfirmSettings brief() {
    ConfirmSettings settings;
    settings.duration = 600e-6;
    return settings;
}

Confirmation confirmation(const ConfirmSettings& settings = brief()) { return {tasks::test::settled_tiny(), settings, never}; }

TEST(Confirmation, OfWhatIsRightObjectsToNothing) {
    Confirmation confirm = confirmation();
    const Confirmed automatic = confirm.check(Settings{"run.method=leapfrog-chebyshev", "run.step=auto"});
    EXPECT_TRUE(automatic.ran);
    EXPECT_EQ(automatic.objection, "");
    EXPECT_LT(automatic.slip_error, 0.01);
    EXPECT_LT(automatic.loss_error, 0.01);
    EXPECT_EQ(confirm.check(Settings{"run.method=rk4", "run.step=100ns"}).objection, "");
}

TEST(Confirmation, ReportsWhichReferenceItTookAndHowFarItAgreesWithItself) {
    EXPECT_THAT(confirmation().reference_text(),
                testing::ContainsRegex(
                    "^leapfrog-sweep at .* s \\(0\\.25 of its automatic step; twice that is off by .* in slip, .* in losses\\)$"));
    ConfirmSettings own = brief();
    own.reference = {"run.method=rk4", "run.step=100ns"};
    EXPECT_EQ(confirmation(own).reference_text(), "rk4 at 1e-07 s");
}

TEST(Confirmation, DoesNotTryAStepBeyondStability) {
    Confirmation confirm = confirmation();
    const double limit = confirm.stable_step(Settings{"run.method=rk4"});
    ASSERT_TRUE(std::isfinite(limit));
    const auto at = [&](double step) { return Settings{"run.method=rk4", "run.step=" + std::to_string(1e9 * step) + "ns"}; };
    EXPECT_FALSE(confirm.beyond_stability(at(0.9 * limit)));
    const Confirmed beyond = confirm.check(at(1.2 * limit));
    EXPECT_EQ(beyond.objection, "beyond stability");
    EXPECT_FALSE(beyond.ran);
    EXPECT_FALSE(confirm.beyond_stability(Settings{"run.method=rk4", "run.step=auto"})) << "it chooses within the limit";
}

TEST(Confirmation, HeedsTheWatchWhateverThePrediction) {
    const Confirmation confirm = confirmation();
    const Confirmed wrong = confirm.judged(confirm.run(Settings{"run.method=rk4", "run.step=2us"}));
    EXPECT_EQ(wrong.objection, "unreliable");
}

TEST(Confirmation, ObjectsToSlipAndLossesThatAreOffByMoreThanAHundredth) {
    const Confirmation confirm = confirmation();
    LongRun run = confirm.reference();
    run.watch.means.slip *= 1.009;
    EXPECT_EQ(confirm.judged(run).objection, "");
    run.watch.loss *= 1.02;
    EXPECT_EQ(confirm.judged(run).objection, "losses off by 2 %");
    run.watch.means.slip *= 1.02 / 1.009;
    EXPECT_EQ(confirm.judged(run).objection, "slip off by 2 %");
    run.watch.balance_error_ratio = 1.1;
    EXPECT_EQ(confirm.judged(run).objection, "unreliable");
    run.fault.kind = FaultKind::penetration;
    EXPECT_EQ(confirm.judged(run).objection, "penetration");
}

TEST(Confirmation, RefusesAReferenceThatIsWrongItselfAndAStartThatIsNotSettled) {
    ConfirmSettings wrong = brief();
    wrong.reference = {"run.method=rk4", "run.step=2us"};
    EXPECT_THROW((void)confirmation(wrong), SimulationError);
    EXPECT_THROW((void)Confirmation(brief_scene(), brief(), never), SimulationError);
}

}  // namespace
}  // namespace cvtflow::bench
