#include "tasks/scene/toml/toml_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {
namespace {

std::string complaint(const std::string& text) {
    try {
        static_cast<void>(parse_scene(text, "s.toml"));
    } catch (const SceneError& error) {
        return error.what();
    }
    return "none";
}

std::string repeated(const std::string& part, int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += part;
    return text;
}

TEST(TomlLimits, RefuseWhatWouldOverflowTheStack) {
    EXPECT_EQ(complaint(repeated("a.", 50000) + "a = 1\n"), "s.toml:1:64: not valid TOML: a key of more than 32 parts");
    EXPECT_EQ(complaint("\n[" + repeated("a . ", 50000) + "a]\n").substr(0, 9), "s.toml:2:");
    EXPECT_EQ(complaint(repeated("\"x\".", 50000) + "a = 1\n"), "s.toml:1:128: not valid TOML: a key of more than 32 parts");
    EXPECT_EQ(complaint("x = " + repeated("[", 50000)), "s.toml:1:37: not valid TOML: values nested more than 32 deep");
    EXPECT_EQ(complaint("x = " + repeated("{a = ", 50000)), "s.toml:1:165: not valid TOML: values nested more than 32 deep");
    EXPECT_EQ(complaint("x = " + repeated("[\n", 33)), "s.toml:33:1: not valid TOML: values nested more than 32 deep");
}

TEST(TomlLimits, RefuseKeysAndTextsThatTakeSecondsOrGigabytes) {
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(complaint("[chain]\n" + std::string(1 << 20, 'k') + " = 1\n"),
              "s.toml:2:257: not valid TOML: a key or number of more than 256 characters");
    EXPECT_EQ(complaint(std::string((4 << 20) + 1, '\n')), "s.toml:1:1: not valid TOML: longer than 4194304 bytes");
    const std::string quoted = complaint("[chain]\n\"" + std::string(1 << 20, 'k') + "\" = 1\n");
    EXPECT_EQ(quoted, "s.toml:2:1: chain." + std::string(54, 'k') + "…: unknown key");
    std::string many = "[chain]\n";
    for (int i = 0; i < 50000; ++i) many += "k" + std::to_string(i) + " = 1\n";
    const std::string told = complaint(many);
    EXPECT_EQ(std::count(told.begin(), told.end(), '\n'), 100);
    EXPECT_EQ(told.substr(told.rfind('\n') + 1), "… and 49900 more problems");
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));  // 12 s for one key before
}

TEST(TomlLimits, KnowWhatIsTextAndWhatIsNot) {
    EXPECT_FALSE(
        beyond_limits("[scene]\ndescription = \"" + repeated("a.", 1000) + repeated("[", 1000) + std::string(1000, 'x') + "\\\"" + "\"\n")
            .has_value());
    EXPECT_FALSE(beyond_limits("x = '''\n" + repeated("[{.", 1000) + "'''\n").has_value());
    EXPECT_FALSE(beyond_limits("x = \"\"\"\n" + repeated("[{\\\"\"", 1000) + "\"\"\"\n").has_value());
    EXPECT_FALSE(beyond_limits("# " + repeated("[.", 1000) + "\nx = 1\n# " + repeated("[", 1000)).has_value());
    EXPECT_FALSE(beyond_limits(repeated("x = [1.5, 2.5, [3.5]]\n", 1000)).has_value());
    EXPECT_TRUE(beyond_limits("x = \"\"\n" + repeated("[", 33)).has_value());
    EXPECT_TRUE(beyond_limits("x = \"not closed\n" + repeated("[", 33)).has_value());
}

TEST(Settings, AreNotBlamedForWhatTheyDidNotSay) {
    Scene scene = parse_scene("[scene]\nname = \"mine\"\n", "s.toml");
    scene.run.state_interval = 0.5 * scene.run.output_interval;  // as a program may leave it
    try {
        set_value(scene, "run.seed=3");
        FAIL();
    } catch (const SceneError& error) {
        EXPECT_EQ(std::string(error.what()).substr(0, 21), "mine, its present val");
    }
}

}  // namespace
}  // namespace cvtflow::tasks
