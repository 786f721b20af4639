#include "tasks/step/control/step_control.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace cvtflow::tasks {
namespace {

TEST(ErrorScale, MeasuresCoordinatesInMicrometresAndVelocitiesInSaturationSpeeds) {
    const ErrorScale scale{1e-6, 2e-3};
    const std::array<double, 4> errors{3e-6, 0.0, 0.0, 8e-3};  // q, q, v, v
    EXPECT_DOUBLE_EQ(scale.norm(errors.data(), 2), std::sqrt((9.0 + 16.0) / 4.0));
}

TEST(StepSizeControl, BeginsWithTheLongestStepAndNeverExceedsIt) {
    StepSizeControl control(1e-6, 3);
    EXPECT_EQ(control.proposal(), 1e-6);
    EXPECT_TRUE(control.judge(1e-9, 1e-6));
    EXPECT_EQ(control.proposal(), 1e-6);
}

TEST(StepSizeControl, RejectsTooLargeErrorsAndWhatIsNoNumber) {
    for (const double error : {1.0001, 1e30, std::numeric_limits<double>::infinity(), std::nan("")}) {
        StepSizeControl control(1e-6, 3);
        EXPECT_FALSE(control.judge(error, 1e-6)) << error;
        EXPECT_LT(control.proposal(), 0.91e-6) << error;
        EXPECT_GE(control.proposal(), 0.99e-7) << error;
    }
}

/// error = (step/h1)^power: the steps settle where the error is a little below 1, whatever they begin with.
TEST(StepSizeControl, FindsTheStepThatTheToleranceAllows) {
    for (const int power : {2, 3, 5, 8}) {
        StepSizeControl control(1e-3, power);
        double step = control.proposal();
        for (int i = 0; i < 100; ++i) {
            (void)control.judge(std::pow(step / 1e-6, power), step);
            step = control.proposal();
        }
        EXPECT_LT(step, 1e-6) << power;
        EXPECT_GT(step, 0.5e-6) << power;
    }
}

TEST(StepSizeControl, AStepShortenedForAnOutputDoesNotShortenTheNext) {
    StepSizeControl control(1e-6, 3);
    EXPECT_TRUE(control.judge(1e-8, 1e-9));
    EXPECT_EQ(control.proposal(), 1e-6);
}

TEST(StepSizeControl, DoesNotGrowRightAfterARejection) {
    StepSizeControl control(1e-6, 3);
    EXPECT_FALSE(control.judge(8.0, 1e-6));
    const double shorter = control.proposal();
    EXPECT_TRUE(control.judge(1e-3, shorter));
    EXPECT_LE(control.proposal(), shorter);
    EXPECT_TRUE(control.judge(1e-3, shorter));
    EXPECT_GT(control.proposal(), shorter);
}

}  // namespace
}  // namespace cvtflow::tasks
