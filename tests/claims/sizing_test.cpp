/// Clamping forces and pressures of `cvtflow check` beside those of runs: claims of docs/own_machine.md; and the scene vl300, a machine
/// that exists.

#include "tasks/sizing/sizing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "model/machine/belt.hpp"
#include "model/start/start_state.hpp"
#include "tasks/run/run.hpp"
#include "tests/claims/operating_point_fixture.hpp"
#include "tests/sample_fixture.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::claims {
namespace {

using testing::HasSubstr;

/// Means of forces and pressures over the last part of a run.
class Pressed {
public:
    Pressed(const tasks::Scene& scene, double from) {
        tasks::Simulation simulation(scene);
        double count = 0.0;
        tasks::Outputs summed([&](double time, const tasks::Workspace& workspace, const tasks::Counters&) {
            if (time < from) return;
            const double* tail = workspace.state() + workspace.layout().pulley_begin();
            const model::HydraulicInstant now = workspace.variator.pulleys().inputs().hydraulics(time, tail);
            for (std::size_t k = 0; k < 2; ++k) {
                force_[k] += now.force[k];
                pressure_[k] += now.pressure[k];
            }
            count += 1.0;
        });
        settle_and_go(simulation, scene.run.until, summed);
        for (auto* sums : {&force_, &pressure_}) std::ranges::for_each(*sums, [&](double& sum) { sum /= count; });
    }
    [[nodiscard]] double force(std::size_t shaft) const { return force_[shaft]; }        ///< [N]
    [[nodiscard]] double pressure(std::size_t shaft) const { return pressure_[shaft]; }  ///< [Pa]

private:
    std::array<double, 2> force_{}, pressure_{};
};

struct OperatingPoint {
    double ratio, speed, force, safety;  ///< [1], [rpm], about S_2 [N], [1]
};

[[nodiscard]] tasks::Scene clamped_scene(const OperatingPoint& at) {
    const model::Parameters p;
    const auto radii = model::belt_radii(model::chain_length(p.chain), at.ratio, p.pulley.centre_distance);
    const double load = 2.0 * p.tip.friction.coefficient * at.force * radii->driven / std::cos(p.tip.angle) / at.safety;
    const double driving = at.force * 1.36 * std::pow(at.ratio, -0.3);
    const auto set = [](const char* key, double value) { return std::string(key) + "=" + std::to_string(value); };
    return scene_at_level(
        "baseline", "rigid",
        {set("drive.speed", at.speed * std::numbers::pi / 30.0), set("load.torque", load), set("clamping.safety", at.safety),
         "clamping.driven=1 kN", set("clamping.driving", driving), "control.enabled=true", set("control.ratio", at.ratio),
         "control.gains=found", "control.authority=30 kN", set("start.ratio", at.ratio), "hydraulics.mode=force",
         "hydraulics.relief_pressure=100 bar", "run.output_interval=0.2 ms", "run.until=0.3 s"});
}

/// S_2 and its pressure follow from the load and a radius, S_1 from the theory of a belt.
TEST(Sizing, StatesForcesAndPressuresOfRunsAtTwentyPoints) {
    std::vector<OperatingPoint> points;
    for (const double ratio : {0.45, 0.7, 1.0, 1.5, 2.2})
        for (const auto& [speed, force, safety] :
             {std::array{1000.0, 12e3, 1.3}, {1000.0, 40e3, 1.8}, {3000.0, 12e3, 1.8}, {3000.0, 40e3, 1.3}})
            points.push_back({ratio, speed, force, safety});
    ASSERT_EQ(points.size(), 20U);
    for (const std::size_t k :
         test::depth<std::vector<std::size_t>>({3, 8, 17}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19})) {
        const tasks::Scene scene = clamped_scene(points[k]);
        tasks::Sizing sizing = size_scene(scene);
        ASSERT_EQ(sizing.points.size(), 1U) << sizing.objection;
        tasks::SizedPoint& at = sizing.points.front();
        size_driving(scene, at);
        ASSERT_EQ(at.objection, "") << k;
        const Pressed run(scene, 0.18);
        EXPECT_EQ(at.decided, "clamping.safety");
        EXPECT_NEAR(at.clamping[1], run.force(1), 0.01 * run.force(1)) << "point " << k;
        EXPECT_NEAR(at.pressure[1], run.pressure(1), 0.01 * run.force(1) / scene.parameters.hydraulics.driven.area) << "point " << k;
        EXPECT_NEAR(at.clamping[0], run.force(0), 0.13 * run.force(0)) << "point " << k;
        EXPECT_NEAR(at.pressure[0], run.pressure(0), 0.13 * run.force(0) / scene.parameters.hydraulics.driving.area) << "point " << k;
        RecordProperty("S_2 of point " + std::to_string(k), std::to_string(at.clamping[1] / run.force(1) - 1.0));
        RecordProperty("S_1 of point " + std::to_string(k), std::to_string(at.clamping[0] / run.force(0) - 1.0));
    }
}

