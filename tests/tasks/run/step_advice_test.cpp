/// The longest stable step against the dense spectrum, and against what happens.

#include "tasks/run/step_advice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "bench/study/spectrum.hpp"
#include "engine/method/catalogue.hpp"
#include "tasks/run/simulation.hpp"

namespace cvtflow::tasks {
namespace {

/// Tiny without elastic pulleys and inner coordinates, settled for a moment: 296 unknowns, so that the dense spectrum takes a fraction of a
/// second.
Scene small() {
    Scene scene = read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml");
    set_values(scene, std::vector<std::string>{"detail.order=0", "detail.pulleys=rigid", "start.settling_time=0.2 ms",
                                               "start.ramp_time=0.2 ms", "run.schedule=serial"});
    return scene;
}

std::unique_ptr<Simulation> settled(const Scene& scene) {
    auto simulation = std::make_unique<Simulation>(scene);
    SilentObserver silent;
    const engine::Cancellation never;
    EXPECT_FALSE(simulation->advance({.until = 0.0}, silent, never));
    return simulation;
}

TEST(StableStep, FindsTheOutermostEigenvaluesOfTheDenseSpectrum) {
    const auto owner = settled(small());
    const Simulation& simulation = *owner;
    const std::vector<double> state(simulation.state(), simulation.state() + simulation.variator().layout().size());
    double radius = 0.0;
    for (const auto& value : bench::spectrum(simulation.variator(), 0.0, state, simulation.phases()))
        radius = std::max(radius, std::abs(value));
    const auto extreme = extreme_eigenvalues(simulation.variator(), 0.0, simulation.state(), simulation.phases());
    ASSERT_FALSE(extreme.empty());
    EXPECT_NEAR(std::abs(extreme.front()), radius, 0.05 * radius);
}

TEST(StableStep, IsTheReachOfTheMethodOverTheEigenvalue) {
    EXPECT_NEAR(largest_stable_step("rk4", {{-1e6, 0.0}}), 2.785e-6, 2e-9);
    EXPECT_NEAR(largest_stable_step("rk4", {{-1e6, 0.0}, {-1e2, 1e5}}), 2.785e-6, 2e-9);  // the first one sets the limit
    EXPECT_NEAR(largest_stable_step("euler", {{-1e6, 0.0}}), 2e-6, 1e-9);
    EXPECT_TRUE(std::isinf(largest_stable_step("no table of stages", {{-1e6, 0.0}})));
    EXPECT_TRUE(std::isinf(largest_stable_step("rk4", std::vector<std::complex<double>>{})));
}

TEST(StableStep, OfManyEigenvaluesIsTheLeastOfEach) {
    const std::vector<std::complex<double>> all{{-1.0e6, 0.0}, {-0.99e6, 0.0}, {-0.98e6, 1e-3}, {-3e5, 8e5}, {-1e2, 7e5}, {-2e5, 0.0}};
    for (const char* method : {"rk4", "dumka3-p2", "rkc-s10"}) {
        double least = std::numeric_limits<double>::infinity();
        for (const auto& value : all) least = std::min(least, largest_stable_step(method, {value}));
        EXPECT_EQ(largest_stable_step(method, all), least)
            << method << ": directions that were looked at already, and scans cut short, change nothing";
    }
}

TEST(StableStep, HasNoAnswerWhereTheStateIsNotFinite) {
    const auto owner = settled(small());
    const Simulation& simulation = *owner;
    std::vector<double> state(simulation.state(), simulation.state() + simulation.variator().layout().size());
    state[5] = std::nan("");
    EXPECT_TRUE(extreme_eigenvalues(simulation.variator(), 0.0, state.data(), simulation.phases()).empty());
}

TEST(StableStep, TellsStepsThatEndFromStepsThatBlowUp) {
    const auto owner = settled(small());
    const Simulation& start = *owner;
    const double stable = largest_stable_step(start.variator(), "rk4", 0.0, start.state(), start.phases());
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
}  // namespace cvtflow::tasks
