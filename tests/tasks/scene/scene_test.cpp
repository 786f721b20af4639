#include "tasks/scene/scene.hpp"

#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml/units.hpp"

namespace cvtflow::tasks {
namespace {

const std::filesystem::path scenes = std::filesystem::path(CVTFLOW_SOURCE_DIR) / "scenes";

/// The message of the error that `action` throws; empty if it throws none.
template <class Action>
std::string complaint(Action action) {
    try {
        action();
    } catch (const SceneError& error) {
        return error.what();
    }
    return {};
}

TEST(Scene, EmptyTextIsTheDefaultScene) {
    const Scene scene = parse_scene("", "folder/empty.toml");
    EXPECT_EQ(scene.parameters, model::Parameters{});
    EXPECT_EQ(scene.run, RunSettings{});
    EXPECT_EQ(scene.name, "empty");
    EXPECT_EQ(scene.state_file, "");
}

TEST(Scene, KeepsItsTextAndPath) {
    const std::string text = "[scene]\nname = \"mine\" # a comment\n";
    const Scene scene = parse_scene(text, "folder/scene.toml");
    EXPECT_EQ(scene.name, "mine");
    EXPECT_EQ(scene.text, text);
    EXPECT_EQ(scene.path, "folder/scene.toml");
}

TEST(Scene, BaselineIsTheDefaultScene) {
    const Scene scene = read_scene(scenes / "baseline.toml");
    EXPECT_EQ(scene.parameters, model::Parameters{});
    EXPECT_EQ(scene.run, RunSettings{}) << "also with the method that a scene without one takes";
    EXPECT_TRUE(scene.run.step.automatic());
}

TEST(Scene, EveryReadySceneIsGoodNamedAsItsFileAndDescribed) {
    int count = 0;
    for (const auto& file : std::filesystem::directory_iterator(scenes)) {
        if (file.path().extension() != ".toml") continue;
        const Scene scene = read_scene(file.path());
        EXPECT_EQ(scene.name, file.path().stem().string());
        EXPECT_FALSE(scene.description.empty()) << scene.name;
        ++count;
    }
    EXPECT_GE(count, 8);
}

TEST(Scene, EachKeyRoundTrips) {
    const Scene defaults;
    for (const Parameter& parameter : parameter_table()) {
        const auto text = fmt::format("[{}]\n{} = {}", parameter.section(), parameter.name(), value_text(parameter, defaults));
        const Scene scene = parse_scene(text, "scene.toml");
        EXPECT_EQ(value_text(parameter, scene), parameter.key == "scene.name" ? "\"scene\"" : value_text(parameter, defaults)) << text;
        EXPECT_EQ(scene.parameters, defaults.parameters) << text;
        EXPECT_EQ(scene.run, defaults.run) << text;
    }
}

TEST(Scene, FileThatIsNotThereIsAnError) {
    EXPECT_EQ(complaint([] { (void)read_scene("/nowhere/at/all.toml"); }),
              "/nowhere/at/all.toml: cannot be read: No such file or directory");
    EXPECT_EQ(complaint([] { (void)read_scene(scenes); }), scenes.string() + ": cannot be read: a folder, not a file");
}

TEST(Scene, StateIsRelativeToTheSceneFile) {
    const auto folder = std::filesystem::temp_directory_path() / "cvtflow_scene_state";
    std::filesystem::create_directories(folder / "states");
    std::ofstream(folder / "states" / "settled.h5") << "state";
    std::ofstream(folder / "scene.toml") << "[start]\nstate = \"states/settled.h5\"\n";
    EXPECT_EQ(read_scene(folder / "scene.toml").state_file, (folder / "states" / "settled.h5").string());
    std::filesystem::remove_all(folder);
}

TEST(Scene, DamagedTextsGiveSceneErrorsAndNothingElse) {
    const std::string good = write_scene(read_scene(scenes / "control.toml"));
    std::mt19937 random(7);
    int refused = 0;
    for (int trial = 0; trial < 1000; ++trial) {
        std::string text = good;
        for (int damage = 0; damage < 3; ++damage) text[random() % text.size()] = static_cast<char>(random() % 256);
        if (!complaint([&] { (void)parse_scene(text, "scene.toml"); }).empty()) ++refused;
    }
    EXPECT_GT(refused, 500);
}

TEST(SetValue, TakesValuesAsInTomlAndWithoutQuotes) {
    Scene scene;
    set_value(scene, "half.length=40 mm");
    set_value(scene, "chain.damping_ratio=0.05");
    set_value(scene, "detail.plates=lumped");
    set_value(scene, "record.ledger=true");
    set_value(scene, "load.torque=[[0, 0], [\"10 ms\", \"150 N*m\"]]");
    set_value(scene, "run.method=\"rock2\"");
    set_value(scene, "scene.name=84");
    EXPECT_EQ(scene.parameters.half.length, 40e-3);
    EXPECT_EQ(scene.parameters.chain.damping_ratio, 0.05);
    EXPECT_EQ(scene.parameters.detail.plates, model::PlateDetail::lumped);
    EXPECT_TRUE(scene.parameters.ledger);
    EXPECT_EQ(scene.parameters.load.torque, model::TimeTable({0.0, 0.01}, {0.0, 150.0}));
    EXPECT_EQ(scene.run.method, "rock2");
    EXPECT_EQ(scene.name, "84");
}

TEST(SetValue, EveryKeyTakesItsOwnDefault) {
    Scene scene;
    for (const Parameter& parameter : parameter_table())
        set_value(scene, fmt::format("{}={}", parameter.key, value_text(parameter, Scene{})));
    EXPECT_EQ(scene.parameters, model::Parameters{});
    EXPECT_EQ(scene.run, RunSettings{});
}

TEST(SetValue, ErrorsShowTheSetting) {
    Scene scene;
    const auto message = [&](const char* setting) { return complaint([&] { set_value(scene, setting); }); };
    EXPECT_EQ(message("chain.pitch=8.12"),
              "--set chain.pitch=8.12: chain.pitch: 8.12 m is outside [1e-3, 5e-2] m (did you mean \"8.12 mm\"?)");
    EXPECT_EQ(message("chain.pitch=8.12 kg"), "--set chain.pitch=8.12 kg: chain.pitch: 8.12 kg is a mass, expected a length (m)");
    EXPECT_EQ(message("chain.pich=8.12 mm"), "--set chain.pich=8.12 mm: chain.pich: unknown key (did you mean \"chain.pitch\"?)");
    EXPECT_EQ(message("chain.pitch"), "--set chain.pitch: not of the form key=value");
    EXPECT_EQ(message("detail.order=full"), "--set detail.order=full: detail.order: \"full\" is not an integer");
    EXPECT_EQ(message("chain.pitch="), "--set chain.pitch=: chain.pitch: \"\" does not begin with a number");
    EXPECT_EQ(message("half.length=8 mm\npins = 2").substr(0, 6), "--set ");
    EXPECT_EQ(message("chain.pitch=[8e-3").substr(0, 64), "--set chain.pitch=[8e-3: chain.pitch: not valid TOML: Error whil");
    EXPECT_EQ(message("start.state=nowhere.h5"), "--set start.state=nowhere.h5: start.state: no file \"nowhere.h5\"");
    EXPECT_EQ(scene.parameters, model::Parameters{});
}

TEST(SetValue, ChecksWhatValuesMustSatisfyTogether) {
    Scene scene;
    EXPECT_EQ(complaint([&] { set_value(scene, "chain.pins=40"); }),
              "--set chain.pins=40: chain.pins: 40 pins make a chain of 324.8 mm, too short for pulley.centre_distance = 170 mm");
    EXPECT_EQ(scene.parameters.chain.pins, 84);
}

TEST(SetValues, ThatAreConsistentOnlyTogetherAreTakenTogether) {
    Scene scene;
    const std::vector<std::string> settings{"detail.pulleys=absent", "start.layout=ring"};
    EXPECT_NE(complaint([&] { set_value(scene, settings[0]); }), "");
    set_values(scene, settings);
    EXPECT_EQ(scene.parameters.start.layout, model::StartLayout::ring);
}

TEST(SetValues, ReportAllProblemsInTheirOrder) {
    Scene scene;
    const std::vector<std::string> settings{"tip.angle=11", "half.length=40 mm", "chain.pins=two"};
    EXPECT_EQ(complaint([&] { set_values(scene, settings); }),
              "--set tip.angle=11: tip.angle: 11 rad is outside [1e-2, 0.8] rad (did you mean \"11 deg\"?)\n"
              "--set chain.pins=two: chain.pins: \"two\" is not an integer");
    EXPECT_EQ(scene.parameters, model::Parameters{});
}

TEST(SetValues, TheLastOfTwoSettingsOfAKeyCounts) {
    Scene scene;
    const std::vector<std::string> settings{"half.length=40 mm", "half.length=50 mm"};
    set_values(scene, settings);
    EXPECT_EQ(scene.parameters.half.length, 50e-3);
}

}  // namespace
}  // namespace cvtflow::tasks
