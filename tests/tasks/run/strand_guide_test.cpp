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

Scene guided_scene(const std::string& name, const std::string& detail, const std::vector<std::string>& more) {
    Scene scene = read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/" + name + ".toml");
    apply_detail(scene, detail);
    set_values(scene, more);
    return scene;
}

/// The scene `tiny` with rails that press on its strands all the time, and take more than all other losses.
Scene pressed_scene(const std::string& detail, const std::vector<std::string>& more = {}) {
    Scene scene = guided_scene("tiny", detail,
                               {"start.settling_time=3 ms", "start.ramp_time=1 ms", "run.method=auto", "guide.stiffness=1e6 N/m",
                                "guide.clearance=0", "guide.offset=-0.3 mm", "guide.friction_coefficient=0.5"});
    set_values(scene, more);
    return scene;
}

/// Means and extremes over the outputs.
class GuideWatch final : public RunObserver {
public:
    explicit GuideWatch(const Simulation& simulation) : observer_(simulation.workspace().variator) {}
    void output(double time, const Workspace& workspace, const Counters&) override {
        const model::Observation& now = workspace.observed_by(observer_, time);
        ++count_;
        for (std::size_t strand = 0; strand < 2; ++strand) {
            force_[strand] += now.guide[strand].force;
            farthest[strand] = std::max(farthest[strand], std::abs(now.guide[strand].deflection));
        }
    }
    void transition(const TransitionRecord&) override {}
    [[nodiscard]] double force(std::size_t strand) const { return force_[strand] / count_; }
    double farthest[2] = {};  ///< [m]

private:
    model::Observer observer_;
    double force_[2] = {}, count_ = 0.0;
};

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
    Simulation none(guided_scene("tiny", GetParam(), {"start.settling_time=0.2 ms", "start.ramp_time=0.1 ms", "run.method=auto"})),
        without(pressed_scene(GetParam(), {"guide.stiffness=0", "start.settling_time=0.2 ms", "start.ramp_time=0.1 ms"})),
        with(pressed_scene(GetParam(), {"start.settling_time=0.2 ms", "start.ramp_time=0.1 ms"}));
    for (Simulation* each : {&none, &without, &with}) settle_and_go(*each, 1e-4);
    EXPECT_EQ(without.hash(), none.hash());
    EXPECT_NE(with.hash(), none.hash());
    EXPECT_EQ(lost_by_guides(without), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Levels, StrandGuide, testing::Values("rigid", "fine"), [](const auto& instance) { return instance.param; });

/// Rails that bend the strands inward by 2 mm: the force follows from tension and geometry. Strands of rigid pins run some 0.05 mm nearer
/// to the tangents, which is 3 % of the way.
TEST(StrandGuides, PressAlikeAtBothChains) {
    double force[2];
    for (const std::size_t level : {0u, 1u}) {
        Simulation simulation(guided_scene(
            "baseline", level == 0 ? "rigid" : "fine",
            {"start.state=", "start.settling_time=20 ms", "guide.stiffness=1e6 N/m", "guide.clearance=0", "guide.offset=-2 mm"}));
        GuideWatch watch(simulation);
        settle_and_go(simulation, 20e-3, watch);
        force[level] = watch.force(0) + watch.force(1);
    }
    EXPECT_GT(force[0], 500.0);
    EXPECT_NEAR(force[0] / force[1], 1.0, 0.05);
}

/// Rails far stiffer than the chain: a pin of mass m on one swings with sqrt(k/m); a half, whose plates take part less, up to twice as
/// fast.
TEST(StrandGuides, AreCountedInTheStableStep) {
    for (const std::string detail : {"rigid", "fine"}) {
        Scene scene = pressed_scene(detail, {"start.state="});
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
            guided_scene("control", "rigid",
                         {"start.state=", "drive.speed=1050 rpm", "load.torque=50 N*m", "control.ratio=1", "control.gains=found",
                          "control.authority=60 kN", "guide.offset=0.2 mm", "guide.clearance=0.4 mm", "guide.stiffness=" + stiffness}));
        GuideWatch watch(simulation);
        settle_and_go(simulation, 0.4, watch);
        return watch.farthest[0];
    };
    EXPECT_GT(swing("1 N/m"), 2.0 * 0.4e-3);
    EXPECT_LT(swing("1e6 N/m"), 0.4e-3 + 0.15e-3);
}

}  // namespace
}  // namespace cvtflow::tasks
