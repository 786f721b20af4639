#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <nlohmann/json.hpp>

#include "tasks/scene/parameter_table.hpp"

namespace cvtflow::tasks {
namespace {

TEST(JsonSchema, HasEveryKeyAndNoOther) {
    const auto schema = nlohmann::json::parse(json_schema());
    EXPECT_EQ(schema.at("$schema"), "https://json-schema.org/draft/2020-12/schema");
    EXPECT_EQ(schema.at("additionalProperties"), false);
    std::size_t keys = 0;
    for (const auto& section : schema.at("properties")) {
        EXPECT_EQ(section.at("additionalProperties"), false);
        keys += section.at("properties").size();
    }
    EXPECT_EQ(keys, parameter_table().size());
    for (const Parameter& parameter : parameter_table())
        EXPECT_TRUE(schema.at("properties").at(std::string(parameter.section())).at("properties").contains(std::string(parameter.name())));
}

TEST(JsonSchema, AgreesWithTheParserOnReadyAndBrokenScenes) {
    const std::filesystem::path source = CVTFLOW_SOURCE_DIR;
    const auto schema = std::filesystem::temp_directory_path() / "cvtflow_scene_schema.json";
    std::ofstream(schema) << json_schema();
    const auto script = source / "tests/tasks/scene/validate_schema.py";
    const auto command = "python3 '" + script.string() + "' '" + schema.string() + "' '" + source.string() + "'";
    const int status = std::system(command.c_str());
    std::filesystem::remove(schema);
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    if (code == 77 || code == 127) GTEST_SKIP() << "needs python3 (3.11 or later) with jsonschema";
    EXPECT_EQ(code, 0);
}

}  // namespace
}  // namespace cvtflow::tasks
