#include "tasks/scene/parameter_table.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "model/variator/variator.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tasks/scene/units.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

/// The numbers of a member; none for other kinds.
std::vector<double> numbers(const Parameter& parameter, Scene& scene) {
    const Slot slot = parameter.member(scene);
    if (const auto* number = std::get_if<double*>(&slot)) return {**number};
    if (const auto* number = std::get_if<int*>(&slot)) return {static_cast<double>(**number)};
    if (const auto* number = std::get_if<long*>(&slot)) return {static_cast<double>(**number)};
    if (const auto* number = std::get_if<std::uint64_t*>(&slot)) return {static_cast<double>(**number)};
    if (const auto* list = std::get_if<std::vector<double>*>(&slot)) return **list;
    if (const auto* table = std::get_if<model::TimeTable*>(&slot)) return (*table)->value;
    return {};
}

/// A key of a section and a name, a member of its own, a default inside its range; a number has a unit with a name, others have none.
TEST(ParameterTable, RowsAreCompleteAndOfTheirOwn) {
    Scene scene;
    std::set<std::string_view> keys;
    std::set<const void*> members;
    for (const Parameter& parameter : parameter_table()) {
        SCOPED_TRACE(parameter.key);
        EXPECT_TRUE(keys.insert(parameter.key).second);
        EXPECT_EQ(std::count(parameter.key.begin(), parameter.key.end(), '.'), 1);
        EXPECT_EQ(std::string(parameter.section()) + "." + std::string(parameter.name()), parameter.key);
        EXPECT_TRUE(members.insert(std::visit([](auto* member) -> const void* { return member; }, parameter.member(scene))).second);
        for (const double value : numbers(parameter, scene)) EXPECT_TRUE(value >= parameter.min && value <= parameter.max) << value;
        const Kind kind = parameter.kind();
        const bool number = kind != Kind::choice && kind != Kind::boolean && kind != Kind::text && kind != Kind::text_list;
        EXPECT_EQ(!parameter.unit.empty(), number);
        EXPECT_TRUE(!number || dimension_name(dimension_of(parameter.unit)) != "");
        EXPECT_EQ(!parameter.choices.empty(), kind == Kind::choice || kind == Kind::auto_number);
        EXPECT_EQ(number, parameter.min < parameter.max);
        EXPECT_TRUE(parameter.meaning.ends_with('.'));
        EXPECT_FALSE(parameter.source.empty());
    }
    const auto names = section_names();
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size()) << "keys of a section are adjacent";
}

TEST(ParameterTable, StiffnessesMassesAndInertiasReachFromAThousandthToAThousandfold) {
    const std::set<std::string_view> scaled{"N/m", "N/m^1.5", "N*m/rad", "N*m^2", "Pa", "kg"};
    Scene scene;
    int found = 0;
    for (const Parameter& parameter : parameter_table()) {
        const bool body = parameter.unit == "kg*m^2" && parameter.section() == "pulley";
        if (!scaled.contains(parameter.unit) && !body) continue;
        const double value = numbers(parameter, scene).front();
        EXPECT_LE(parameter.min, 1.0001e-3 * value) << parameter.key;
        EXPECT_GE(parameter.max, 0.9999e3 * value) << parameter.key;
        ++found;
    }
    EXPECT_GT(found, 20);
}

TEST(ParameterTable, SaturationSpeedsAreStrictlyPositiveAndSpanSevenDecades) {
    for (const char* key : {"plate.saturation_speed", "joint.saturation_speed", "tip.saturation_speed"}) {
        const Parameter* parameter = find_parameter(key);
        ASSERT_NE(parameter, nullptr);
        EXPECT_EQ(parameter->min, 1e-6);
        EXPECT_EQ(parameter->max, 10.0);
    }
}

TEST(ParameterTable, KeysInWhichScenesDifferAreInTheOrderOfTheTableWithBothValues) {
    Scene a, b;
    b.name = "another";
    set_values(b, std::vector<std::string>{"run.output_interval=2 us", "half.mass=3 g"});
    const auto all = [](const Parameter&) { return true; };
    EXPECT_TRUE(differing_keys(a, a, all).empty());
    std::vector<std::string_view> keys;
    for (const KeyDifference& each : differing_keys(a, b, all)) {
        keys.push_back(each.key->key);
        EXPECT_EQ(each.a, value_text(*each.key, a));
        EXPECT_EQ(each.b, value_text(*each.key, b));
    }
    EXPECT_EQ(keys, (std::vector<std::string_view>{"scene.name", "half.mass", "run.output_interval"}));
    const auto of_runs = [](const Parameter& key) { return key.section() == "run"; };
    const std::vector<KeyDifference> run = differing_keys(a, b, of_runs, readable_value);
    ASSERT_EQ(run.size(), 1u);
    EXPECT_EQ(run[0].key->key, "run.output_interval");
    EXPECT_EQ(run[0].b, "2 us");
}

