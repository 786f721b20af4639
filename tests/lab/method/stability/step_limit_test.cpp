#include "bench/method/stability/step_limit.hpp"
#include "tasks/run/simulation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/study/run_watch.hpp"
#include "tasks/step/integration_state.hpp"
#include "tests/tasks/settled_tiny_fixture.hpp"

namespace cvtflow::bench {
using tasks::test::settled_tiny;

namespace {

TEST(StepLimitBound, ReportsWhatLimitsALeapfrogAndContinuesCheaply) {
    const Simulation simulation(settled_tiny());
    const FrozenStart start = frozen_start(simulation);
    StepLimitBound bound(simulation.workspace().variator, "leapfrog-chebyshev");
    const int cold = bound.update(start.time, start.state.data(), start.phases.data());
    const StepLimit first = bound.limit();
    EXPECT_EQ(first.by, StepLimiter::oscillation);
    EXPECT_GT(first.oscillation * first.step, 1.41);  // no friction makes it less
    EXPECT_LE(first.oscillation * first.step, 2.0);   // the leapfrog without friction
    const int warm = bound.update(start.time, start.state.data(), start.phases.data());
    RecordProperty("evaluations", std::to_string(cold) + " " + std::to_string(warm));
    EXPECT_LT(warm, cold / 2);
    EXPECT_NEAR(bound.limit().step / first.step, 1.0, 0.05) << "power iterations continue";
}

TEST(StepLimitBound, SetsNoLimitToMethodsThatSolveForTheWholeState) {
    const Simulation simulation(settled_tiny());
    const FrozenStart start = frozen_start(simulation);
    StepLimitBound bound(simulation.workspace().variator, "trapezoidal-full");
    EXPECT_EQ(bound.update(start.time, start.state.data(), start.phases.data()), 0);
    EXPECT_TRUE(std::isinf(bound.limit().step));
    EXPECT_THROW(StepLimitBound(simulation.workspace().variator, "no method"), std::invalid_argument);
}

TEST(StepLimitBound, IsScaledByWhatIsKnownBetter) {
    const Simulation simulation(settled_tiny());
    const FrozenStart start = frozen_start(simulation);
    StepLimitBound bound(simulation.workspace().variator, "leapfrog-rkc");
    bound.update(start.time, start.state.data(), start.phases.data());
    const double known = 0.5 * bound.limit().step;
    bound.calibrate(known);
    EXPECT_EQ(bound.limit().step, known);
    bound.update(start.time, start.state.data(), start.phases.data());
    EXPECT_NEAR(bound.limit().step / known, 1.0, 0.05) << "power iterations continue";
}

TEST(StepLimitBound, ContinuesFromItsMemoryWithTheSameBits) {
    const Simulation simulation(settled_tiny());
    const FrozenStart start = frozen_start(simulation);
    StepLimitBound bound(simulation.workspace().variator, "leapfrog-rkc"), other(simulation.workspace().variator, "leapfrog-rkc");
    bound.update(start.time, start.state.data(), start.phases.data());
    std::vector<double> memory;
    bound.save(memory);
    memory.push_back(7.0);
    EXPECT_EQ(other.load(memory).size(), 1u);
    EXPECT_EQ(other.limit().step, bound.limit().step);
    bound.update(start.time, start.state.data(), start.phases.data());
    other.update(start.time, start.state.data(), start.phases.data());
    EXPECT_EQ(other.limit().step, bound.limit().step);
}

/// Fastest oscillation that limits leapfrogs on rigid pins at their geometric start [1/s].
double oscillation_of(const char* mass_scaling) {
    Scene scene = read_scene(CVTFLOW_SOURCE_DIR "/scenes/tiny.toml");
    apply_detail(scene, "rigid");
    set_values(scene,
               std::vector<std::string>{std::string("detail.mass_scaling=") + mass_scaling, "start.state=", "start.settling_time=0"});
    const Simulation simulation(scene);
    const FrozenStart start = frozen_start(simulation);
    StepLimitBound bound(simulation.workspace().variator, "leapfrog-sweep");
    bound.update(start.time, start.state.data(), start.phases.data());
    return bound.limit().oscillation;
}

/// Pins in a row against each other: 2 sqrt(k/m), with plates and joint in series. It is a translation, which mass scaling does not slow.
TEST(StepLimitBound, OfRigidPinsIsSetByPinsInARowWhateverTheirMassScaling) {
    const model::Parameters p = read_scene(CVTFLOW_SOURCE_DIR "/scenes/tiny.toml").parameters;
    const double plates = p.plate.count * p.plate.stiffness, stiffness = plates * p.joint.stiffness / (plates + p.joint.stiffness);
    const double row = 2.0 * std::sqrt(stiffness / (2.0 * p.half.mass + p.plate.count * p.plate.mass));
    for (const char* mass_scaling : {"1", "30"}) EXPECT_NEAR(oscillation_of(mass_scaling) / row, 1.0, 0.05) << mass_scaling;
}

}  // namespace
}  // namespace cvtflow::bench
