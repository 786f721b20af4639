/// The files that recipes name are there, and each recipe has its worked example.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

namespace cvtflow::recipes {
namespace {

namespace fs = std::filesystem;

TEST(Recipes, NameFilesThatAreThere) {
    static const std::regex step("[0-9]+\\. `([^`]+)`.*"), example("Worked example: \\[`[^`]+`\\]\\(([^)]+)\\).*"), heading("### Add (.*)");
    std::ifstream file(fs::path(CVTFLOW_SOURCE_DIR) / "CONTRIBUTING.md");
    int recipes = 0, steps = 0, examples = 0;
    for (std::string line; std::getline(file, line);) {
        std::smatch match;
        if (std::regex_match(line, match, heading)) ++recipes;
        const bool names_file = std::regex_match(line, match, step), names_example = !names_file && std::regex_match(line, match, example);
        if (recipes == 0 || (!names_file && !names_example)) continue;
        ++(names_file ? steps : examples);
        EXPECT_TRUE(fs::exists(fs::path(CVTFLOW_SOURCE_DIR) / match[1].str())) << line;
    }
    EXPECT_EQ(recipes, 7);
    EXPECT_EQ(examples, recipes);
    EXPECT_GE(steps, 2 * recipes);
}

}  // namespace
}  // namespace cvtflow::recipes
