/// broken_scenes.txt contains scenes with something wrong: a line `=== name`, then the scene, whose first lines `# expect: …` are exactly
/// the messages that it must give.

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {
namespace {

struct Broken {
    std::string name, text, expected;
};

void PrintTo(const Broken& scene, std::ostream* out) { *out << scene.name; }

std::vector<Broken> broken_scenes() {
    const std::string head = "=== ";
    const std::string mark = "# expect: ";
    std::ifstream file(CVTFLOW_SOURCE_DIR "/tests/tasks/scene/broken_scenes.txt");
    std::vector<Broken> scenes;
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with(head)) {
            scenes.push_back({line.substr(head.size()), "", ""});
            continue;
        }
        Broken& scene = scenes.back();
        if (line.starts_with(mark)) scene.expected += (scene.expected.empty() ? "" : "\n") + line.substr(mark.size());
        scene.text += line + "\n";
    }
    return scenes;
}

class BrokenScene : public testing::TestWithParam<Broken> {};

TEST_P(BrokenScene, GivesExactlyTheMessageItExpects) {
    ASSERT_NE(GetParam().expected, "");
    try {
        (void)parse_scene(GetParam().text, "scene.toml");
        FAIL() << "the scene was accepted";
    } catch (const SceneError& error) {
        EXPECT_EQ(error.what(), GetParam().expected);
    }
}

INSTANTIATE_TEST_SUITE_P(All, BrokenScene, testing::ValuesIn(broken_scenes()), [](const auto& scene) { return scene.param.name; });

TEST(BrokenScenes, AreMany) { EXPECT_GE(broken_scenes().size(), 55U); }

}  // namespace
}  // namespace cvtflow::tasks
