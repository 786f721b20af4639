#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml_tree.hpp"

#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tasks/scene/units.hpp"

namespace cvtflow::tasks {
namespace {

/// Reads `toml` as the value of `key`; returns the first problem's message, or nothing.
std::string read(const std::string& key, const std::string& toml, Scene& scene) {
    std::vector<Problem> problems;
    const auto document = std::get<Node>(parse_toml("value = " + toml));
    read_value(*find_parameter(key), std::get<Node::Table>(document.value).at(0).node, scene, problems);
    return problems.empty() ? std::string{} : problems.front().message;
}

TEST(ValueReader, PlainNumbersAreSi) {
    Scene scene;
    EXPECT_EQ(read("half.length", "40e-3", scene), "");
    EXPECT_EQ(scene.parameters.half.length, 40e-3);
    EXPECT_EQ(read("half.length", "1", scene), "");
    EXPECT_EQ(scene.parameters.half.length, 1.0);
}

TEST(ValueReader, NumberAndTextWithUnitAreTheSameDouble) {
    Scene scene;
    EXPECT_EQ(read("half.mass", "\"4.42 g\"", scene), "");
    EXPECT_EQ(scene.parameters.half.mass, 4.42e-3);
}

TEST(ValueReader, PlainNumberMayBeAPercentage) {
    Scene scene;
    EXPECT_EQ(read("chain.damping_ratio", "\"5 %\"", scene), "");
    EXPECT_EQ(scene.parameters.chain.damping_ratio, 0.05);
}

TEST(ValueReader, AWrongValueLeavesTheMemberAsItWas) {
    Scene scene;
    EXPECT_NE(read("half.length", "\"36 kg\"", scene), "");
    EXPECT_NE(read("chain.pitch", "[8e-3, 8.0]", scene), "");
    EXPECT_NE(read("load.torque", "[[0, 1], [0, 2]]", scene), "");
    EXPECT_EQ(scene.parameters, model::Parameters{});
}

TEST(ValueReader, PitchIsOneNumberOrAList) {
    Scene scene;
    EXPECT_EQ(read("chain.pitch", "\"8 mm\"", scene), "");
    EXPECT_EQ(scene.parameters.chain.pitch, std::vector{8e-3});
    EXPECT_EQ(read("chain.pitch", "[8.12e-3, \"7.5 mm\"]", scene), "");
    EXPECT_EQ(scene.parameters.chain.pitch, (std::vector{8.12e-3, 7.5e-3}));
}

TEST(ValueReader, TimeTableIsAConstantOrPoints) {
    Scene scene;
    EXPECT_EQ(read("load.torque", "\"120 N*m\"", scene), "");
    EXPECT_EQ(scene.parameters.load.torque, model::TimeTable(120.0));
    EXPECT_EQ(read("load.torque", "[[0.0, 0.0], [\"10 ms\", \"150 N*m\"]]", scene), "");
    EXPECT_EQ(scene.parameters.load.torque, model::TimeTable({0.0, 0.01}, {0.0, 150.0}));
}

TEST(ValueReader, TimeTableHoldsTenThousandPointsAndNoMore) {
    const auto points = [](int count) {
        std::string text = "[";
        for (int i = 0; i < count; ++i) text += fmt::format("[{}, 1],", i);
        return text + "]";
    };
    Scene scene;
    EXPECT_EQ(read("load.torque", points(10000), scene), "");
    EXPECT_EQ(scene.parameters.load.torque.time.size(), 10000U);
    EXPECT_EQ(read("load.torque", points(10001), scene), "load.torque: 10001 points are more than 10000");
}

TEST(ValueReader, GuessedUnitIsTheOneNearestToTheDefault) {
    Scene scene;
    EXPECT_EQ(read("run.step", "200", scene), "run.step: 200 s is outside [1e-12, 1e-2] s (did you mean \"200 ns\"?)");
    EXPECT_EQ(read("run.state_interval", "1e300", scene), "run.state_interval: 1e300 s is outside [1e-12, 1e4] s");
}

TEST(ValueReader, LimitsThemselvesAreAllowed) {
    Scene scene;
    for (const Parameter& parameter : parameter_table()) {
        if (parameter.unit.empty()) continue;
        const bool integer = parameter.kind() == Kind::integer;
        for (const double limit : {parameter.min, parameter.max}) {
            const auto text = integer ? std::to_string(static_cast<std::int64_t>(limit)) : number_text(limit);
            EXPECT_EQ(read(std::string(parameter.key), text, scene), "") << parameter.key;
        }
    }
}

TEST(ValueReader, EveryNumberRefusesAWrongDimensionAndBadNumbers) {
    Scene scene;
    for (const Parameter& parameter : parameter_table()) {
        if (parameter.unit.empty()) continue;
        const std::string key(parameter.key);
        for (const char* bad : {"\"1 m*s*kg\"", "nan", "inf", "-inf", "1e300", "-1e300", "true", "\"\"", "{}", "[]", "07:32:00"})
            EXPECT_EQ(read(key, bad, scene).substr(0, key.size() + 2), key + ": ") << bad;
    }
    EXPECT_EQ(scene.parameters, model::Parameters{});
    EXPECT_EQ(scene.run, RunSettings{});
}

}  // namespace
}  // namespace cvtflow::tasks
