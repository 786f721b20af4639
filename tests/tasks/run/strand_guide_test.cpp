/// Guides of the strands in a run: energy, agreement of both chains, a strand at resonance, and continued bits.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "model/start/start_state.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::tasks {
namespace {

/// The scene `tiny` with rails that press on its strands all the time, and take more than all other losses.
Scene pressed_scene(const std::string& detail, const std::vector<std::string>& more = {}) {
    return scene_of("tiny", detail,
                    {"start.settling_time=3 ms", "start.ramp_time=1 ms", "run.method=auto", "guide.stiffness=1e6 N/m", "guide.clearance=0",
                     "guide.offset=-0.3 mm", "guide.friction_coefficient=0.5"},
                    more);
}

double lost_by_guides(const Simulation& simulation) {
    return simulation.workspace().energy.sums(simulation.time()).loss[static_cast<std::size_t>(model::Loss::guide)];
}

class StrandGuide : public testing::TestWithParam<std::string> {};

/// The guides' losses are missing elsewhere: the balance of works, stored energy and all losses closes to a thousandth of them. The error
/// of rigid pins is of second order in the step.
TEST_P(StrandGuide, TakesTheEnergyThatItsAccountStates) {
    Simulation simulation(pressed_scene(GetParam(), {GetParam() == "rigid" ? "run.step=1 us" : "run.step=auto"}));
    settle_and_go(simulation, 0.0);
    const double before = lost_by_guides(simulation), all_before = simulation.workspace().energy.sums(0.0).lost();
    const EnergyMark from = simulation.workspace().energy.mark();
    settle_and_go(simulation, 2e-3);
    const double taken = lost_by_guides(simulation) - before;
    EXPECT_GT(taken, 0.5 * (simulation.workspace().energy.sums(simulation.time()).lost() - all_before));
    EXPECT_LT(std::abs(simulation.workspace().energy.balance(from).residual()), 1e-3 * taken);
}

TEST_P(StrandGuide, ContinuesBitForBitFromAnIntegrationState) { expect_continued(pressed_scene(GetParam()), 3e-4, 6e-4); }

TEST_P(StrandGuide, WithoutStiffnessIsAbsent) {
    const std::vector<std::string> brief{"start.settling_time=0.2 ms", "start.ramp_time=0.1 ms", "run.method=auto"};
    Scene without = pressed_scene(GetParam(), brief);
    const std::uint64_t none = hash_at(scene_of("tiny", GetParam(), brief), 1e-4);
    EXPECT_NE(hash_at(without, 1e-4), none);
    set_value(without, "guide.stiffness=0");
    EXPECT_EQ(hash_at(without, 1e-4), none);
}

INSTANTIATE_TEST_SUITE_P(Levels, StrandGuide, testing::Values("rigid", "fine"), [](const auto& instance) { return instance.param; });

/// Rails that bend the strands inward by 2 mm: the force follows from tension and geometry. Strands of rigid pins run some 0.05 mm nearer
/// to the tangents, which is 3 % of the way.
TEST(StrandGuides, PressAlikeAtBothChains) {
    double force[2] = {};
    for (const std::size_t level : {0u, 1u}) {
        Simulation simulation(
            scene_of("baseline", level == 0 ? "rigid" : "fine",
                     {"start.settling_time=20 ms", "guide.stiffness=1e6 N/m", "guide.clearance=0", "guide.offset=-2 mm"}));
        double outputs = 0.0;
        Outputs watch = observed_outputs(simulation, [&](double, const model::Observation& now) {
            force[level] += now.guide[0].force + now.guide[1].force;
            ++outputs;
        });
        settle_and_go(simulation, 20e-3, watch);
        force[level] /= outputs;
    }
    EXPECT_GT(force[0], 500.0);
    EXPECT_NEAR(force[0] / force[1], 1.0, 0.05);
}

/// Rails far stiffer than the chain: a pin of mass m on one swings with sqrt(k/m); a half, whose plates take part less, up to twice as
/// fast.
TEST(StrandGuides, AreCountedInTheStableStep) {
    for (const std::string detail : {"rigid", "fine"}) {
        Scene scene = pressed_scene(detail, {"start.state=", "guide.damping=0"});
        scene.parameters.guide.stiffness = 1e11;  // beyond the range of the key
        const double frequency = std::sqrt(scene.parameters.guide.stiffness / model::link_mass(scene.parameters));
        const double found = largest_step(Simulation(scene)).rate;
        EXPECT_GT(found, 0.95 * frequency) << detail;
        EXPECT_LT(found, 2.0 * frequency) << detail;
    }
}

/// The passing of the pins excites the tight strand of a lightly loaded chain at 1050 rpm. Rails too soft to matter only show how far it
/// swings; others hold it within their play of 0.4 mm and their deflection.
TEST(StrandGuides, BoundAStrandAtResonance) {
    const auto swing = [](const std::string& stiffness) {
        Simulation simulation(
            scene_of("control", "rigid",
                     {"drive.speed=1050 rpm", "load.torque=50 N*m", "control.ratio=1", "control.gains=found", "control.authority=60 kN",
                      "guide.offset=0.2 mm", "guide.clearance=0.4 mm", "guide.stiffness=" + stiffness}));
        double farthest = 0.0;
        Outputs watch = observed_outputs(
            simulation, [&](double, const model::Observation& now) { farthest = std::max(farthest, std::abs(now.guide[0].deflection)); });
        settle_and_go(simulation, 0.4, watch);
        return farthest;
    };
    EXPECT_GT(swing("1 N/m"), 2.0 * 0.4e-3);
    EXPECT_LT(swing("1e6 N/m"), 0.4e-3 + 0.15e-3);
}

}  // namespace
}  // namespace cvtflow::tasks
