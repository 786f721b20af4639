/// Checks of scenes. broken_scenes.txt contains scenes with something wrong, each behind the lines `=== message` that it must give, exactly
/// these (`=+= message` where the schema sees it as well). Keys that are reported as without effect have none, and those that act are not
/// reported.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/scene.hpp"
#include "tests/sample_fixture.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::StartsWith;

struct Broken {
    std::string text, expected;
};

std::vector<Broken> broken_scenes() {
    std::ifstream file(CVTFLOW_SOURCE_DIR "/tests/tasks/scene/broken_scenes.txt");
    std::vector<Broken> scenes;
    bool in_text = true;
    for (std::string line; std::getline(file, line);) {
        const bool message = line.starts_with("=== ") || line.starts_with("=+= ");
        if (message && in_text) scenes.emplace_back();
        in_text = !message;
        if (message) scenes.back().expected += (scenes.back().expected.empty() ? "" : "\n") + line.substr(4);
        if (in_text) scenes.back().text += line + "\n";
    }
    return scenes;
}

TEST(BrokenScenes, GiveExactlyTheMessagesThatTheyExpect) {
    EXPECT_GE(broken_scenes().size(), 120U);
    for (const Broken& broken : broken_scenes())
        EXPECT_EQ(message_of([&] { return parse_scene(broken.text, "scene.toml"); }), broken.expected) << broken.text;
}

TEST(CrossChecks, DefaultsPassAll) {
    for (const CrossCheck& check : cross_checks()) EXPECT_EQ(check.violation(Scene{}), std::nullopt);
}

TEST(CrossChecks, KeysExist) {
    for (const CrossCheck& check : cross_checks()) {
        EXPECT_FALSE(check.keys.empty());
        for (const auto key : check.keys) EXPECT_NE(find_parameter(key), nullptr) << key;
    }
}

TEST(CrossChecks, AStateToStartFromNeedsNoGeometricStart) {
    Scene scene;
    scene.parameters.start.ratio = 10.0;
    const auto violated = [&] {
        return std::ranges::any_of(cross_checks(), [&](const CrossCheck& check) { return check.violation(scene).has_value(); });
    };
    EXPECT_TRUE(violated());
    scene.state_file = "/some/state.h5";
    EXPECT_FALSE(violated());
}

TEST(CrossChecks, WithoutSettlingTheRampDoesNotMatter) {
    Scene scene;
    scene.parameters.start.settling_time = 0.0;
    for (const CrossCheck& check : cross_checks()) EXPECT_EQ(check.violation(scene), std::nullopt);
}

struct IdleKey {
    const char* setting;                  ///< setting without effect by itself
    std::vector<std::string> enabled_by;  ///< settings with which it acts
};

const IdleKey idle[] = {
    {"oil.temperature=40 degC", {"tip.friction_law=lubricated"}},
    {"oil.viscosity_40=0.05 Pa*s", {"tip.friction_law=lubricated"}},
    {"oil.viscosity_100=0.009 Pa*s", {"tip.friction_law=lubricated"}},
    {"oil.pressure_viscosity=1e-8 1/Pa", {"tip.friction_law=lubricated"}},
    {"tip.limiting_traction=0.04", {"tip.friction_law=lubricated"}},
    {"tip.roughness=1 um", {"tip.friction_law=lubricated"}},
    {"tip.reference_pressure=2 GPa", {"tip.pressure_sensitivity=0.1"}},
    {"detail.smoothing=0.2", {"detail.friction=smoothed", "run.method=rk4"}},
    {"heat.pulley_capacity=5e-3 J/K", {"heat.enabled=true", "tip.friction_law=lubricated"}},
    {"hydraulics.valve_lag=2 ms", {"hydraulics.mode=pressure"}},
    {"guide.clearance=0.5 mm", {"guide.stiffness=1e6 N/m"}},
    {"vehicle.final_drive=4", {"vehicle.mass=1000 kg"}},
    {"drive.torque=20 N*m", {"drive.mode=torque"}},
    {"drive.coupling_stiffness=100 N*m/rad", {"drive.mode=coupling"}},
    {"load.speed=100 rad/s", {"load.mode=speed"}},
    {"load.governor_frequency=5 Hz", {"load.mode=speed", "load.speed=90 rad/s"}},
    {"load.coupling_damping=5 N*m*s/rad", {"load.mode=coupling", "load.speed=90 rad/s"}},
    {"drag.bearing_diameter=50 mm", {"drag.bearing_friction=0.01"}},
    {"imperfection.sheave=2+", {"imperfection.runout=50 um"}},
    {"imperfection.pin_length_seed=5", {"imperfection.pin_length_spread=10 um"}},
    {"control.ratio=1.1", {"control.enabled=true"}},
};

/// Hash of a short run that settles first.
std::uint64_t hash_with(const std::vector<std::string>& settings) {
    return hash_at(scene_of("tiny", "", {"start.settling_time=0.2 ms", "start.ramp_time=0.2 ms", "run.step=50 ns"}, settings), 1e-4);
}

TEST(IdleKeys, HaveNoEffectAndActOnceTheyAreNotReported) {
    const std::uint64_t plain = hash_with({});
    int number = 0;
    for (const auto& [setting, enabled_by] : idle) {
        Scene scene = ready_tiny();
        set_value(scene, setting);
        const std::string key = std::string(setting).substr(0, std::string(setting).find('='));
        EXPECT_THAT(idle_keys(scene), ElementsAre(StartsWith(key + ": no effect, since "))) << setting;
        set_values(scene, enabled_by);
        EXPECT_THAT(idle_keys(scene), IsEmpty()) << setting;
        if (!cvtflow::test::is_deep() && number++ % 3 != 0) continue;
        std::vector<std::string> both = enabled_by;
        both.emplace_back(setting);
        EXPECT_EQ(hash_with({setting}), plain) << setting;
        EXPECT_NE(hash_with(both), key == "load.speed" ? plain : hash_with(enabled_by)) << setting;
    }
}

/// States are recorded at outputs: longer outputs take one setting.
TEST(IdleKeys, ContainAnIntervalOfStatesThatThatOfOutputsExceeds) {
    Scene usual, tiny = ready_tiny();
    for (Scene* scene : {&usual, &tiny}) set_value(*scene, "run.output_interval=1 ms");
    EXPECT_THAT(idle_keys(usual), IsEmpty()) << "the default was not asked for";
    EXPECT_THAT(idle_keys(tiny),
                ElementsAre("run.state_interval: no effect, since run.output_interval is longer: states are recorded at outputs"));
}

TEST(IdleKeys, OfOneReasonAreOneLine) {
    Scene scene;
    set_values(scene, std::vector<std::string>{"heat.ambient=300 K", "heat.oil_capacity=500 J/K"});
    EXPECT_THAT(idle_keys(scene), ElementsAre("heat.ambient, heat.oil_capacity: no effect, since heat.enabled is false"));
}

TEST(IdleKeys, AreInNoReadyScene) {
    for (const auto& file : std::filesystem::directory_iterator(std::string(CVTFLOW_SOURCE_DIR) + "/scenes")) {
        if (file.path().extension() != ".toml") continue;
        EXPECT_THAT(idle_keys(read_scene(file.path())), IsEmpty()) << file.path();
    }
}

}  // namespace
}  // namespace cvtflow::tasks