/// The table of the load has its peak between points of the grid, the floor acts elsewhere.
TEST(Sizing, NamesTheWorstInstantAndWhatDecidesThere) {
    const tasks::Scene scene =
        ready_scene("baseline", {"load.torque=[[0, 40], [\"1.234 ms\", 190], [\"1.3 ms\", 40]]", "clamping.safety=1.5",
                                 "clamping.driven=[[0, \"9 kN\"], [\"4 ms\", \"9 kN\"], [\"4.1 ms\", \"31 kN\"]]"});
    const tasks::Sizing sizing = size_scene(scene);
    ASSERT_EQ(sizing.points.size(), 2U) << sizing.objection;
    EXPECT_EQ(sizing.points[0].reason, "least safety");
    EXPECT_DOUBLE_EQ(sizing.points[0].time, 1.234e-3);
    EXPECT_EQ(sizing.points[0].decided, "clamping.safety");
    EXPECT_EQ(sizing.points[1].reason, "largest S_2, largest S_1");
    EXPECT_NEAR(sizing.points[1].time, 4.1e-3, 1e-6);
    EXPECT_EQ(sizing.points[1].decided, "clamping.driven");
    EXPECT_DOUBLE_EQ(sizing.points[1].clamping[1], 31e3);
    const tasks::Scene backwards = ready_scene("baseline", {"drive.speed=-2000 rpm", "load.torque=-100", "load.linear=0.1"});
    EXPECT_NEAR(size_scene(backwards).points.front().load, 100.0 + 0.1 * 2000.0 * 0.10472, 0.1) << "both resist; the ratio is 1";
}

TEST(Sizing, StatesWhyForcesAreUnknown) {
    EXPECT_THAT(size_scene(ready_scene("manoeuvre")).objection, HasSubstr("controller of slip"));
    EXPECT_THAT(size_scene(ready_scene("baseline", {"load.mode=speed", "load.speed=2000 rpm"})).objection,
                HasSubstr("follows from the run"));
    const tasks::Scene beyond = ready_scene("control", {"control.ratio=[[0, 1], [\"20 ms\", 4]]"});
    EXPECT_THAT(size_scene(beyond).objection, HasSubstr("off the sheaves (at "));
    const tasks::Scene heavy = ready_scene("baseline", {"load.torque=190"});
    tasks::SizedPoint at = size_scene(heavy).points.front();
    size_driving(heavy, at);
    EXPECT_THAT(at.objection, HasSubstr("safety factor of 1.1 at least"));
    EXPECT_TRUE(std::isnan(at.clamping[0]));
}

/// While the ratio rises by 0.22 1/s, control presses less on the driving side: the difference is the stated one within a third.
TEST(Sizing, AddsWhatAShiftTakes) {
    tasks::Scene scene = scene_at_level(
        "baseline", "rigid",
        {"control.ratio=[[0, 0.9], [\"0.1 s\", 0.9], [\"1.1 s\", 1.1]]", "clamping.driving=24 kN", "load.torque=100", "start.ratio=0.9",
         "control.enabled=true", "control.gains=found", "control.authority=30 kN", "run.output_interval=0.2 ms", "run.until=0.6 s"});
    tasks::Sizing sizing = size_scene(scene);
    auto& at = sizing.points.back();
    ASSERT_THAT(at.reason, HasSubstr("fastest shift"));
    size_driving(scene, at);
    ASSERT_EQ(at.objection, "");
    const Operation run(scene);
    const auto driving = [&](double from, double to) {
        return run.mean(run.thrust_ratio, from, to) * run.mean(run.clamping_driven, from, to);
    };
    const double added = driving(0.35, 0.55) - driving(0.05, 0.1);
    EXPECT_NEAR(at.shifting - at.clamping[0], added, std::abs(added) / 3.0);
    EXPECT_LT(added, -3e3);
}

TEST(Sizing, TurnsATorqueIntoForcesOverTheRatios) {
    const tasks::Scene scene = ready_scene("baseline");
    const auto once = size_for_torque(scene, 110.0, 1.3).points, twice = size_for_torque(scene, 220.0, 1.3).points;
    ASSERT_EQ(once.size(), 5U);
    for (std::size_t k = 0; k < once.size(); ++k) {
        EXPECT_NEAR(twice[k].clamping[1] / once[k].clamping[1], 2.0, 0.03) << "sheaves yield";
        EXPECT_NEAR(once[k].load / once[k].ratio, 110.0, 1e-9);
    }
    for (std::size_t k = 1; k < once.size(); ++k) EXPECT_LT(once[k].clamping[1], once[k - 1].clamping[1]) << "the driving radius grows";
    EXPECT_GT(once.front().ratio, 2.5);
    EXPECT_LT(once.back().ratio, 0.4);
}

