#include "bench/study/stability/stable_step.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "bench/method/linear/eigenvalues.hpp"
#include "bench/study/spectrum.hpp"
#include "bench/study/stability/eigenvalue_step.hpp"
#include "engine/method/catalogue.hpp"
#include "tests/tasks/brief_start_fixture.hpp"

namespace cvtflow::bench {

using namespace tasks;
namespace {

TEST(MeasuredStep, IsWhatTheSpectrumPredictsWithinFivePercent) {
    const model::Variator variator(brief_scene().parameters);
    const FrozenStart& start = brief_start();
    const bench::Eigenvalues all = spectrum(variator, start.time, start.state, start.phases);
    double growth = 0.0;  // barely settled, something still buckles
    for (const auto& value : all) growth = std::max(growth, value.real());
    for (const char* name : {"rk4", "heun", "dumka3-p2"}) {
        const engine::StagePlan& plan = *engine::find_method(name);
        const double predicted = largest_stable_step(plan, all).step;
        const MeasuredStep measured = measured_stable_step(variator, plan, start, predicted, growth);
        EXPECT_NEAR(measured.limit() / predicted, 1.0, 0.05) << name;
        EXPECT_LT(measured.stable, measured.unstable);
        EXPECT_GT(measured.evaluations, 0);
    }
}

TEST(MeasuredStep, ReportsWhenTheLimitIsNotWhereItIsExpected) {
    const model::Variator variator(brief_scene().parameters);
    const engine::StagePlan& rk4 = *engine::find_method("rk4");
    const MeasuredStep beyond = measured_stable_step(variator, rk4, brief_start(), 1e-9);
    EXPECT_EQ(beyond.unstable, 0.0);
    EXPECT_DOUBLE_EQ(beyond.limit(), 1.6e-9);
    const MeasuredStep below = measured_stable_step(variator, rk4, brief_start(), 1e-5);
    EXPECT_EQ(below.stable, 0.0);
}

TEST(MeasuredStep, AHeldStateStandsStillUntilItIsDisturbed) {
    const model::Variator variator(brief_scene().parameters);
    const FrozenStart& start = brief_start();
    FrozenStepper stepper(variator, *engine::find_method("rk4"), start.phases);
    stepper.hold(start.time, start.state);
    std::vector<double> state = start.state;
    stepper.advance(start.time, 1e-8, 10, state);
    EXPECT_EQ(state, start.state);
}

}  // namespace
}  // namespace cvtflow::bench
