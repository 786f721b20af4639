#include "bench/study/stability/frozen_step.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "bench/method/analysis/order.hpp"
#include "bench/study/run_watch.hpp"
#include "engine/method/catalogue.hpp"
#include "tasks/run/simulation.hpp"
#include "tests/tasks/brief_start_fixture.hpp"

namespace cvtflow::bench {

using namespace tasks;
namespace {

TEST(FrozenStep, ErrorsOfOneStepGrowWithOrderPlusOne) {
    const model::Variator variator(brief_scene().parameters);
    const std::vector<double> steps{160e-9, 80e-9};
    for (const engine::StagePlan& plan : engine::methods()) {
        // Beyond order 4 a step of 80 ns is exact to rounding; stabilised methods are for longer steps.
        if (plan.stages.size() > 8 || bench::order_of(plan) > 4) continue;
        const std::vector<LocalError> errors = local_errors(variator, plan, brief_start(), steps);
        const double slope = std::log2(errors[0].velocities / errors[1].velocities);
        EXPECT_NEAR(slope, bench::order_of(plan) + 1, 0.35) << plan.name;
    }
}

TEST(FrozenStep, TheReferenceAgreesWithItself) {
    const model::Variator variator(brief_scene().parameters);
    const std::vector<double> steps{12.5e-9};  // the reference takes one step, too
    const LocalError none = local_errors(variator, *engine::find_method("rk4"), brief_start(), steps, 1).front();
    EXPECT_EQ(none.positions, 0.0);
    EXPECT_EQ(none.velocities, 0.0);
    EXPECT_EQ(none.axial_force, 0.0);
    EXPECT_EQ(none.tension, 0.0);
}

TEST(FrozenStep, ManyStepsAreAsManySingleOnes) {
    const model::Variator variator(brief_scene().parameters);
    FrozenStepper stepper(variator, *engine::find_method("heun"), brief_start().phases);
    std::vector<double> at_once = brief_start().state, one_by_one = brief_start().state;
    stepper.advance(0.0, 20e-9, 3, at_once);
    for (int number = 0; number < 3; ++number) stepper.advance(number * 20e-9, 20e-9, 1, one_by_one);
    EXPECT_EQ(at_once, one_by_one);
}

TEST(FrozenStep, BeginsWithTheProbedPhases) {
    Scene ring = read_scene(CVTFLOW_SOURCE_DIR "/scenes/free_ring.toml");
    const Simulation simulation(ring);
    const FrozenStart free = frozen_start(simulation);
    EXPECT_THAT(free.phases, testing::Each(model::Phase::free));
    EXPECT_THAT(brief_start().phases, testing::Contains(model::Phase::touching));
}

}  // namespace
}  // namespace cvtflow::bench
