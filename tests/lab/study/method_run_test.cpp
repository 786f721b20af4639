#include "bench/study/method_run.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/method/catalogue.hpp"
#include "tests/lab/study/brief_fixture.hpp"

namespace cvtflow::bench {

using namespace tasks;
namespace {

std::vector<double> after(MethodRun& run, double duration) {
    SilentObserver silent;
    const engine::Cancellation never;
    EXPECT_FALSE(run.run(brief_start(), duration, 50e-9, 10e-6, silent, never));
    const double* state = run.workspace().state();
    return {state, state + brief_start().state.size()};
}

/// Runs twice from the state of a simulation, which also continues.
void expect_same(const std::string& method, const std::string& step, double seconds) {
    Scene scene = brief_scene();
    set_values(scene, std::vector<std::string>{"run.method=" + method, "run.step=" + step});
    Simulation whole(scene);
    SilentObserver silent;
    const engine::Cancellation never;
    ASSERT_FALSE(whole.advance({.until = 0.0}, silent, never));
    const FrozenStart start = frozen_start(whole);
    ASSERT_FALSE(whole.advance({.until = 400e-6}, silent, never));
    MethodRun run(scene.parameters, method);
    for (int again = 0; again < 2; ++again) {
        ASSERT_FALSE(run.run(start, 400e-6, seconds, 10e-6, silent, never));
        EXPECT_TRUE(std::equal(whole.workspace().state(), whole.workspace().state() + start.state.size(), run.workspace().state()))
            << method;
        EXPECT_EQ(run.counters().steps, whole.counters().steps) << method;
        EXPECT_EQ(run.step(), whole.step()) << method;
    }
}

TEST(MethodRun, IsTheRunOfASimulationBitByBit) { expect_same("rk4", "50ns", 50e-9); }

TEST(MethodRun, TakesAutomaticStepsBitByBitAsASimulationDoes) { expect_same("leapfrog-sweep", "auto", 0.0); }

TEST(MethodRun, BeginsAgain) {
    MethodRun run(brief_scene().parameters, "dumka3-p3");
    const std::vector<double> first = after(run, 100e-6);
    EXPECT_EQ(after(run, 100e-6), first);
}

TEST(MethodRun, OfAnUnknownMethodIsRefused) { EXPECT_THROW(MethodRun(brief_scene().parameters, "rk5"), std::invalid_argument); }

TEST(MethodRun, LocalErrorsByNameAreThoseOfTheTable) {
    const std::vector<double> steps{80e-9};
    const model::Parameters parameters = brief_scene().parameters;
    const LocalError named = local_errors(parameters, "heun", brief_start(), steps).front();
    const LocalError direct = local_errors(model::Variator(parameters), *engine::find_method("heun"), brief_start(), steps).front();
    EXPECT_EQ(named.velocities, direct.velocities);
    EXPECT_GT(named.velocities, 0.0);
}

TEST(MethodRun, LocalErrorsOfAProgramFallWithItsOrderPlusOne) {
    const std::vector<double> steps{200e-9, 100e-9, 50e-9};  // within half a microsecond a tip changes
    const std::vector<LocalError> errors = local_errors(brief_scene().parameters, "trapezoidal-analytic", brief_start(), steps);
    int slopes = 0;
    for (std::size_t k = 1; k < errors.size(); ++k) {
        if (!(errors[k].positions > 0.0 && errors[k - 1].positions > 0.0)) continue;  // a transition came in between
        EXPECT_NEAR(std::log2(errors[k - 1].positions / errors[k].positions), 3.0, 0.2);
        ++slopes;
    }
    EXPECT_EQ(slopes, 2);
}

TEST(MethodRun, AReferenceTakesAtLeastAsManyStepsAsAskedAndNoneLongerThanIsStable) {
    EXPECT_EQ(reference_steps(80e-9, 32), 32);
    EXPECT_EQ(reference_steps(4e-6, 32), 320);
    EXPECT_EQ(reference_steps(4.001e-6, 32), 321);
}

}  // namespace
}  // namespace cvtflow::bench
