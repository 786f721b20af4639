#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::tasks {

namespace {

TEST(Explain, StatesMeaningUnitRangeDefaultAndSource) {
    EXPECT_EQ(explain("tip.angle"),
              "tip.angle\n"
              "  Angle of the sheave's flank: half the wedge angle.\n"
              "  value:    a number in rad or a text with a unit (\"... deg\")\n"
              "  range:    1e-2 to 0.8 rad\n"
              "  default:  11 deg\n"
              "  source:   published chain variators\n");
}

TEST(Explain, KnowsEveryKey) {
    for (const Parameter& parameter : parameter_table()) {
        const std::string text = explain(parameter.key);
        EXPECT_NE(text.find(parameter.meaning), std::string::npos) << parameter.key;
        EXPECT_NE(text.find(fmt::format("default:  {}", readable_value(parameter, Scene{}))), std::string::npos) << parameter.key;
        EXPECT_NE(text.find(fmt::format("source:   {}", parameter.source)), std::string::npos) << parameter.key;
        EXPECT_EQ(text.find("range:") != std::string::npos, !parameter.unit.empty()) << parameter.key;
        for (const auto choice : parameter.choices) EXPECT_NE(text.find(fmt::format("\"{}\"", choice)), std::string::npos);
    }
}

TEST(Explain, DefaultsAreInTheUnitThatPeopleUse) {
    const auto of = [](const char* key) { return readable_value(*find_parameter(key), Scene{}); };
    EXPECT_EQ(of("tip.angle"), "11 deg");
    EXPECT_EQ(of("drive.speed"), "2000 rpm");
    EXPECT_EQ(of("chain.pitch"), "8.12 mm");
    EXPECT_EQ(of("load.torque"), "150 N*m");
    EXPECT_EQ(of("run.step"), "\"auto\"");
    EXPECT_EQ(of("chain.pins"), "84");
}

TEST(Explain, UnknownKeyIsAnErrorWithASuggestion) {
    try {
        (void)explain("chain.pich");
        FAIL();
    } catch (const SceneError& error) {
        EXPECT_STREQ(error.what(), "chain.pich: unknown key (did you mean \"chain.pitch\"?)");
    }
}

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
