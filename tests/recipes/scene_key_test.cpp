/// Recipe "a key of scenes": a member and a row of the parameter table, from which reading, units, limits and documents follow.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml_tree.hpp"

namespace cvtflow::recipes {
namespace {

/// The member represents a new one of the parameters.
const tasks::Parameter toy_length{
    "half.toy_length", "m", 1e-3, 0.1, {}, tasks::of<&model::Half::length>, "Length of nothing, for a recipe.", "recipe"};

std::vector<tasks::Problem> read_toy(const tasks::Node& node, tasks::Scene& scene) {
    std::vector<tasks::Problem> problems;
    tasks::read_value(toy_length, node, scene, problems);
    return problems;
}

TEST(KeyRecipe, ItsRowReadsNumbersAndTextsWithUnits) {
    tasks::Scene scene;
    EXPECT_TRUE(read_toy({0.02, {}}, scene).empty());
    EXPECT_EQ(scene.parameters.half.length, 0.02);
    EXPECT_TRUE(read_toy({std::string("30 mm"), {}}, scene).empty());
    EXPECT_DOUBLE_EQ(scene.parameters.half.length, 0.03);
}

TEST(KeyRecipe, ItsRowRefusesWrongDimensionsAndValuesOutsideItsRange) {
    tasks::Scene scene;
    const double before = scene.parameters.half.length;
    EXPECT_EQ(read_toy({std::string("3 kg"), {}}, scene).size(), 1u);
    EXPECT_EQ(read_toy({0.5, {}}, scene).size(), 1u);
    EXPECT_EQ(scene.parameters.half.length, before);
}

TEST(KeyRecipe, ItsRowKnowsItsSectionAndKind) {
    EXPECT_EQ(toy_length.section(), "half");
    EXPECT_EQ(toy_length.name(), "toy_length");
    EXPECT_EQ(toy_length.kind(), tasks::Kind::number);
}

}  // namespace
}  // namespace cvtflow::recipes
