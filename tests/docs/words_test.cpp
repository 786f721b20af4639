/// Words that the glossary lists as "not": they do not occur in pages, whose lines end at 140 columns, and in sources no more often than
/// the table beside this file states.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/docs/page_fixture.hpp"

namespace cvtflow::docs {
namespace {

namespace fs = std::filesystem;

// The text of pages: words that the glossary lists as "not" do not occur, and lines end at 140 columns.

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

bool is_in_word(const std::string& text, std::size_t at) {
    return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) != 0 || text[at] == '_');
}

/// Positions of a word or its plural in a text. A name in a file (`energy_suspicion`) is one word.
std::vector<std::size_t> positions_of(const std::string& text, const std::string& word) {
    std::vector<std::size_t> found;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
        const std::size_t end = at + word.size();
        const std::size_t after = end < text.size() && text[end] == 's' ? end + 1 : end;
        if ((at == 0 || !is_in_word(text, at - 1)) && !is_in_word(text, after)) found.push_back(at);
    }
    return found;
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
        for (const std::string& word : words)
            for (const std::size_t at : positions_of(text, word)) ADD_FAILURE() << each.path << ": " << word << ": " << text.substr(at, 60);
    }
}

TEST(Glossary, WordsAreFoundInProseAlone) {
    const Page sample{"sample.md",
                      "| word | means | not |\n|---|---|---|\n| target | an aim | *wanted*, *goes on*, log |\n\nThe run\n  Goes\non; a "
                      "`wanted` [x](wanted.md).\n"
                      "\n    wanted\n\n```sh\nwanted\n```\nunwanted\n"};
    EXPECT_THAT(avoided_words(sample), testing::ElementsAre("wanted", "goes on"));
    EXPECT_THAT(positions_of(prose(sample), "goes on"), testing::SizeIs(1));
    EXPECT_THAT(positions_of(prose(sample), "wanted"), testing::IsEmpty());
}

TEST(Pages, LinesEndAt140Columns) {
    for (const Page& each : pages()) {
        if (each.path.ends_with("_reference.md")) continue;  // written by tools: rows of tables cannot be folded
        for (const Line& line : each.text_lines()) EXPECT_LE(columns(line.text), max_columns) << each.path << ":" << line.number;
    }
}

TEST(Pages, ColumnsAreCodePoints) { EXPECT_EQ(columns("2 μs, 0 … 1"), 11u); }

// Sources as the glossary sees them: their comments, literals and names.

/// Kind of text in a source in which a word can occur.
enum class Place { comment, literal, name };

struct SourceText {
    Place place;
    int line;          ///< line of its beginning, from 1
    std::string text;  ///< comment: its consecutive lines, without code between backticks; name: its words, in lower case
    bool docstring = false;
};

bool is_in_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Words of a name: "StepGraph", "step_graph_" → "step graph".
std::string words_of(std::string_view name) {
    std::string words;
    for (std::size_t i = 0; i < name.size(); ++i) {
        const auto c = static_cast<unsigned char>(name[i]);
        const bool begins = std::isupper(c) != 0 && i > 0 && std::isupper(static_cast<unsigned char>(name[i - 1])) == 0;
        const bool word = begins || (i > 0 && name[i - 1] == '_');
        if (c == '_') continue;
        if (word && !words.empty()) words += ' ';
        words += static_cast<char>(std::tolower(c));
    }
    return words;
}

/// Removes code between backticks, and the space at both ends.
std::string comment_text(std::string_view text) {
    std::string kept;
    bool code = false;
    for (const char c : text) {
        if (!code && c != '`') kept += c;
        if (c == '`') code = !code;
    }
    const std::size_t begin = std::min(kept.find_first_not_of(' '), kept.size());
    return kept.substr(begin, kept.find_last_not_of(' ') + 1 - begin);
}

class Scanner {
public:
    explicit Scanner(std::string_view source) : source_(source) {}

    std::vector<SourceText> scan() {
        while (at_ < source_.size()) step();
        for (auto& [name, line] : names_) texts_.push_back({Place::name, line, words_of(name)});
        return std::move(texts_);
    }

private:
    void step() {
        const char c = source_[at_];
        const bool space = std::isspace(static_cast<unsigned char>(c)) != 0;
        if (!space && !begins("//") && c != '"') joins_ = false;
        if (begins("//") || (c == '#' && line_is_empty_)) return comment();
        if (begins("/*")) return skip(source_.find("*/", at_) + 2);
        if (begins("R\"")) return raw_literal();
        if (c == '"') return literal('"');
        if (c == '\'') return literal('\'');
        if (is_in_name(c)) return name();
        if (c == '\n') ++line_;
        line_is_empty_ = c == '\n' || (line_is_empty_ && space);
        ++at_;
    }

