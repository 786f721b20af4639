/// Drag of the shafts in a run: where its energy comes from, what the efficiency makes of it, and that a run continues bit for bit.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "bench/study/run_watch.hpp"
#include "tasks/channel/channels.hpp"
#include "tasks/run/run_means.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::tasks {
namespace {

const engine::Cancellation drag_uncancelled;

constexpr double driving_torque = 14.0, loading_torque = 11.0;  // [N·m]

/// `tiny` between two constant torques, its shafts with seals, bearings and oil.
Scene dragged_scene(const std::string& detail, std::vector<std::string> more = {}) {
    Scene scene = read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml");
    apply_detail(scene, detail);
    std::vector<std::string> settings{"start.settling_time=2 ms",
                                      "start.ramp_time=1 ms",
                                      "drive.mode=torque",
                                      "drive.torque=14 N*m",
                                      "load.torque=11 N*m",
                                      "drag.driving_seals=0.3 N*m",
                                      "drag.driving_viscous=2e-3 N*m*s/rad",
                                      "drag.driven_seals=0.2 N*m",
                                      "drag.driven_churning=1e-5 N*m*s^2/rad^2",
                                      "drag.bearing_friction=0.0015"};
    settings.emplace_back("run.step=0.2 us");
    settings.insert(settings.end(), more.begin(), more.end());
    set_values(scene, settings);
    return scene;
}

double shaft_angle(const Simulation& simulation, int shaft) {
    const double* tail = simulation.workspace().state() + simulation.workspace().layout().pulley_begin();
    return tail[simulation.workspace().variator.pulleys().rotation(shaft)];
}

class ShaftDrag : public testing::TestWithParam<std::string> {};

/// Constant torques from outside do T Δφ, of which drag takes its part and the variator gets the rest.
TEST_P(ShaftDrag, TakesWhatTheVariatorDoesNotGet) {
    Simulation simulation(dragged_scene(GetParam()));
    settle_and_go(simulation, 0.0);
    const double from[2] = {shaft_angle(simulation, 0), shaft_angle(simulation, 1)};
    const EnergySums before = simulation.workspace().energy.sums(0.0);
    settle_and_go(simulation, 3e-3);
    const EnergySums after = simulation.workspace().energy.sums(simulation.time());
    const double torque[2] = {driving_torque, -loading_torque};
    double brought = 0.0, dragged = 0.0;
    for (std::size_t k = 0; k < 2; ++k) {
        const double outside = torque[k] * (shaft_angle(simulation, static_cast<int>(k)) - from[k]);
        const double taken = after.drag[k] - before.drag[k];
        EXPECT_GT(taken, 0.015 * std::abs(outside)) << "shaft " << k + 1;
        EXPECT_NEAR(outside, after.work[k] - before.work[k] + taken, 1e-3 * taken) << "shaft " << k + 1;
        brought += std::max(0.0, outside);
        dragged += taken;
    }
    EXPECT_LE(simulation.workspace().energy.balance_error_ratio(), 1.0);
    const double clamping = std::max(0.0, after.work[2] - before.work[2]);
    const double lost = after.lost() - before.lost() + dragged;
    EXPECT_NEAR(after.overall_since(before, 0.0, 0.0), 1.0 - lost / (brought + clamping), 1e-5);
    EXPECT_LT(after.overall_since(before, 0.0, 0.0), after.efficiency_since(before) - 0.02);
}

/// Impulses of drive and load are those from outside; the variator gets what drag leaves of them.
TEST_P(ShaftDrag, LeavesTheImpulseFromOutsideAsItIs) {
    Simulation with(dragged_scene(GetParam())),
        without(dragged_scene(GetParam(), {"drag.driving_seals=0", "drag.driving_viscous=0", "drag.driven_seals=0",
                                           "drag.driven_churning=0", "drag.bearing_friction=0"}));
    for (Simulation* each : {&with, &without}) settle_and_go(*each, 1e-3);
    const InputWorks &dragged = with.workspace().energy.input_works(), &free = without.workspace().energy.input_works();
    EXPECT_EQ(free.drag.energy[0], 0.0);
    EXPECT_EQ(free.net_impulse()[1], free.impulse[1]);
    EXPECT_NEAR(dragged.impulse[0], free.impulse[0], 1e-9) << "the drive's";
    EXPECT_LT(dragged.net_impulse()[0], dragged.impulse[0] - 0.3 * 1e-3) << "of the seals alone";
    EXPECT_LT(dragged.net_impulse()[1], dragged.impulse[1] - 0.2 * 1e-3);
}

TEST_P(ShaftDrag, ContinuesBitForBitFromAnIntegrationState) {
    const Scene scene = dragged_scene(GetParam());
    const ContinuedRun run(scene, 3e-4, 6e-4);
    EXPECT_EQ(run.other.hash(), run.whole.hash());
    EXPECT_EQ(run.other.workspace().energy.input_works().drag.energy, run.whole.workspace().energy.input_works().drag.energy);
}

INSTANTIATE_TEST_SUITE_P(Levels, ShaftDrag, testing::Values("rigid", "medium"), [](const auto& instance) { return instance.param; });

/// Powers of the summary are from outside to outside: the drive's torque times its speed comes in.
TEST(ShaftDragSummary, CountsDragAmongTheLosses) {
    const Scene scene = dragged_scene("rigid");
    Simulation simulation(scene);
    settle_and_go(simulation, 0.0);
    bench::RunWatch watch;
    class Outputs final : public RunObserver {
    public:
        Outputs(bench::RunWatch& watch, const Simulation& of) : watch_(watch), observer_(of.workspace().variator) {}
        void output(double time, const Workspace& workspace, const Counters&) override {
            watch_.add(workspace.observed_by(observer_, time), workspace);
        }
        void transition(const TransitionRecord&) override {}

    private:
        bench::RunWatch& watch_;
        model::Observer observer_;
    } outputs(watch, simulation);
    ASSERT_FALSE(simulation.advance({.until = 3e-3, .new_part = true}, outputs, drag_uncancelled));
    const SpanMeans means = watch.result(simulation.workspace().energy).means;
    EXPECT_NEAR(means.shaft_power[0], driving_torque * means.speed[0], 1e-3 * means.input);
    EXPECT_NEAR(-means.shaft_power[1], loading_torque * means.speed[1], 1e-3 * means.input);
    EXPECT_GT(means.lost, means.drag[0] + means.drag[1]);
    EXPECT_NEAR(means.overall, 1.0 - means.lost / means.input, 1e-9);
    EXPECT_LT(means.overall, means.efficiency - 0.02);
}

TEST(ShaftDragChannels, AreRecordedInScenesWithDragAlone) {
    const auto has = [&](bool drag) {
        model::Parameters machine;
        machine.drag.driven.seals = drag ? 0.1 : 0.0;
        return std::ranges::any_of(chosen_channels({}, machine),
                                   [](const Channel* channel) { return channel->name == "overall_efficiency"; });
    };
    EXPECT_TRUE(has(true));
    EXPECT_FALSE(has(false));
}

}  // namespace
}  // namespace cvtflow::tasks
