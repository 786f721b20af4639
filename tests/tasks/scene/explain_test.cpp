#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml/units.hpp"

namespace cvtflow::tasks {
namespace {

TEST(Explain, SaysMeaningUnitRangeDefaultAndSource) {
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

}  // namespace
}  // namespace cvtflow::tasks