    /// A comment of one line; a preprocessor line is skipped alike.
    void comment() {
        if (begins("///<") != std::exchange(after_code_, begins("///<"))) joins_ = false;
        const std::size_t begin = std::min(source_.find_first_not_of("/<", at_), source_.size());
        const std::size_t end = std::min(source_.find('\n', at_), source_.size());
        const bool docstring = begins("///");
        if (source_[at_] != '#') {
            add(Place::comment, comment_text(source_.substr(std::min(begin, end), end - std::min(begin, end))), " ");
            texts_.back().docstring |= docstring;
        }
        skip(end);
    }

    void literal(char quote) {
        std::string text;
        std::size_t end = at_ + 1;
        for (; end < source_.size() && source_[end] != quote; ++end) {
            const bool escape = source_[end] == '\\';
            text += escape ? ' ' : source_[end];
            if (escape) ++end;
        }
        if (quote == '"') add(Place::literal, text, "");
        skip(end + 1);
    }

    void raw_literal() {
        const std::size_t open = source_.find('(', at_);
        const std::string close = ")" + std::string(source_.substr(at_ + 2, open - at_ - 2)) + "\"";
        const std::size_t end = source_.find(close, open);
        add(Place::literal, std::string(source_.substr(open + 1, end - open - 1)), "");
        skip(end + close.size());
    }

    /// A name or a number, whose digit separators are no quotes.
    void name() {
        const std::size_t begin = at_;
        const bool number = std::isdigit(static_cast<unsigned char>(source_[at_])) != 0;
        while (at_ < source_.size() && (is_in_name(source_[at_]) || (number && source_[at_] == '\''))) ++at_;
        line_is_empty_ = false;
        if (!number) names_.try_emplace(std::string(source_.substr(begin, at_ - begin)), line_);
    }

    /// Appends to the text before if only space is between them.
    void add(Place place, const std::string& text, const char* between) {
        const bool joined = joins_ && !texts_.empty() && texts_.back().place == place;
        if (joined) texts_.back().text += between + text;
        if (!joined) texts_.push_back({place, line_, text});
        joins_ = true;
    }

    [[nodiscard]] bool begins(std::string_view what) const { return source_.substr(at_, what.size()) == what; }

    void skip(std::size_t end) {
        end = std::min(end, source_.size());
        line_ += static_cast<int>(std::count(source_.begin() + static_cast<long>(at_), source_.begin() + static_cast<long>(end), '\n'));
        at_ = end;
        line_is_empty_ = false;
    }

    std::string_view source_;
    std::size_t at_ = 0;
    int line_ = 1;
    bool line_is_empty_ = true, joins_ = false, after_code_ = false;
    std::vector<SourceText> texts_;
    std::map<std::string, int> names_;
};

/// All comments and literals of C++ or C in their order, then its distinct names. Neighbours that only space separates are one text.
/// Preprocessor lines and characters are left out.
std::vector<SourceText> texts_of(std::string_view source) { return Scanner(source).scan(); }

/// Text of every .cpp, .hpp, .c and .h file of the product, the laboratory and the tests, by its path from the top level.
std::map<std::string, std::string> sources() {
    const fs::path top = CVTFLOW_SOURCE_DIR;
    std::map<std::string, std::string> found;
    for (const char* folder : {"model", "engine", "tasks", "api", "tools", "bench", "tests"}) {
        for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
            const std::string extension = entry.path().extension().string();
            if (extension != ".cpp" && extension != ".hpp" && extension != ".c" && extension != ".h") continue;
            found[entry.path().lexically_relative(top).generic_string()] = text_of(entry.path());
        }
    }
    return found;
}

// The text of sources: how often comments, literals and names contain what the glossary rejects. The table beside this file states the
// counts, which may only shrink.

const std::string table_path = CVTFLOW_SOURCE_DIR "/tests/docs/source_words.csv";

/// Rejected in sources, allowed in pages.
constexpr std::array further_words{"look", "looked", "looking", "impatient", "at hand", "so many", "by how much"};
constexpr std::array openings{"Of ", "What ", "That many ", "Those ", "The same "};
/// First words of docstrings that begin with neither a noun nor a verb, and are no sentence.
constexpr std::array fragments{"of ",     "what ",    "that ",   "from ",  "by ",   "with ",    "without ",
                               "in ",     "at ",      "on ",     "as ",    "its ",  "since ",   "so ",
                               "behind ", "between ", "before ", "after ", "also ", "likewise", "the latter "};

/// Folder, place and rule, as in the table: "tasks/step,comment,wanted".
using Row = std::string;
using Counts = std::map<Row, int>;

