/// The longest stable step against the dense spectrum, and against what happens; and bounds of the step.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "bench/method/stability/step_limit.hpp"
#include "bench/study/run_watch.hpp"
#include "bench/study/spectrum.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/step/integration_state.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::bench {
namespace {

using tasks::test::settled_tiny;

/// Tiny without elastic pulleys and inner coordinates, settled for a moment: 296 unknowns, so that the dense spectrum takes a fraction of a
/// second.
Scene small() {
    Scene scene = read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml");
    set_values(scene, std::vector<std::string>{"detail.pulleys=rigid", "start.settling_time=0.2 ms", "start.ramp_time=0.2 ms",
                                               "run.schedule=serial"});
    return scene;
}

std::unique_ptr<Simulation> settled_simulation(const Scene& scene) {
    auto simulation = std::make_unique<Simulation>(scene);
    SilentObserver silent;
    const engine::Cancellation never;
    EXPECT_FALSE(simulation->advance({.until = 0.0}, silent, never));
    return simulation;
}

double stable_step(const Simulation& at, const Method& method) {
    return estimated_step_limit(at.workspace().variator, method, at.time(), at.workspace().state(), at.workspace().tips.phases.data()).step;
}

TEST(StableStep, IsTheReachOfTheMethodOverTheOutermostEigenvalueOfTheDenseSpectrum) {
    const auto owner = settled_simulation(small());
    const Workspace& w = owner->workspace();
    const std::vector<double> state(w.state(), w.state() + w.layout().size());
    double radius = 0.0;
    for (const auto& value : bench::spectrum(w.variator, 0.0, state, w.tips.phases)) radius = std::max(radius, std::abs(value));
    // The outermost eigenvalue is friction's, real; power iterations find it to some per cent from below.
    EXPECT_NEAR(stable_step(*owner, "rk4") * radius, 2.785, 0.05 * 2.785);
}

TEST(StableStep, HasNoAnswerWhereTheStateIsNotFinite) {
    const auto owner = settled_simulation(small());
    const Workspace& w = owner->workspace();
    std::vector<double> state(w.state(), w.state() + w.layout().size());
    state[5] = std::nan("");
    const double step = estimated_step_limit(w.variator, "rk4", 0.0, state.data(), w.tips.phases.data()).step;
    EXPECT_FALSE(step > 0.0 && std::isfinite(step));
}

TEST(StableStep, DistinguishesStepsThatEndFromStepsThatBlowUp) {
    const auto owner = settled_simulation(small());
    const Simulation& start = *owner;
    const double stable = stable_step(start, "rk4");
    const auto fault_at = [&](double factor) {
        Scene scene = small();
        scene.run.step = factor * stable;
        scene.run.output_interval = 300.0 * scene.run.step;
        Simulation simulation(scene);
        simulation.restore(start.integration_state());
        SilentObserver silent;
        const engine::Cancellation never;
        return simulation.advance({.until = 300.0 * scene.run.step}, silent, never);
    };
    EXPECT_FALSE(fault_at(0.5)) << fault_at(0.5).message();
    EXPECT_TRUE(fault_at(20.0)) << "within 300 steps";
}

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
