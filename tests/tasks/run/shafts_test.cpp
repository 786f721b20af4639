/// Loads of the shafts in a run; each continues bit for bit. Coupled to far ends: their energy. With drag: where its energy comes from and
/// what the efficiency makes of it. A vehicle behind shaft 2 coasts down as the closed form has it; in a cycle shafts give what it needs.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tasks/channel/channels.hpp"
#include "tasks/run/run.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::tasks {
namespace {

/// Both shafts through couplings; the far end of shaft 2 slows down from 1 ms on.
Scene coupled_scene(const std::vector<std::string>& more = {}) {
    return scene_of("tiny", "",
                    {"start.settling_time=1 ms", "start.ramp_time=0.5 ms", "run.step=50 ns", "drive.mode=coupling",
                     "drive.coupling_stiffness=300 N*m/rad", "load.mode=coupling", "load.coupling_stiffness=200 N*m/rad",
                     "load.coupling_damping=0.5 N*m*s/rad", "load.speed=[[0, 209], [0.1e-3, 209], [0.4e-3, 200]]"},
                    more);
}

/// To rounding of sums over 20,000 steps. Rigid pins count each step's works themselves, at mean velocities: the identity holds to the
/// second order of their long steps.
TEST(SimulationCouplings, TheirEnergyBalanceCloses) {
    for (const bool rigid : {false, true}) {
        SCOPED_TRACE(rigid ? "rigid" : "halves");
        Simulation simulation(rigid ? coupled_scene({"detail.pins=rigid", "run.method=auto", "run.step=1 us"}) : coupled_scene());
        const auto stored = [&](int shaft) {
            return simulation.workspace().variator.pulleys().torques().coupling(simulation.time(), pulleys_of(simulation), shaft).energy;
        };
        settle_and_go(simulation, 0.0);
        const double before[2] = {stored(0), stored(1)};
        settle_and_go(simulation, 1e-3);
        const EnergyLedger& energy = simulation.workspace().energy;
        const EnergySums sums = energy.sums(simulation.time());
        for (std::size_t k = 0; k < 2; ++k) {
            const double far = energy.input_works().couplings.work[k], lost = energy.input_works().couplings.dissipated[k];
            EXPECT_GT(std::abs(far), 0.01) << k;
            EXPECT_GT(lost, 0.0) << k;
            EXPECT_NEAR(far, sums.work[k] + (stored(static_cast<int>(k)) - before[k]) + lost, (rigid ? 1e-4 : 1e-9) * std::abs(far)) << k;
        }
        EXPECT_LE(energy.balance_error_ratio(), 1.0);
    }
}

TEST(SimulationCouplings, AFarEndThatSlowsDownBrakesTheShaft) {
    Simulation simulation(coupled_scene());
    settle_and_go(simulation, 0.0);
    const model::PulleyModel& pulleys = simulation.workspace().variator.pulleys();
    const auto torque = [&] { return pulleys.inputs().at(simulation.time(), pulleys_of(simulation)).load_torque; };
    const double before = torque();
    EXPECT_LT(before, 0.0);
    settle_and_go(simulation, 4e-4);
    EXPECT_LT(torque(), before - 1.0);  // damper: 0.5 N·m·s/rad times 9 rad/s; the spring twists on
}

TEST(SimulationCouplings, ContinueBitForBitFromAnIntegrationState) {
    EXPECT_TRUE(expect_continued(coupled_scene(), 2e-4, 5e-4).held.coupled);
}

TEST(SimulationCouplings, AreReleasedWhereAStateBeforeThemIsPutBack) {
    const Scene scene = coupled_scene();
    Simulation simulation(scene), fresh(scene);
    ASSERT_EQ(go(simulation, {.until = 0.0, .steps = 100}).kind, FaultKind::max_steps);
    const IntegrationState settling = simulation.integration_state();
    settle_and_go(simulation, 1e-4);
    simulation.restore(settling);
    settle_and_go(simulation, 1e-4);
    settle_and_go(fresh, 1e-4);
    EXPECT_EQ(simulation.hash(), fresh.hash());
}

constexpr double driving_torque = 14.0, loading_torque = 11.0;  // [N·m]

/// Scene `tiny` between two constant torques, its shafts with seals, bearings and oil.
Scene dragged_scene(const std::string& detail, const std::vector<std::string>& more = {}) {
    return scene_of("tiny", detail,
                    {"start.settling_time=2 ms", "start.ramp_time=1 ms", "drive.mode=torque", "drive.torque=14 N*m", "load.torque=11 N*m",
                     "drag.driving_seals=0.3 N*m", "drag.driving_viscous=2e-3 N*m*s/rad", "drag.driven_seals=0.2 N*m",
                     "drag.driven_churning=1e-5 N*m*s^2/rad^2", "drag.bearing_friction=0.0015",
                     detail == "rigid" ? "run.step=0.2 us" : "run.step=0.05 us"},
                    more);
}

double shaft_angle(const Simulation& simulation, int shaft) {
    return pulleys_of(simulation)[simulation.workspace().variator.pulleys().coordinates().rotation(shaft)];
}

class ShaftDrag : public testing::TestWithParam<std::string> {};

/// Constant external torques do the work T Δφ, of which drag takes its part and the variator receives the rest.
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
    EXPECT_NEAR(after.outside_since(before).efficiency(), 1.0 - lost / (brought + clamping), 1e-5);
    EXPECT_LT(after.outside_since(before).efficiency(), after.since(before).efficiency() - 0.02);
}

