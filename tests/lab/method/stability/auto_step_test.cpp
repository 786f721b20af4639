/// Automatic steps are stable on machines that are not the ready ones, by the analysis of one step.

#include "tasks/method/auto_step.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "bench/method/stability/predicted_step.hpp"
#include "bench/study/run_watch.hpp"
#include "tasks/run/simulation.hpp"
#include "tests/claims/operating_point_fixture.hpp"

namespace cvtflow::tasks {
namespace {

/// Shares of oscillation and damping add up, which gives away half where both are of other motions; and the step has its margin.
constexpr double given_away = 2.0 / AutoStep::margin;

/// Disturbances grew by 0.14 to 9 a step without regard to damping. Slower growth belongs to frequencies that a step changes.
constexpr double noticeable_growth = 1e-2;

TEST(AutoStepOnMachines, IsStableAndNotNeedlesslyShort) {
    for (const char* machine :
         {"chain.damping_ratio=0.05", "chain.damping_ratio=0.15", "chain.damping_ratio=1", "pulley.sheave_mass=0.5",
          "pulley.sheave_mass=0.2", "pulley.shaft_mass=0.3", "pulley.cylinder_damping=3e6", "pulley.cylinder_damping=1e8"}) {
        SCOPED_TRACE(machine);
        for (const char* method : {"leapfrog-chebyshev", "leapfrog-sweep"}) {
            const Scene scene = claims::ready_scene("tiny", {machine, std::string("run.method=") + method});
            const Simulation simulation(scene);
            AutoStep automatic(simulation.workspace().variator, scene.parameters, method);
            const double step =
                automatic.longest(simulation.time(), simulation.workspace().state(), simulation.workspace().tips.phases.data());
            const bench::LinearChain chain(simulation.workspace().variator, scene.parameters, bench::frozen_start(simulation));
            // These machines do not rest in the state of the ready one: what grows by itself grows alike in shorter steps.
            const double by_itself = std::max(1.0, std::pow(bench::predicted_growth(chain, method, step / 4.0), 4.0));
            EXPECT_LE(bench::predicted_growth(chain, method, step), by_itself + noticeable_growth) << method << ", " << step << " s";
            if (step == automatic.longest()) continue;
            EXPECT_GT(bench::predicted_growth(chain, method, given_away * step), 1.0 + bench::growth_factor_tolerance)
                << method << ", " << step << " s";
        }
    }
}

}  // namespace
}  // namespace cvtflow::tasks
