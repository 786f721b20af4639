/// Every file under broken/ is a scene with something wrong. Its first lines say which messages it must give, exactly.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {
namespace {

std::vector<std::filesystem::path> broken_scenes() {
    std::vector<std::filesystem::path> files;
    for (const auto& file : std::filesystem::directory_iterator(std::filesystem::path(CVTFLOW_SOURCE_DIR) / "tests/tasks/scene/broken"))
        files.push_back(file.path());
    std::sort(files.begin(), files.end());
    return files;
}

/// The lines `# expect: …` at the beginning of a scene, without that word.
std::string expectation(const std::string& text) {
    const std::string mark = "# expect: ";
    std::istringstream lines(text);
    std::vector<std::string> expected;
    for (std::string line; std::getline(lines, line) && line.starts_with(mark);) expected.push_back(line.substr(mark.size()));
    return fmt::format("{}", fmt::join(expected, "\n"));
}

class BrokenScene : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(BrokenScene, GivesExactlyTheMessageItExpects) {
    std::ifstream file(GetParam());
    std::ostringstream text;
    text << file.rdbuf();
    ASSERT_NE(expectation(text.str()), "");
    try {
        (void)parse_scene(text.str(), "scene.toml");
        FAIL() << "the scene was accepted";
    } catch (const SceneError& error) {
        EXPECT_EQ(error.what(), expectation(text.str()));
    }
}

INSTANTIATE_TEST_SUITE_P(All, BrokenScene, testing::ValuesIn(broken_scenes()),
                         [](const auto& scene) { return scene.param.stem().string(); });

TEST(BrokenScenes, AreMany) { EXPECT_GE(broken_scenes().size(), 55U); }

}  // namespace
}  // namespace cvtflow::tasks