TEST(ParameterTable, NearestKeysAreByEndingOrSectionOrSpelling) {
    using Keys = std::vector<std::string>;
    EXPECT_EQ(nearest_keys("chain.pich"), Keys{"chain.pitch"});
    EXPECT_EQ(nearest_keys("joint.friction"), Keys{"joint.friction_coefficient"});
    EXPECT_EQ(nearest_keys("gearbox.teeth"), Keys{});
    for (const char* of_a_part_and_a_dial : {"half.pins", "pins"})
        EXPECT_EQ(nearest_keys(of_a_part_and_a_dial), (Keys{"chain.pins", "detail.pins"}));
}

TEST(ParameterTable, ChoicesAreNamedInTheOrderOfTheEnumerators) {
    Scene scene;
    scene.parameters.detail.pulleys = model::PulleyDetail::absent;
    scene.parameters.joint.law = model::JointLaw::palmgren;
    scene.parameters.drive.mode = model::DriveMode::torque;
    scene.parameters.detail.plates = model::PlateDetail::lumped;
    scene.parameters.detail.friction = model::FrictionLaw::smoothed;
    scene.parameters.start.layout = model::StartLayout::ring;
    for (const auto& [key, name] : {std::pair{"detail.pulleys", "absent"},
                                    {"joint.law", "palmgren"},
                                    {"drive.mode", "torque"},
                                    {"detail.plates", "lumped"},
                                    {"detail.friction", "smoothed"},
                                    {"start.layout", "ring"}})
        EXPECT_EQ(value_text(*find_parameter(key), scene), fmt::format("\"{}\"", name)) << key;
}

/// Gives the member of a key another value, whether allowed or not. @return false: tables, which have no plain value
bool change(const Slot& slot) {
    return std::visit(
        [](auto* member) {
            using Value = std::remove_reference_t<decltype(*member)>;
            if constexpr (std::is_same_v<Value, bool>) {
                *member = !*member;
            } else if constexpr (std::is_arithmetic_v<Value>) {
                *member += 1;
            } else if constexpr (std::is_enum_v<Value>) {
                *member = static_cast<Value>(static_cast<int>(*member) == 0 ? 1 : 0);
            } else if constexpr (std::is_same_v<Value, std::vector<double>>) {
                member->push_back(1.0);
            } else {
                return false;
            }
            return true;
        },
        slot);
}

/// A sweep takes the variator of the case before where the machine is the same: a key of the machine that is not compared would be lost.
TEST(ParameterTable, EveryKeyOfAMachineMakesItAnother) {
    const std::set<std::string_view> machine{"detail", "chain", "half",   "plate",        "joint", "tip",
                                             "oil",    "wear",  "pulley", "imperfection", "guide"};
    const std::set<std::string_view> inputs{"scene",    "heat",    "drive",      "load",  "drag", "vehicle", "cycle",
                                            "clamping", "control", "hydraulics", "start", "run",  "record"};
    int changed = 0;
    for (const Parameter& parameter : parameter_table()) {
        EXPECT_NE(machine.contains(parameter.section()), inputs.contains(parameter.section())) << parameter.section();
        Scene scene, other;
        if (parameter.key == level_key) continue;  // sets other keys
        if (!machine.contains(parameter.section()) || !change(parameter.member(other))) continue;
        EXPECT_FALSE(model::Variator::same_machine(scene.parameters, other.parameters)) << parameter.key;
        ++changed;
    }
    EXPECT_GT(changed, 80);
}

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
    for (const auto& [key, text] : {std::pair{"tip.angle", "11 deg"},
                                    {"drive.speed", "2000 rpm"},
                                    {"chain.pitch", "8.12 mm"},
                                    {"load.torque", "150 N*m"},
                                    {"run.step", "\"auto\""},
                                    {"chain.pins", "84"}})
        EXPECT_EQ(readable_value(*find_parameter(key), Scene{}), text);
}

TEST(Explain, UnknownKeyIsAnErrorWithASuggestion) {
    EXPECT_EQ(message_of([] { return explain("chain.pich"); }), "chain.pich: unknown key (did you mean \"chain.pitch\"?)");
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

TEST(SceneWriter, ScenesReadBackEqual) {
    for (const ReadyScene& ready : ready_scenes()) {
        SCOPED_TRACE(ready.name);
        const Scene scene = read_scene(scene_file(ready.name));
        expect_equal(parse_scene(write_scene(scene), "anything.toml"), scene);
    }
    Scene set = parse_scene("", "scene.toml");
    EXPECT_NE(message_of_settings(set, {"clamping.driving=[[0, 0], [\"1/3\", 20e3]]"}), "");
    set_values(set, std::vector<std::string>{"chain.pitch=[8.1e-3, 8.2e-3]", "clamping.driving=[[0, 0], [0.3333333333333333, 20e3]]",
                                             "scene.description=a \"quoted\" text"});
    apply_detail(set, "rigid");
    const Scene later = parse_scene("[load]\ntorque = [[\"5 ms\", 100]]\n", "scene.toml");  // a constant
    for (const Scene& scene : {set, later}) expect_equal(parse_scene(write_scene(scene), "scene.toml"), scene);
}

TEST(SceneWriter, UnitsStandBesideTheValues) {
    EXPECT_NE(write_scene(Scene{}).find("[chain]\npins = 84\npitch = 8.12e-3  # m\n"), std::string::npos);
}

}  // namespace
}  // namespace cvtflow::tasks
