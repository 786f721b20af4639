#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tasks/scene/parameter_table.hpp"

namespace cvtflow::tasks {
namespace {

void expect_equal(const Scene& a, const Scene& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.description, b.description);
    EXPECT_EQ(a.parameters, b.parameters);
    EXPECT_EQ(a.run, b.run);
    EXPECT_EQ(a.state_file, b.state_file);
}

TEST(SceneWriter, EveryReadySceneReadsBackEqual) {
    for (const auto& file : std::filesystem::directory_iterator(std::filesystem::path(CVTFLOW_SOURCE_DIR) / "scenes")) {
        if (file.path().extension() != ".toml") continue;
        const Scene scene = read_scene(file.path());
        expect_equal(parse_scene(write_scene(scene), "anything.toml"), scene);
    }
}

TEST(SceneWriter, SettingsAndPresetsAreInWhatIsWritten) {
    Scene scene = parse_scene("", "scene.toml");
    const std::vector<std::string> settings{"chain.pitch=[8.1e-3, 8.2e-3]", "clamping.driving=[[0, 0], [\"1/3\", 20e3]]",
                                            "scene.description=a \"quoted\" text"};
    const std::vector<std::string> good{settings[0], "clamping.driving=[[0, 0], [0.3333333333333333, 20e3]]", settings[2]};
    EXPECT_THROW(set_values(scene, settings), SceneError);
    set_values(scene, good);
    apply_detail(scene, "rigid");
    expect_equal(parse_scene(write_scene(scene), "scene.toml"), scene);
}

TEST(SceneWriter, AConstantThatBeginsLaterIsStillAConstant) {
    Scene scene = parse_scene("[load]\ntorque = [[\"5 ms\", 100]]\n", "scene.toml");
    expect_equal(parse_scene(write_scene(scene), "scene.toml"), scene);
}

TEST(SceneWriter, UnitsStandBesideTheValues) {
    EXPECT_NE(write_scene(Scene{}).find("[chain]\npins = 84\npitch = 8.12e-3  # m\n"), std::string::npos);
}

}  // namespace
}  // namespace cvtflow::tasks