/// Impulses of drive and load are external; the variator receives the rest after drag.
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

TEST_P(ShaftDrag, ContinuesBitForBitFromAnIntegrationState) { expect_continued(dragged_scene(GetParam()), 3e-4, 6e-4); }

INSTANTIATE_TEST_SUITE_P(Levels, ShaftDrag, testing::Values("rigid", "fine"), [](const auto& instance) { return instance.param; });

/// Powers of the summary are from outside to outside: the drive's torque times its speed comes in.
TEST(ShaftDragSummary, CountsDragAmongTheLosses) {
    const SpanMeans means = run_scene(dragged_scene("rigid", {"run.until=3 ms", "run.output_interval=10 us"}), {}).whole;
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

Scene ece15(const std::vector<std::string>& settings = {}) {
    Scene scene = read_scene(scene_file("ece15"));
    set_values(scene, settings);
    return scene;
}

double turning(const Simulation& simulation, int shaft) {
    return simulation.workspace().variator.pulleys().coordinates().shaft_speed(pulleys_of(simulation), shaft);
}

/// m dv/dt = -(F_0 + c v²): v = sqrt(F_0/c) tan(atan(v_0 sqrt(c/F_0)) - t sqrt(F_0 c)/m). A light vehicle with large drag, so that
/// milliseconds slow it by 6 %. m has the inertia of both pulleys and of the chain (1.5 kg) as well. The tolerance covers the losses of the
/// chain, some thousandths of the road load (measured: 0.07 %).
TEST(SimulationVehicle, CoastsDownAsTheClosedFormHasIt) {
    Scene scene = ece15({"cycle.speed=0", "control.enabled=false", "clamping.safety=0", "clamping.driving=27.1 kN", "clamping.driven=20 kN",
                         "start.ratio=1", "drive.mode=torque", "drive.torque=0", "vehicle.mass=40 kg", "vehicle.wheel_inertia=0",
                         "vehicle.drag_area=10 m^2", "vehicle.rolling_resistance=1"});
    const model::Parameters& p = scene.parameters;
    Simulation simulation(scene);
    settle_and_go(simulation, 2e-3);
    const double lever = scene.vehicle.lever(), v0 = turning(simulation, 1) * lever, ratio = turning(simulation, 0) * lever / v0;
    const double polar = p.pulley.shaft_polar_inertia + 2.0 * p.pulley.sheave_polar_inertia;
    const Workspace& w = simulation.workspace();
    const double link = 2.0 * p.half.mass + p.plate.count * p.plate.mass,
                 radius = w.variator.pulleys().coordinates().running_radius(pulleys_of(simulation), 1);
    const double chain = p.chain.pins * link * radius * radius;
    const double mass = scene.vehicle.mass + (polar + ratio * ratio * polar + chain) / (lever * lever);
    const double constant = 40.0 * 9.81, drag = 0.5 * 1.2 * 10.0, lasted = 40e-3;
    settle_and_go(simulation, 2e-3 + lasted);
    const double expected =
        std::sqrt(constant / drag) * std::tan(std::atan(v0 * std::sqrt(drag / constant)) - lasted * std::sqrt(constant * drag) / mass);
    const double v1 = turning(simulation, 1) * lever;
    EXPECT_GT(v0 - expected, 0.05 * v0);
    EXPECT_NEAR(v0 - v1, v0 - expected, 0.005 * (v0 - expected));
}

/// While 1500 kg accelerate from 15 to 35 km/h: the work of shaft 2 is what the cycle needs, but for the error of the ratio (measured: 0.44
/// %).
TEST(SimulationVehicle, ShaftTwoGivesWhatTheCycleNeeds) {
    Simulation simulation(ece15({"cycle.begin=128 s"}));
    settle_and_go(simulation, 0.1);
    const auto load = static_cast<std::size_t>(model::Work::load);
    const double work = simulation.workspace().energy.sums(0.1).work[load], needed = simulation.workspace().trip.sums(0.1)[2];
    settle_and_go(simulation, 0.4);
    const double given = work - simulation.workspace().energy.sums(0.4).work[load];
    const double target = simulation.workspace().trip.sums(0.4)[static_cast<std::size_t>(model::TripAccount::shaft)] - needed;
    EXPECT_GT(target, 1500.0);
    EXPECT_NEAR(given, target, 0.01 * target);
    EXPECT_NEAR(turning(simulation, 1) * 0.3 / 5.5, simulation.workspace().trip.speed(0.4), 0.01 * simulation.workspace().trip.speed(0.4));
}

TEST(SceneVehicle, OfARecordReadsBackEqual) {
    const Scene scene = ece15();
    const Scene again = parse_scene(write_scene(scene), "again.toml", StartState::recorded);
    EXPECT_EQ(again.parameters, scene.parameters);
    EXPECT_EQ(again.cycle, scene.cycle);
    EXPECT_EQ(again.vehicle, scene.vehicle);
}

TEST(SceneVehicle, KeysThatFollowChangeWithItAndGoWithIt) {
    Scene scene = ece15({"vehicle.mass=3000 kg"});
    const double heavy = scene.parameters.load.torque.largest_magnitude();
    set_value(scene, "vehicle.mass=1500 kg");
    EXPECT_LT(scene.parameters.load.torque.largest_magnitude(), 0.6 * heavy);
    set_value(scene, "cycle.speed=0");
    EXPECT_EQ(scene.parameters.drive.speed, model::Drive{}.speed) << "no cycle, no table";
    EXPECT_NEAR(scene.parameters.load.inertia, (1500.0 + 4.0 / 0.09) * 0.09 / 30.25, 1e-9);
    set_value(scene, "vehicle.mass=0");
    EXPECT_EQ(scene.parameters.load, model::Load{});
}

TEST(SceneVehicle, RefusesOtherValuesOfKeysThatFollow) {
    const Scene scene = ece15();
    const auto refused = [&](const std::string& setting) { return message_of_settings(scene, {setting}); };
    EXPECT_EQ(refused("load.torque=10"), "--set load.torque=10: load.torque: follows from [vehicle] and [cycle]; remove it");
    EXPECT_EQ(refused("start.ratio=1"), "--set start.ratio=1: start.ratio: follows from [vehicle] and [cycle]; remove it");
    EXPECT_EQ(refused("start.ratio=" + value_text(*find_parameter("start.ratio"), scene)), "") << "its present value";
    EXPECT_EQ(refused("load.inertia=0.1"), "") << "a cycle does not set it";
}

}  // namespace
}  // namespace cvtflow::tasks