/// The farthest of these ratios are those at which a run keeps its chain on the sheaves, with the stated forces.
TEST(Sizing, SizesNoMachineWhoseChainLeavesItsSheaves) {
    for (const auto& [name, torque] : {std::pair{"vl300", 300.0}, {"baseline", 150.0}}) {
        const auto points = size_for_torque(ready_scene(name), torque, 1.3).points;
        for (tasks::SizedPoint at : {points.front(), points.back()}) {
            size_driving(ready_scene(name), at);
            const auto set = [](const char* key, double value) { return std::string(key) + "=" + std::to_string(value); };
            tasks::Scene scene =
                scene_at_level(name, "rigid",
                               {set("start.ratio", at.ratio), set("control.ratio", at.ratio), "control.enabled=true", "control.gains=found",
                                "control.authority=40 kN", set("load.torque", at.load), set("clamping.driving", at.clamping[0]),
                                set("clamping.driven", at.clamping[1]), "start.state=", "run.until=50 ms"});
            const tasks::RunReport report = tasks::run_scene(scene, {});
            EXPECT_FALSE(report.fault) << name << " at " << at.ratio << ": " << report.fault.message();
        }
    }
}

/// A step of the target, two points 1 us apart, is no shift; oil that turns presses at least with its force; a floor holds here as well.
TEST(Sizing, StatesNoForceThatCannotBe) {
    const tasks::Scene stepped = ready_scene("control", {"control.ratio=[[0, 1], [\"10 ms\", 1], [\"10.001 ms\", 1.1]]"});
    for (const tasks::SizedPoint& at : size_scene(stepped).points) EXPECT_EQ(at.shift, 0.0) << at.reason;
    const std::vector<std::string> light{"clamping.safety=1.3", "clamping.driven=0", "load.torque=5", "drive.speed=5000 rpm"};
    std::vector<std::string> oil = light;
    oil.emplace_back("hydraulics.mode=force");
    const tasks::SizedPoint dry = size_scene(ready_scene("baseline", light)).points.front();
    const tasks::SizedPoint wet = size_scene(ready_scene("baseline", oil)).points.front();
    EXPECT_LT(dry.clamping[1], dry.least[1]) << "noted by the program";
    EXPECT_EQ(wet.decided, "rotating oil");
    EXPECT_NEAR(wet.clamping[1], wet.least[1], 1e-3 * wet.least[1]);
    const auto points = size_for_torque(ready_scene("vl300", {"clamping.driven=30 kN"}), 300.0, 1.3).points;
    EXPECT_EQ(points.back().decided, "clamping.driven");
    EXPECT_EQ(points.back().clamping[1], 30e3);
    EXPECT_EQ(points.front().decided, "--safety");
}

TEST(Vl300, HasItsPublishedFigures) {
    const model::Parameters p = ready_scene("vl300").parameters;
    EXPECT_EQ(p.chain.pins, 75);
    EXPECT_NEAR(p.chain.pins * model::link_mass(p), 1.68, 0.005) << "3.7 lb";
    EXPECT_NEAR(1025.0 / p.chain.pins, p.plate.count, 0.5) << "13 or 14 side by side";
    const auto radii = model::belt_radii(model::chain_length(p.chain), 2.4, p.pulley.centre_distance);
    const double wrap = std::numbers::pi - 2.0 * std::asin((radii->driven - radii->driving) / p.pulley.centre_distance);
    EXPECT_NEAR(wrap * radii->driving / p.chain.pitch[0], 9.0, 0.5) << "pairs clamped in the largest reduction";
}

/// 330 N·m on the driving shaft, with a safety factor of 1.3, below 60 bar; with 0.9 the chain slips through.
TEST(Vl300, CarriesItsTorqueAtItsPressure) {
    const std::vector<std::string> heavy{"load.torque=792 N*m", "run.until=0.2 s"};
    const Pressed pressed(ready_scene("vl300", heavy), 0.1);
    for (const std::size_t shaft : {0U, 1U}) {
        EXPECT_LT(pressed.pressure(shaft), 60e5) << shaft;
        EXPECT_GT(pressed.pressure(shaft), 45e5) << shaft;
    }
    const Operation carries(ready_scene("vl300", heavy));
    EXPECT_NEAR(carries.mean(carries.ratio, 0.1, 1.0), 2.4, 0.03);
    EXPECT_LT(carries.mean(carries.slip, 0.1, 1.0), 0.025);
    const Operation slips(ready_scene("vl300", {"load.torque=792 N*m", "run.until=0.2 s", "clamping.safety=0.9"}));
    EXPECT_TRUE(slips.fault || slips.mean(slips.slip, 0.1, 1.0) > 0.2);
}

}  // namespace
}  // namespace cvtflow::claims
