#include "bench/study/comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/tasks/brief_start_fixture.hpp"

namespace cvtflow::bench {

using namespace tasks;
namespace {

Comparison compared(const std::vector<Candidate>& candidates, double duration = 60e-6, std::optional<int> pin = {}) {
    ComparisonOptions options;
    options.duration = duration;
    options.reference = {"rk4", 25e-9};
    options.rounds = 1;
    options.pin = pin;
    const engine::Cancellation never;
    return compare(brief_scene().parameters, brief_start(), candidates, options, never);
}

TEST(Comparison, OfTheReferenceWithItselfFindsNoError) {
    const Comparison same = compared({{"rk4", 25e-9}}, 60e-6, 3);
    EXPECT_EQ(same.candidates[0].error_axial, 0.0);
    EXPECT_EQ(same.candidates[0].error_tension, 0.0);
    EXPECT_EQ(same.candidates[0].error_pin, 0.0);
    EXPECT_EQ(same.reference.time.size(), 6u);  // 0, 12 … 60 us
    EXPECT_GT(same.candidates[0].seconds, 0.0);
}

TEST(Comparison, ShorterStepsAreCloserAndCostMore) {
    const Comparison found = compared({{"dumka3-p2", 2e-6}, {"dumka3-p2", 1e-6}});
    EXPECT_LT(found.candidates[1].error_tension, found.candidates[0].error_tension);
    EXPECT_GT(found.candidates[1].counters.evaluations, found.candidates[0].counters.evaluations);
    EXPECT_DOUBLE_EQ(found.candidates[0].step, 2e-6);
}

TEST(Comparison, KnowsWhatTheWatchSaysOfEveryCandidate) {
    // At this state the classical method is stable up to 0.7 us.
    const Comparison found = compared({{"rk4", 2e-6}, {"rk4", 50e-9}, {"leapfrog-chebyshev", 0.0}}, 600e-6);
    EXPECT_EQ(found.candidates[0].watch.status(found.candidates[0].fault), "unreliable");
    for (const std::size_t right : {1u, 2u}) {
        EXPECT_EQ(found.candidates[right].watch.status(found.candidates[right].fault), "finished");
        EXPECT_NEAR(found.candidates[right].watch.duration, 600e-6, 1e-12);
    }
    EXPECT_TRUE(found.reference_watch.reliable());
    EXPECT_GT(found.candidates[2].step, 0.0) << "automatic steps are named by the last one";
}

TEST(Comparison, AStepThatIsMuchTooLongIsReportedNotHidden) {
    const Comparison found = compared({{"rk4", 12e-6}}, 2.4e-3);
    if (!found.candidates[0].fault) GTEST_SKIP() << "it came through";
    EXPECT_TRUE(std::isnan(found.candidates[0].error_axial));
    EXPECT_EQ(found.candidates[0].seconds, 0.0);
}

TEST(Comparison, FindsAPinThatEntersTheDrivingSheaves) {
    // 24 pins pass within 2 ms and more, so one enters within a tenth of that or so; it carries no force before.
    const Comparison found = compared({{"dumka3-p2", 2e-6}}, 1.2e-3);
    ASSERT_TRUE(found.pin);
    const std::vector<double> force = found.reference.pin_axial(*found.pin, 0);
    ASSERT_EQ(force.size(), found.reference.time.size());
    EXPECT_GT(found.entry, 0.0);
    EXPECT_TRUE(std::isfinite(found.candidates[0].error_pin));
    double largest = 0.0;
    for (const double value : force) largest = std::max(largest, std::abs(value));
    EXPECT_GT(largest, 10.0);
}

TEST(Comparison, APinsForceIsThatOfItsTwoHalves) {
    Course course;
    course.side = {0.0, 0.0, 0.0};
    course.tip_axial = {{1, 2, 3, 4, 10, 20, 30, 40, 100, 200, 300, 400}};  // 4 per link: rear -z, rear +z, front -z, front +z
    EXPECT_EQ(course.pin_axial(1, 0), std::vector<double>{10 + 3});
    EXPECT_EQ(course.pin_axial(1, 1), std::vector<double>{20 + 4});
    EXPECT_EQ(course.pin_axial(0, 0), std::vector<double>{1 + 300});
}

TEST(Comparison, OfUnknownMethodsIsRefused) { EXPECT_THROW((void)compared({{"rk5", 1e-8}}), std::invalid_argument); }

}  // namespace
}  // namespace cvtflow::bench
