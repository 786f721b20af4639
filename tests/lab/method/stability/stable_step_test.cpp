/// The longest stable step against the dense spectrum, and against what happens.

#include "bench/method/stability/step_limit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "bench/study/spectrum.hpp"
#include "tasks/run/simulation.hpp"

namespace cvtflow::bench {
namespace {

/// Tiny without elastic pulleys and inner coordinates, settled for a moment: 296 unknowns, so that the dense spectrum takes a fraction of a
/// second.
Scene small() {
    Scene scene = read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml");
    set_values(scene, std::vector<std::string>{"detail.order=0", "detail.pulleys=rigid", "start.settling_time=0.2 ms",
                                               "start.ramp_time=0.2 ms", "run.schedule=serial"});
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

}  // namespace
}  // namespace cvtflow::bench