/// Places where a rule matches: "tasks/step/a.cpp:12: …".
using Places = std::map<Row, std::vector<std::string>>;

const char* name_of(Place place) { return place == Place::comment ? "comment" : place == Place::literal ? "literal" : "name"; }

std::vector<std::string> rejected_words() {
    std::vector<std::string> words = avoided_words(page("CONTRIBUTING.md"));
    words.insert(words.end(), further_words.begin(), further_words.end());
    return words;
}

/// Positions of sentences that begin with these words.
std::vector<std::size_t> beginnings_of(const std::string& text, const std::string& words) {
    std::vector<std::size_t> found;
    for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1))
        if (at == 0 || (at > 1 && text[at - 1] == ' ' && std::string_view(".?!").find(text[at - 2]) != std::string_view::npos))
            found.push_back(at);
    return found;
}

/// Positions where a docstring appends units to a finished sentence, "…; time [s]", or a second docstring in brackets, "[what save()
/// wrote]".
std::vector<std::size_t> unit_tails_of(const std::string& text) {
    std::vector<std::size_t> found;
    for (std::size_t at = text.find(" ["); at != std::string::npos; at = text.find(" [", at + 1)) {
        std::size_t name = at;
        while (name > 0 && is_in_word(text, name - 1)) --name;
        const bool tail = name < at && name > 1 && text.compare(name - 2, 2, "; ") == 0;
        if (tail || text.compare(at, 7, " [what ") == 0) found.push_back(at);
    }
    return found;
}

/// All matches of all rules in a source.
Places matches(const std::string& path, const std::string& source) {
    static const std::vector<std::string> words = rejected_words();
    const std::size_t top = path.find('/'), room = path.find('/', top + 1);
    const std::string folder = path.substr(0, room == std::string::npos ? top : room);
    Places found;
    for (const SourceText& text : texts_of(source)) {
        const auto note = [&](const std::string& rule, const std::vector<std::size_t>& positions) {
            for (const std::size_t at : positions)
                found[folder + "," + name_of(text.place) + "," + rule].push_back(path + ":" + std::to_string(text.line) + ": " +
                                                                                 text.text.substr(at, 60));
        };
        std::string lower = text.text;
        std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        for (const std::string& word : words) note(word, positions_of(lower, word));
        if (text.place != Place::comment) continue;
        for (const char* words_at_begin : openings) note(words_at_begin + std::string("…"), beginnings_of(text.text, words_at_begin));
        note("; unit […]", unit_tails_of(text.text));
        const bool fragment = std::ranges::any_of(fragments, [&](std::string_view word) { return lower.starts_with(word); });
        if (text.docstring && fragment) note("fragment …", {0});
    }
    return found;
}

/// Matches in all sources but this one, which plants them.
Places all_matches() {
    Places all;
    for (const auto& [path, source] : sources()) {
        if (path == "tests/docs/words_test.cpp") continue;
        for (auto& [row, places] : matches(path, source)) all[row].insert(all[row].end(), places.begin(), places.end());
    }
    return all;
}

Counts read_table() {
    std::ifstream file(table_path);
    Counts counts;
    for (std::string line; std::getline(file, line);) {
        const std::size_t comma = line.rfind(',');
        if (comma != std::string::npos && line != "folder,place,rule,count")
            counts[line.substr(0, comma)] += std::stoi(line.substr(comma + 1));
    }
    return counts;
}

void write_table(const Places& places) {
    std::ofstream file(table_path);
    file << "folder,place,rule,count\n";
    for (const auto& [row, each] : places) file << row << "," << each.size() << "\n";
}

/// Differences from the table, a message per row; empty: none.
std::string differences(const Places& places, const Counts& table) {
    Counts rows = table;
    for (const auto& [row, each] : places) rows.try_emplace(row, 0);
    std::string text;
    for (const auto& [row, allowed] : rows) {
        const std::vector<std::string> each = places.contains(row) ? places.at(row) : std::vector<std::string>{};
        const int count = static_cast<int>(each.size());
        if (count == allowed) continue;
        text += row + ": " + std::to_string(count) + " instead of " + std::to_string(allowed) + "\n";
        if (count > allowed)
            for (const std::string& place : each) text += "  " + place + "\n";
    }
    return text;
}

/// Matches per place and rule, in all folders together.
Counts totals(const Counts& counts) {
    Counts sums;
    for (const auto& [row, count] : counts) sums[row.substr(row.find(',') + 1)] += count;
    return sums;
}

