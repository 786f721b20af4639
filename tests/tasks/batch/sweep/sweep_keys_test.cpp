#include "tasks/batch/sweep/sweep_keys.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {
namespace {

using testing::HasSubstr;

TEST(SweepKeys, AreExplainedOneByOneByTableAndAllTogether) {
    for (const SweepKey& row : sweep_keys()) {
        const std::string text = explain_sweep(row.key());
        EXPECT_THAT(text, testing::StartsWith(row.key() + "\n")) << row.key();
        EXPECT_THAT(text, HasSubstr(std::string(row.meaning))) << row.key();
        EXPECT_THAT(explain_sweep("sweep"), HasSubstr(text.substr(0, text.find("\n\n")))) << row.key();  // alone, without what is below it
    }
    EXPECT_THAT(explain_sweep("sweep.axes"), testing::AllOf(HasSubstr("sweep.axes.key\n"), HasSubstr("sweep.axes.zip.values\n")));
    EXPECT_THAT(explain_sweep("sweep.axes.zip"), testing::Not(HasSubstr("sweep.axes.csv\n")));
}

TEST(SweepKeys, AnUnknownOneIsAnErrorWithASuggestion) {
    try {
        (void)explain_sweep("sweep.axes.vlues");
        FAIL();
    } catch (const SceneError& error) {
        EXPECT_STREQ(error.what(), "sweep.axes.vlues: unknown key of a sweep (did you mean \"sweep.axes.values\"?)");
    }
}

TEST(SweepKeys, SectionsAreThoseOfTheFile) {
    EXPECT_THAT(sweep_sections(), testing::ElementsAre("sweep", "set", "axes", "outputs", "budget", "start", "steady", "accuracy"));
}

TEST(SweepSchema, HasEveryKeyAndTheKeysOfScenes) {
    const auto schema = nlohmann::json::parse(sweep_schema());
    const auto& tables = schema.at("properties");
    EXPECT_EQ(tables.size(), sweep_sections().size());
    for (const SweepKey& row : sweep_keys()) {
        if (row.form == SweepForm::scene_keys) continue;
        const auto& section = tables.at(std::string(row.table.substr(0, row.table.find('.'))));
        const auto& table = section.contains("items") ? section.at("items") : section;
        const std::size_t dot = row.table.find('.');
        const auto& inner =
            dot == std::string_view::npos ? table : table.at("properties").at(std::string(row.table.substr(dot + 1))).at("items");
        EXPECT_TRUE(inner.at("properties").contains(std::string(row.name))) << row.key();
        EXPECT_EQ(inner.at("additionalProperties"), false) << row.key();
    }
    for (const Parameter& parameter : parameter_table()) {
        const auto& sections = tables.at("set").at("properties");
        EXPECT_TRUE(sections.at(std::string(parameter.section())).at("properties").contains(std::string(parameter.name())))
            << parameter.key;
    }
}

}  // namespace
}  // namespace cvtflow::tasks
