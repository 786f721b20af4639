/// Claims about friction between tips and sheaves. Slip by friction grows with the torque from zero, and what creep loses is never
/// negative, at every ratio (EQUATIONS section 9). How friction is shared by the two sheaves of a pulley (docs/friction_wear.md). Laws of
/// tips: a constant table changes nothing, torque and sliding speed are those of the law, and energy balances where friction falls.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "model/law/friction.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tests/claims/operating_point_fixture.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::claims {
namespace {

using tasks::Scene;

/// A ratio, and the thrust ratio S_1/S_2 that holds it at three quarters of the load; control trims it.
struct Point {
    double ratio, thrust, driven_radius;  ///< [1], [1], [m]
};

/// Share of the torque at which the driven pulley slides in theory, 2 mu S_2 r_2/cos(beta).
[[nodiscard]] Operation run_at(const Point& point, double share, const std::string& settling) {
    const double clamping = 20e3, limit = 0.1834 * clamping * point.driven_radius;
    const auto set = [](const std::string& key, double value) { return key + "=" + std::to_string(value); };
    return Operation(
        scene_at_level("control", "fine",
                       {"start.settling_time=" + settling, "run.until=10 ms", "run.output_interval=20 us", set("start.ratio", point.ratio),
                        set("control.ratio", 1.002 * point.ratio), set("clamping.driven", clamping),
                        set("clamping.driving", point.thrust * clamping), set("load.torque", share * limit)}));
}

constexpr double no_slip = 5e-5;  // what friction transmits without load is the losses; the largest measured is 2.5e-5, at ratio 0.45

void expect_growth(const Point& point, const std::vector<double>& shares, const std::string& settling) {
    double before = -no_slip;
    for (const double share : shares) {
        const Operation run = run_at(point, share, settling);
        ASSERT_FALSE(run.fault) << run.fault.message();
        const double slip = run.mean(run.friction_slip);
        EXPECT_GT(slip, before) << point.ratio << " at " << share;
        EXPECT_LT(std::abs(slip), share == 0.0 ? no_slip : 1.0) << point.ratio;
        EXPECT_GE(*std::min_element(run.creep_power.begin(), run.creep_power.end()), 0.0) << point.ratio << " at " << share;
        EXPECT_GT(run.mean(run.creep_power), slip * run.mean(run.drive_power)) << "creep loses what slip takes, and more";
        before = slip;
    }
}

TEST(FrictionSlip, GrowsWithTheTorqueFromZero) { expect_growth({1.0, 1.355, 54.44e-3}, {0.0, 0.3}, "20 ms"); }

TEST(NightlyFrictionSlip, GrowsWithTheTorqueFromZeroAtEveryRatio) {
    for (const Point& point :
         {Point{0.45, 1.697, 32.6e-3}, {0.7, 1.507, 44.2e-3}, {1.0, 1.355, 54.44e-3}, {1.5, 1.274, 64.6e-3}, {2.3, 1.189, 73.7e-3}})
        expect_growth(point, {0.0, 0.05, 0.15, 0.3, 0.6, 0.9}, "60 ms");
}

/// Mean friction of the tips on sheaves 1-, 1+, 2-, 2+, over 30 ms after settling [W].
std::array<double, 4> sheave_friction(const tasks::Scene& scene) {
    tasks::Simulation simulation(scene);
    model::Observer observer(simulation.workspace().variator);
    std::array<double, 4> mean{};
    double outputs = 0.0;
    tasks::Outputs summed([&](double time, const tasks::Workspace& workspace, const tasks::Counters&) {
        (void)workspace.observed_by(observer, time);
        const model::ChainModel& chain = workspace.variator.chain();
        const auto& power = observer.forces().chain.tip_power;
        for (std::size_t tip = 0; tip < power.size(); ++tip) {
            const int link = static_cast<int>(tip) / model::tips_per_link;
            const int shaft = chain.shaft_of(workspace.state() + chain.layout().link_begin(link));
            mean[2 * static_cast<std::size_t>(shaft) + tip % 2] += power[tip];
        }
        ++outputs;
    });
    settle_and_go(simulation, scene.run.until, summed);
    EXPECT_GT(outputs, 1000.0);
    for (double& power : mean) power /= outputs;
    return mean;
}

std::array<double, 4> friction_with(const std::string& misalignment) {
    return sheave_friction(scene_at_level("baseline", "rigid",
                                          {"load.torque=120", "start.settling_time=40 ms", "run.until=30 ms", "run.output_interval=20 us",
                                           "imperfection.misalignment=" + misalignment}));
}

/// Clamping moves the grooves of a perfect machine apart by 68 um, and a chain that runs askew rubs more on one side of each pulley. A
/// misalignment that brings the grooves back in line makes both sides alike, and twice that mirrors them.
TEST(SheaveFriction, IsSharedEvenlyWhereTheGroovesAreInLine) {
    const auto perfect = friction_with("0"), in_line = friction_with("-0.068 mm"), mirrored = friction_with("-0.136 mm");
    for (const std::size_t k : {0u, 2u}) {
        EXPECT_NEAR(in_line[k], in_line[k + 1], 0.03 * in_line[k]) << "pulley " << k / 2 + 1;
        EXPECT_NEAR(perfect[k], mirrored[k + 1], 0.06 * perfect[k]) << "pulley " << k / 2 + 1;
        EXPECT_NEAR(perfect[k + 1], mirrored[k], 0.06 * perfect[k]) << "pulley " << k / 2 + 1;
    }
    EXPECT_GT(perfect[1], 1.3 * perfect[0]);
    EXPECT_GT(perfect[2], 1.2 * perfect[3]);
}

[[nodiscard]] std::uint64_t hash_of(const std::string& level, const std::string& method, const std::vector<std::string>& law) {
    std::vector<std::string> settings{"start.state=", "start.settling_time=0.2 ms", "start.ramp_time=0.1 ms", "run.until=0.1 ms",
                                      "run.step=0.5 us"};
    settings.insert(settings.end(), law.begin(), law.end());
    Scene scene = scene_at_level("tiny", level, settings);
    scene.run.method = method;
    return hash_at(scene, scene.run.until);
}

TEST(TipLaw, AConstantTableHasTheBitsOfTheConstantLaw) {
    const std::vector<std::string> table{"tip.friction_law=table", "tip.friction_table=[[0, 0.09], [0.05, 0.09], [1, 0.09]]"};
    for (const auto& [level, method] : {std::pair{"rigid", "auto"}, {"fine", "auto"}, {"fine", "dumka3-p5"}})
        EXPECT_EQ(hash_of(level, method, table), hash_of(level, method, {})) << level << " " << method;
    EXPECT_NE(hash_of("fine", "auto", {"tip.friction_law=table", "tip.friction_table=[[0, 0.09], [0.05, 0.05]]"}),
              hash_of("fine", "auto", {}));
}

TEST(TipLaw, AScaleIsAFactorOnEveryLaw) {
    const std::vector<std::string> table{"tip.friction_law=table", "tip.friction_table=[[0, 0.08], [0.05, 0.04]]",
                                         "tip.friction_scale=1.25"};
    const std::vector<std::string> scaled{"tip.friction_law=table", "tip.friction_table=[[0, 0.1], [0.05, 0.05]]"};
    for (const char* level : {"rigid", "fine"}) {
        EXPECT_EQ(hash_of(level, "auto", table), hash_of(level, "auto", scaled)) << level;
        EXPECT_EQ(hash_of(level, "auto", {"tip.friction_coefficient=0.08", "tip.friction_scale=1.25"}),
                  hash_of(level, "auto", {"tip.friction_coefficient=0.1"}))
            << level;
    }
    model::Parameters p;
    p.tip.friction_law = model::TipFriction::lubricated;
    const double mu = 2.0 * p.tip.friction.coefficient * model::tip_law(p, 353.15)->by_speed.at(0.5);
    p.tip.friction_scale = 2.0;
    EXPECT_EQ(p.tip.largest_friction() * model::tip_law(p, 353.15)->by_speed.at(0.5), mu);
    const tasks::Scene scene = scene_at_level("tiny", "rigid", {"tip.friction_scale=1.25", "clamping.safety=1.5", "clamping.driven=1 kN"});
    const tasks::Scene plain = scene_at_level("tiny", "rigid", {"clamping.safety=1.5", "clamping.driven=1 kN"});
    EXPECT_DOUBLE_EQ(1.25 * tasks::driven_clamping_at_start(scene.parameters), tasks::driven_clamping_at_start(plain.parameters));
}

/// Friction that rises with the speed has a steady sliding speed: where 2 μ(v) S_2 r_2/cos β is the load's torque. The driven side alone
/// slides, with the smaller clamping force. 4 %: the flank's share of friction, and the creep of the driving side.
TEST(TipLaw, TheChainSlidesAsFastAsRisingFrictionCarriesTheLoad) {
    const Scene scene = scene_at_level(
        "baseline", "rigid",
        {"tip.friction_law=table", "tip.friction_table=[[0.02, 0.06], [1, 0.09]]", "run.until=40 ms", "run.output_interval=50 us"});
    const Operation run(scene);
    ASSERT_FALSE(run.fault) << run.fault.message();
    EXPECT_LE(run.balance_error_ratio, 1.0);
    const double radius = run.mean(run.radius, 30e-3, 40e-3), slip = run.mean(run.slip, 30e-3, 40e-3);
    const double speed = slip * 209.44 * radius;
    const model::Parameters& p = scene.parameters;
    const double mu = 0.09 * model::tip_law(p, 0.0)->by_speed.at(speed);
    RecordProperty("sliding_speed", std::to_string(speed));
    EXPECT_GT(speed, 0.1) << "it slides";
    EXPECT_NEAR(2.0 * mu * 20e3 * radius / std::cos(p.tip.angle), 150.0, 0.04 * 150.0);
}

/// Beyond the maximum of falling friction the chain lets go. That is no error: the run ends as such, and its energy balances.
TEST(TipLaw, EnergyBalancesWhereFrictionFallsAndTheChainLetsGo) {
    for (const char* level : {"rigid", "fine"}) {
        const Operation run(scene_at_level("baseline", level,
                                           {"tip.friction_law=table", "tip.friction_table=[[0.05, 0.09], [0.6, 0.07]]", "load.torque=205",
                                            "run.until=5 ms", "start.settling_time=10 ms"}));
        ASSERT_FALSE(run.fault) << level << ": " << run.fault.message();
        EXPECT_LE(run.balance_error_ratio, 1.0) << level;
        EXPECT_GT(run.mean(run.slip, 3e-3, 5e-3), 0.01) << level;
    }
}

/// Tension of the tight strand after 100 us at 1 us with saturation speeds a tenth, a hundredth and a thousandth of the usual ones. A speed
/// a hundred times smaller makes RK4 need steps a hundred times shorter; here stages grow tenfold and results tend to a limit.
TEST(FrictionSlip, TendsToALimitAsTheSaturationSpeedVanishes) {
    const auto end = [&](const std::string& scale) {
        const double factor = std::stod(scale);
        const auto text = [&](double value) { return std::to_string(value * factor * 1e9) + "e-9"; };
        const tasks::Scene scene = ready_scene(
            "baseline", {"run.schedule=serial", "run.method=leapfrog-sweep", "run.step=1us", "joint.saturation_speed=" + text(5e-3),
                         "plate.saturation_speed=" + text(1e-2), "tip.saturation_speed=" + text(1e-2)});
        tasks::Simulation simulation(scene);
        settle_and_go(simulation, 100e-6);
        model::Observer observer(simulation.workspace().variator);
        return simulation.workspace().observed_by(observer, simulation.time()).tight;
    };
    const double tenth = end("0.1"), hundredth = end("0.01"), thousandth = end("0.001");
    EXPECT_NEAR(thousandth / hundredth, 1.0, 2e-3);
    EXPECT_LT(std::abs(thousandth - hundredth), std::abs(hundredth - tenth) + 1e-3 * hundredth);
}

}  // namespace
}  // namespace cvtflow::claims
