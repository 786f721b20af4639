#include <gtest/gtest.h>
#include <algorithm>
#include <ctime>

#include "tasks/scene/scene.hpp"
#include "tasks/scene/toml_tree.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {

namespace {

TEST(TomlTree, KeysAndValuesKnowTheirPlace) {
    const auto document = std::get<Node>(parse_toml("[chain]\n  pins = 84\n"));
    const auto& chain = std::get<Node::Table>(document.value).at(0);
    EXPECT_EQ(chain.key, "chain");
    EXPECT_EQ(chain.position, (Position{1, 2}));
    const auto& pins = std::get<Node::Table>(chain.node.value).at(0);
    EXPECT_EQ(pins.position, (Position{2, 3}));
    EXPECT_EQ(pins.node.position, (Position{2, 10}));
    EXPECT_EQ(std::get<std::int64_t>(pins.node.value), 84);
}

TEST(TomlTree, EveryKindOfValueIsKept) {
    const auto document = std::get<Node>(parse_toml("v = [true, 1, 0.5, \"text\", [], {}, 2024-01-01, 12:00:00]\n"));
    const auto& list = std::get<Node::Array>(std::get<Node::Table>(document.value).at(0).node.value);
    EXPECT_TRUE(std::get<bool>(list.at(0).value));
    EXPECT_EQ(std::get<std::int64_t>(list.at(1).value), 1);
    EXPECT_EQ(std::get<double>(list.at(2).value), 0.5);
    EXPECT_EQ(std::get<std::string>(list.at(3).value), "text");
    EXPECT_TRUE(std::holds_alternative<Node::Array>(list.at(4).value));
    EXPECT_TRUE(std::holds_alternative<Node::Table>(list.at(5).value));
    EXPECT_TRUE(std::holds_alternative<Date>(list.at(6).value));
    EXPECT_TRUE(std::holds_alternative<Date>(list.at(7).value));
}

TEST(TomlTree, ViolationOfTheGrammarIsAProblemWithItsPlace) {
    const auto problem = std::get<Problem>(parse_toml("a = 1\nb = \n"));
    EXPECT_EQ(problem.position.line, 2);
    EXPECT_EQ(problem.message.substr(0, 15), "not valid TOML:");
}

TEST(TomlTree, TextsThatBreakTheParsersOwnAssumptionsAreProblemsToo) {
    for (const char* text : {"[[[a]]]", "[[[1]]]", "[[=", "[[[", "[", "a.", "a = [", "a = {", "a = 0x", "\xef\xbb", "\xff\xfe"})
        EXPECT_TRUE(std::holds_alternative<Problem>(parse_toml(text))) << text;
}

TEST(TomlTree, CharactersBeyondAsciiBelongInQuotesAndComments) {
    const std::string good = "\xef\xbb\xbf# é\nk = \"é \\\" é\" # é\n'é' = \"\"\"é\n\"é\" é\"\"\"\"\nl = '''\né'''\ne = \"\"\n";
    EXPECT_TRUE(std::holds_alternative<Node>(parse_toml(good)));
    for (const char* text :
         {"\nµ = 1", "# é\nµ = 1", "k = \"é\" µ", "k = 'é\\' µ", "k = \"\"\"é\"\"\" µ", "k = 5 µ", "k = 5\"µ", "k = \"é\nµ"})
        EXPECT_TRUE(std::holds_alternative<Problem>(parse_toml(text))) << text;
    EXPECT_EQ(std::get<Problem>(parse_toml("a = 1\nk = \"é\" µ")).position, (Position{2, 9}));
}

TEST(TomlTree, QuotedTextReadsBackEqual) {
    const std::string text = "a \"quoted\" \\ path\nwith\ttabs, \x01 and µ";
    const auto document = std::get<Node>(parse_toml("v = " + toml_text(text)));
    EXPECT_EQ(std::get<std::string>(std::get<Node::Table>(document.value).at(0).node.value), text);
}

std::string complaint(const std::string& text) {
    return message_of([&] { return parse_scene(text, "s.toml"); });
}

std::string repeated(const std::string& part, int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += part;
    return text;
}

TEST(TomlLimits, RefuseWhatWouldOverflowTheStack) {
    const std::string parts = "not valid TOML: a key of more than 32 parts", nested = "not valid TOML: values nested more than 32 deep";
    EXPECT_EQ(complaint(repeated("a.", 50000) + "a = 1\n"), "s.toml:1:64: " + parts);
    EXPECT_EQ(complaint("\n[" + repeated("a . ", 50000) + "a]\n").substr(0, 9), "s.toml:2:");
    EXPECT_EQ(complaint(repeated("\"x\".", 50000) + "a = 1\n"), "s.toml:1:128: " + parts);
    EXPECT_EQ(complaint("x = " + repeated("[", 50000)), "s.toml:1:37: " + nested);
    EXPECT_EQ(complaint("x = " + repeated("{a = ", 50000)), "s.toml:1:165: " + nested);
    EXPECT_EQ(complaint("x = " + repeated("[\n", 33)), "s.toml:33:1: " + nested);
}

TEST(Settings, AreNotBlamedForWhatTheyDidNotSay) {
    Scene scene = parse_scene("[scene]\nname = \"mine\"\n", "s.toml");
    scene.run.step = 2.0 * scene.run.output_interval;  // as a program may leave it
    EXPECT_EQ(message_of_settings(scene, {"run.seed=3"}).substr(0, 21), "mine, its present val");
}

}  // namespace

}  // namespace cvtflow::tasks
