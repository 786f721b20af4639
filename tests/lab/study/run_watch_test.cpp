#include "bench/study/run_watch.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tasks/run/simulation.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

bench::WatchResult watched(const std::vector<std::string>& settings, double duration) {
    Simulation simulation(test::settled_tiny(settings));
    bench::RunWatch watch;
    Outputs observer = observed_outputs(simulation, [&](double, const auto& now) { watch.add(now, simulation.workspace()); });
    const engine::Cancellation never;
    EXPECT_FALSE(simulation.advance({.until = simulation.time() + duration}, observer, never));
    return watch.result(simulation.workspace().energy, simulation.balance_error_ratio());
}

TEST(RunWatch, KnowsHowLongARunWasInPinPeriods) {
    const bench::WatchResult brief = watched({}, 100e-6);
    EXPECT_NEAR(brief.duration, 100e-6, 1e-12);
    ASSERT_GT(brief.pin_period, 0.0);
    EXPECT_DOUBLE_EQ(brief.pin_periods(), brief.duration / brief.pin_period);
    EXPECT_FALSE(brief.long_enough());
    bench::WatchResult longer = brief;
    longer.duration = bench::enough_pin_periods * brief.pin_period;
    EXPECT_TRUE(longer.long_enough());
}

TEST(RunWatch, NothingThatPassesAPulleyNeedsNoPinPeriods) {
    const bench::WatchResult none;
    EXPECT_EQ(none.pin_periods(), 0.0);
    EXPECT_TRUE(none.long_enough());
}

/// The classical method is stable up to 0.7 us at this state.
TEST(RunWatch, CallsAStepBeyondStabilityUnreliable) {
    EXPECT_EQ(watched({"run.step=50ns"}, 600e-6).status({}), "finished");
    const bench::WatchResult wrong = watched({"run.method=rk4", "run.step=2us"}, 600e-6);
    EXPECT_FALSE(wrong.reliable());
    EXPECT_EQ(wrong.status({}), "unreliable");
    EXPECT_EQ(wrong.status({FaultKind::penetration, 0.0, 0, 0.0, 0.0}), "penetration") << "a fault is more specific";
}

TEST(RunWatch, LossesDoNotDependOnWhereTheLastSampleLay) {
    // Samples lie 16 steps apart: at 25 ns and 200 ns they end at most 3.2 us before the run, a thirtieth of it.
    const double fine = watched({"run.step=25ns"}, 100e-6).loss, coarse = watched({"run.step=200ns"}, 100e-6).loss;
    EXPECT_NEAR(coarse / fine, 1.0, 2e-3);
}

}  // namespace
}  // namespace cvtflow::tasks
