/// The text of pages: words that the glossary lists as "not" do not occur, and lines end at 140 columns.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/docs/page_fixture.hpp"

namespace cvtflow::docs {
namespace {

constexpr std::size_t max_columns = 140;

/// The text without what lies between an opening and the next closing mark, marks included.
std::string without(const std::string& text, std::string_view open, char close) {
    std::string kept;
    for (std::size_t at = 0;;) {
        const std::size_t begin = text.find(open, at);
        kept += text.substr(at, begin - at);
        if (begin == std::string::npos) return kept;
        at = text.find(close, begin + open.size());
        if (at++ == std::string::npos) return kept;
    }
}

/// Text of a page in lower case on one line, without blocks, indented code, code between backticks, targets of links, and the glossary's
/// table.
std::string prose(const Page& page) {
    std::string joined;
    bool glossary = false;
    for (const Line& line : page.text_lines()) {
        glossary = line.text.starts_with("|") && (glossary || line.text == "| word | means | not |");
        if (glossary || line.text.starts_with("    ")) continue;
        joined += line.text.substr(std::min(line.text.size(), line.text.find_first_not_of(' '))) + " ";
    }
    std::string plain = without(without(joined, "`", '`'), "](", ')');
    std::transform(plain.begin(), plain.end(), plain.begin(), [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    return plain;
}

/// Where a word occurs as a whole word, with what surrounds it; empty: nowhere.
std::string occurrence(const std::string& text, std::string_view word) {
    const auto letter = [&](std::size_t at) { return at < text.size() && std::isalnum(static_cast<unsigned char>(text[at])) != 0; };
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
        if ((at > 0 && letter(at - 1)) || letter(at + word.size())) continue;
        const std::size_t begin = at - std::min<std::size_t>(at, 40);
        return text.substr(begin, at - begin + word.size() + 40);
    }
    return {};
}

bool is_history(const Page& page) { return page.path == "CHANGELOG.md" || page.path.starts_with("docs/decisions/"); }

/// Columns of a line of UTF-8: its code points.
std::size_t columns(std::string_view line) {
    return static_cast<std::size_t>(std::count_if(line.begin(), line.end(), [](char byte) { return (byte & 0xC0) != 0x80; }));
}

TEST(Glossary, WordsListedAsNotDoNotOccur) {
    const std::vector<std::string> words = avoided_words(page("CONTRIBUTING.md"));
    EXPECT_GE(words.size(), 20u);
    for (const Page& each : pages()) {
        if (is_history(each)) continue;
        const std::string text = prose(each);
        for (const std::string& word : words) EXPECT_EQ(occurrence(text, word), "") << each.path << ": " << word;
    }
}

TEST(Glossary, WordsAreFoundInProseAlone) {
    const Page sample{"sample.md",
                      "| word | means | not |\n|---|---|---|\n| target | an aim | *wanted*, *goes on*, log |\n\nThe run\n  Goes\non; a "
                      "`wanted` [x](wanted.md).\n"
                      "\n    wanted\n\n```sh\nwanted\n```\nunwanted\n"};
    EXPECT_THAT(avoided_words(sample), testing::ElementsAre("wanted", "goes on"));
    EXPECT_THAT(occurrence(prose(sample), "goes on"), testing::HasSubstr("the run goes on; a"));
    EXPECT_EQ(occurrence(prose(sample), "wanted"), "");
}

TEST(Pages, LinesEndAt140Columns) {
    for (const Page& each : pages()) {
        if (each.path.ends_with("_reference.md")) continue;  // written by tools: rows of tables cannot be folded
        for (const Line& line : each.text_lines()) EXPECT_LE(columns(line.text), max_columns) << each.path << ":" << line.number;
    }
}

TEST(Pages, ColumnsAreCodePoints) { EXPECT_EQ(columns("2 μs, 0 … 1"), 11u); }

}  // namespace
}  // namespace cvtflow::docs
