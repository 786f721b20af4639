#include "tasks/method/auto_step.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::tasks {
namespace {

double growth_of(const Simulation& simulation, const Scene& scene) {
    NegativeSlopeFriction falling(simulation.workspace().variator, scene.parameters);
    return falling.growth(simulation.time(), simulation.workspace().state(), simulation.workspace().tips.phases.data());
}

/// Simulation after a short settling: tips bear loads.
std::unique_ptr<const Simulation> loaded(const Scene& scene) {
    auto simulation = std::make_unique<Simulation>(scene);
    settle_and_go(*simulation, 0.0);
    return simulation;
}

Scene scene_with(const char* law, const char* table = "tip.friction_coefficient=0.09") {
    return scene_of("tiny", "", {std::string("tip.friction_law=") + law, table, "start.settling_time=0.5 ms", "start.ramp_time=0.2 ms"});
}

/// Friction of two knots falls linearly between them: -μ' is the slope of the line, and differences of 2 % see it but for the ends.
TEST(NegativeSlopeFriction, GrowsWithForceAndSlopeOverMass) {
    const Scene scene = scene_with("table", "tip.friction_table=[[0.1,0.09],[0.6,0.04]]");
    const auto started = loaded(scene);
    const Simulation& simulation = *started;
    model::Observer observer(simulation.workspace().variator);
    const auto& axial = simulation.workspace().observed_by(observer, simulation.time()).tip_axial;
    double force = 0.0;
    for (const double tip : axial) force = std::max(force, std::abs(tip));
    ASSERT_GT(force, 100.0);
    const double exact = 2.0 * force * 0.1 / scene.parameters.half.mass;
    // A cubic with free ends is not the line: Fritsch and Carlson's has slope 0 at both, hence 1.5 times the secant in the middle.
    EXPECT_NEAR(growth_of(simulation, scene), 1.5 * exact, 0.01 * exact);
}

TEST(NegativeSlopeFriction, IsZeroWhereFrictionRisesOrDoesNotChange) {
    for (const Scene& scene : {scene_with("constant"), scene_with("table", "tip.friction_table=[[0.1,0.04],[0.6,0.09]]")})
        EXPECT_EQ(growth_of(*loaded(scene), scene), 0.0);
}

/// s² + a s = a g at the speed where that is fastest, a = (v + v0)/L: far below g where the memory is long.
TEST(NegativeSlopeFriction, GrowsMoreSlowlyWithMemory) {
    const char* table = "tip.friction_table=[[0.1,0.09],[0.6,0.04]]";
    Scene scene = scene_with("table", table);
    const double at_once = growth_of(*loaded(scene), scene);
    for (const double memory : {1e-12, 1e-6, 1e-4}) {
        scene.parameters.tip.friction_memory = memory;
        model::Variator remembering(scene.parameters);
        const auto started = loaded(scene_with("table", table));
        NegativeSlopeFriction falling(remembering, scene.parameters);
        const double found = falling.growth(started->time(), started->workspace().state(), started->workspace().tips.phases.data());
        double expected = 0.0;
        for (double v = 0.1; v < 0.6; v += 1e-4) {
            const double t = (v - 0.1) / 0.5, g = at_once * 4.0 * t * (1.0 - t), a = (v + 0.01) / memory;  // of a cubic with level ends
            expected = std::max(expected, 0.5 * a * (std::sqrt(1.0 + 4.0 * g / a) - 1.0));
        }
        EXPECT_NEAR(found, expected, 0.01 * expected) << memory;  // differences of 2 % of the speed
        EXPECT_LE(found, at_once * (1.0 + 1e-12)) << memory;
    }
}

/// The automatic step follows the growth where it is steep, and is that of the law's cap where it is not.
TEST(NegativeSlopeFriction, ShortensAutomaticSteps) {
    double steps[2];
    const char* tables[] = {"tip.friction_table=[[0.02,0.09],[0.5,0.089]]", "tip.friction_table=[[0.02,0.09],[0.022,0.02]]"};
    for (int k = 0; k < 2; ++k) {
        const Scene scene = scene_with("table", tables[k]);
        const auto started = loaded(scene);
        const Simulation& simulation = *started;
        AutoStep automatic(simulation.workspace().variator, scene.parameters, "leapfrog-sweep");
        steps[k] = automatic.longest(simulation.time(), simulation.workspace().state(), simulation.workspace().tips.phases.data());
        EXPECT_LE(steps[k] * growth_of(simulation, scene), 0.15 * (1.0 + 1e-12)) << tables[k];
    }
    EXPECT_LT(steps[1], 0.5 * steps[0]);
}

}  // namespace
}  // namespace cvtflow::tasks