TEST(Glossary, SourcesMatchTheTableOfRejectedWordsWhichOnlyShrinks) {
    const Places places = all_matches();
    const Counts table = read_table();
    if (std::getenv("CVTFLOW_WRITE_WORDS") == nullptr) {
        const std::string text = differences(places, table);
        EXPECT_TRUE(text.empty()) << text
                                  << "Where a count grew, use the word of CONTRIBUTING's glossary, and begin the sentence with its noun."
                                  << "\nWhere counts only shrank, or a file moved: CVTFLOW_WRITE_WORDS=1 build/tests/test_docs "
                                     "--gtest_filter='Glossary.*'";
        return;
    }
    Counts now;
    for (const auto& [row, each] : places) now[row] = static_cast<int>(each.size());
    const Counts before = totals(table);
    for (const auto& [rule, count] : totals(now)) ASSERT_LE(count, before.contains(rule) ? before.at(rule) : 0) << rule;
    write_table(places);
}

TEST(Glossary, WordsAreFoundInCommentsLiteralsAndNames) {
    const Places found = matches("tasks/step/a.hpp",
                                 "#include \"wanted.hpp\"\n"
                                 "/// The wanted step, `wanted`.\n"
                                 "int a = 1;  ///< unwanted; it goes\n"
                                 "            ///< on\n"
                                 "const char* b = \"energy_wanted\", *c = \"is \" \"\\nwanted\", *d = R\"(wanted)\", e = '\"';\n"
                                 "double wanted_steps = 1'000, Rungs; /* wanted */ int steps_wanted_, lookWantedUp;\n");
    const auto place = [&](const char* row) { return found.contains(row) ? found.at(row) : std::vector<std::string>{}; };
    using testing::ElementsAre;
    EXPECT_THAT(place("tasks/step,comment,wanted"), ElementsAre("tasks/step/a.hpp:2: wanted step, ."));
    EXPECT_THAT(place("tasks/step,comment,goes on"), ElementsAre("tasks/step/a.hpp:3: goes on"));
    EXPECT_THAT(place("tasks/step,literal,wanted"), ElementsAre("tasks/step/a.hpp:5: wanted", "tasks/step/a.hpp:5: wanted"));
    EXPECT_THAT(place("tasks/step,name,wanted"),
                ElementsAre("tasks/step/a.hpp:6: wanted up", "tasks/step/a.hpp:6: wanted", "tasks/step/a.hpp:6: wanted steps"));
    EXPECT_THAT(place("tasks/step,name,rung"), ElementsAre("tasks/step/a.hpp:6: rungs"));
    EXPECT_THAT(place("tasks/step,name,look"), ElementsAre("tasks/step/a.hpp:6: look wanted up"));
    EXPECT_EQ(found.size(), 6u);
}

TEST(Glossary, SentencesAreFoundByTheirBeginningAndUnitsByTheirTail) {
    const Places found = matches("model/a/b.cpp",
                                 "// What is it? Of steps.\n// Those of old. The same\n// again. Not What, nor Of.\nint a;\n"
                                 "/// That many steps; time [s], tail [unknowns].\nvoid load();  ///< memory [what save() wrote]\n"
                                 "/// @param time [s]\nint b;  ///< [size()] of steps\n/// Of c.\nint c;  ///< old; [m] of it; 0: [m]\n"
                                 "int d;  ///< by the steps\nint e;  // by them\nint f;  ///< bytes\n");
    std::vector<std::string> rows;
    for (const auto& [row, places] : found) rows.push_back(row + "," + std::to_string(places.size()));
    EXPECT_THAT(rows, testing::ElementsAre("model/a,comment,; unit […],2", "model/a,comment,Of …,2", "model/a,comment,That many …,1",
                                           "model/a,comment,The same …,1", "model/a,comment,Those …,1", "model/a,comment,What …,1",
                                           "model/a,comment,fragment …,3"));
}

TEST(Glossary, CountsThatGrewAndCountsThatShrankAreReported) {
    const Places places{{"model/a,name,rung", {"model/a/b.cpp:1: rung", "model/a/b.cpp:2: rung"}}};
    EXPECT_EQ(differences(places, {{"model/a,name,rung", 2}}), "");
    EXPECT_THAT(differences(places, {{"model/a,name,rung", 1}}),
                testing::HasSubstr("2 instead of 1\n  model/a/b.cpp:1: rung\n  model/a/b.cpp:2"));
    EXPECT_EQ(differences(places, {{"model/a,name,rung", 3}}), "model/a,name,rung: 2 instead of 3\n");
    EXPECT_EQ(differences({}, {{"model/a,name,rung", 3}}), "model/a,name,rung: 0 instead of 3\n");
    EXPECT_THAT(differences(places, {}), testing::HasSubstr("2 instead of 0"));
}

}  // namespace
}  // namespace cvtflow::docs
