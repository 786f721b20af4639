#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tasks/scene/parameter_table.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

Scene controlled_scene(const std::vector<std::string>& settings = {}) { return scene_of("control", "", settings, {"control.gains=found"}); }

double proportional(const std::vector<std::string>& settings) { return controlled_scene(settings).parameters.control.proportional; }

/// The speed at which the ratio follows its force decides from 2000 rpm on, 60/s: equation of section 8.
TEST(FoundGains, LetTheRatioFollowAsFastAtEverySpeedThatPermitsIt) {
    for (const double rpm : {2000.0, 4000.0, 20000.0}) {
        const double speed = rpm * std::acos(-1.0) / 30.0;
        const model::Control control = controlled_scene({"drive.speed=" + std::to_string(speed)}).parameters.control;
        EXPECT_NEAR(control.proportional * 0.0051 * speed / 20e3, 60.0, 1e-4) << rpm;  // six digits of the speed
        EXPECT_NEAR(control.integral, 2.0 * control.proportional, 1e-9 * control.integral);
    }
}

/// Below, half of the stiffness of the pulleys bounds it, whatever the clamping force, and falls with the speed to zero. A force of 1 N
/// opens a groove by 3.13 nm at the default machine, of which the attachment takes 1, tilt 1.71 and tips 0.42.
TEST(FoundGains, AreBoundedByTheStiffnessOfThePulleys) {
    const double stiffness = 54.4e-3 * std::tan(0.19198621771937624) / 3.13e-9;
    for (const double speed : {1e-3, 1.0, 50.0, 100.0}) {
        const std::string at = "drive.speed=" + std::to_string(speed);
        const double bound = proportional({at});
        EXPECT_NEAR(bound, 0.5 * stiffness * speed / (speed + 100.0), 0.005 * bound) << speed;  // digits of the numbers above
        EXPECT_EQ(proportional({at, "clamping.driven=40 kN"}), bound);
        EXPECT_EQ(proportional({"drive.speed=-" + std::to_string(speed)}), bound);
        EXPECT_LT(proportional({at, "start.ratio=2"}), bound) << "one radius is smaller";
        EXPECT_LT(proportional({at, "pulley.attachment_tilt=7e5 N*m/rad"}), bound);
    }
}

/// An integral part as fast as the ratio then follows, 1/s, would leave 45° of phase: it is four times as slow.
TEST(FoundGains, KeepTheirPhaseMarginWhereTheLoopIsSlow) {
    for (const double speed : {1.0, 20.0, 100.0}) {
        const model::Control control = controlled_scene({"drive.speed=" + std::to_string(speed)}).parameters.control;
        const double rate = control.proportional * 0.0051 * speed / 20e3, time = control.proportional / control.integral;
        EXPECT_GE(rate * time, 4.0 * (1.0 - 1e-12)) << speed;
        EXPECT_NEAR(time, std::max(0.5, 4.0 / rate), 1e-9 * time);
    }
    const double valves = proportional({"hydraulics.mode=force", "hydraulics.valve_lag=10 ms"}), without = proportional({});
    EXPECT_NEAR(valves / without, 25.0 / 60.0, 1e-9) << "the ratio follows four times as slowly as the valves";
}

TEST(FoundGains, AreFoundWhereASceneIsReadAndFollowItsChanges) {
    Scene scene = controlled_scene();
    const double before = scene.parameters.control.proportional;
    EXPECT_GT(before, 1.1e6);
    set_values(scene, std::vector<std::string>{"clamping.driven=10 kN"});
    EXPECT_NEAR(scene.parameters.control.proportional, 0.5 * before, 1e-6 * before);
    const Scene again = parse_scene(write_scene(scene), "again.toml", StartState::recorded);
    EXPECT_EQ(again.gains, ControlGains::found);
    EXPECT_EQ(again.parameters.control, scene.parameters.control);
    set_values(scene, std::vector<std::string>{"control.gains=given"});
    EXPECT_EQ(scene.parameters.control.proportional, model::Control{}.proportional);
}

TEST(FoundGains, AreRefusedBesideGivenOnesAndWithoutAForce) {
    for (const auto& [setting, message] : {
             std::pair{"control.proportional=2 MN", "control.proportional: follows from control.gains = \"found\"; remove one of both"},
             {"control.integral=1 N/s", "control.integral: follows from control.gains = \"found\"; remove one of both"},
             {"clamping.driven=0",
              "control.gains: \"found\" requires a clamping force of shaft 2 at t = 0 (clamping.driven, or clamping.safety and a load)"},
         })
        EXPECT_EQ(message_of_settings(controlled_scene(), {setting}), std::string("--set ") + setting + ": " + message);
    EXPECT_EQ(message_of_settings(controlled_scene(), {"clamping.driven=0", "clamping.safety=1.3"}), "") << "150 N·m require 19.5 kN";
}

/// The default's 20 kN are another machine's. A floor that a scene gives stays, also the default's value; without a load there is no force.
TEST(ClampingSafety, HasAFloorWhereTheSceneGivesOneAlone) {
    const auto least = [](const Scene& scene) {
        const model::Parameters& p = scene.parameters;
        return std::pair{p.clamping.driven.at(0.0), p.hydraulics.driven.pressure.at(0.0)};
    };
    Scene scene = parse_scene("[clamping]\nsafety = 1.3\n[load]\ntorque = 75\n", "own.toml");
    const auto [force, pressure] = least(Scene{});
    EXPECT_EQ(least(scene), std::pair(0.0, pressure));
    EXPECT_NEAR(driven_clamping_at_start(scene.parameters), 9.8e3, 0.1e3);
    EXPECT_EQ(least(parse_scene(write_scene(scene), "again.toml", StartState::recorded)), least(scene));
    set_value(scene, "clamping.safety=0");
    EXPECT_EQ(least(scene), std::pair(force, pressure));
    scene = parse_scene(write_scene(scene), "again.toml");
    set_value(scene, "clamping.safety=1.3");
    EXPECT_EQ(least(scene), std::pair(0.0, pressure)) << "no text makes a floor of a default";
    EXPECT_THAT(message_of_settings(scene, {"load.torque=0"}), testing::HasSubstr("without a load at t = 0 shaft 2 has no clamping force"));
    Scene changed = scene;
    changed.parameters.clamping.driven = model::TimeTable(7e3);
    EXPECT_EQ(least(parse_scene(write_scene(changed), "again.toml")), std::pair(7e3, pressure));
    set_value(scene, "hydraulics.mode=pressure");
    EXPECT_EQ(least(scene), std::pair(force, 0.0));
    set_value(scene, "hydraulics.driven_pressure=3 bar");
    EXPECT_EQ(least(parse_scene(write_scene(scene), "again.toml")), std::pair(force, 3e5));
}

/// A record of another version of the program states the gains that acted.
TEST(FoundGains, OfARecordAreThoseThatActed) {
    const Scene scene = parse_scene("[control]\nenabled = true\ngains = \"found\"\nproportional = 123.0\nintegral = 4.0\n", "old.toml",
                                    StartState::recorded);
    EXPECT_EQ(scene.parameters.control.proportional, 123.0);
    EXPECT_EQ(scene.parameters.control.integral, 4.0);
}

}  // namespace
}  // namespace cvtflow::tasks
