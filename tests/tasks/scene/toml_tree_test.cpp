#include "tasks/scene/toml/toml_tree.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace cvtflow::tasks
