/// The text of sources: how often comments, literals and names contain what the glossary rejects. The table beside this file states the
/// counts, which may only shrink.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/docs/page_fixture.hpp"
#include "tests/docs/source_text_fixture.hpp"

namespace cvtflow::docs {
namespace {

const std::string table_path = CVTFLOW_SOURCE_DIR "/tests/docs/source_words.csv";

/// Rejected in sources, allowed in pages.
constexpr std::array further_words{"look", "looked", "looking", "impatient", "at hand", "so many", "by how much"};
constexpr std::array openings{"Of ", "What ", "That many ", "Those ", "The same "};

/// Folder, place and rule, as in the table: "tasks/step,comment,wanted".
using Row = std::string;
using Counts = std::map<Row, int>;

/// Where a rule matches: "tasks/step/a.cpp:12: …".
using Places = std::map<Row, std::vector<std::string>>;

const char* name_of(Place place) { return place == Place::comment ? "comment" : place == Place::literal ? "literal" : "name"; }

std::vector<std::string> rejected_words() {
    std::vector<std::string> words = avoided_words(page("CONTRIBUTING.md"));
    words.insert(words.end(), further_words.begin(), further_words.end());
    return words;
}

bool is_in_word(const std::string& text, std::size_t at) {
    return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) != 0 || text[at] == '_');
}

/// Where a text contains a word or its plural. A name in a file (`energy_suspicion`) is one word.
std::vector<std::size_t> positions_of(const std::string& text, const std::string& word) {
    std::vector<std::size_t> found;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
        const std::size_t end = at + word.size();
        const std::size_t after = end < text.size() && text[end] == 's' ? end + 1 : end;
        if ((at == 0 || !is_in_word(text, at - 1)) && !is_in_word(text, after)) found.push_back(at);
    }
    return found;
}

/// Where a sentence begins with these words.
std::vector<std::size_t> beginnings_of(const std::string& text, const std::string& words) {
    std::vector<std::size_t> found;
    for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1))
        if (at == 0 || (at > 1 && text[at - 1] == ' ' && std::string_view(".?!").find(text[at - 2]) != std::string_view::npos))
            found.push_back(at);
    return found;
}

/// Where a docstring appends units to a finished sentence, "…; time [s]", or a second docstring in brackets, "[what save() wrote]".
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
    }
    return found;
}

/// Matches in all sources but this one and the glossary's, which plant them.
Places all_matches() {
    Places all;
    for (const auto& [path, source] : sources()) {
        if (path == "tests/docs/source_words_test.cpp" || path == "tests/docs/words_test.cpp") continue;
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

/// What differs from the table, as a message per row; empty: nothing.
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
                                 "/// @param time [s]\nint b;  ///< [size()] of steps\n/// Of c.\nint c;  ///< old; [m] of it; 0: [m]\n");
    std::vector<std::string> rows;
    for (const auto& [row, places] : found) rows.push_back(row + "," + std::to_string(places.size()));
    EXPECT_THAT(rows, testing::ElementsAre("model/a,comment,; unit […],2", "model/a,comment,Of …,2", "model/a,comment,That many …,1",
                                           "model/a,comment,The same …,1", "model/a,comment,Those …,1", "model/a,comment,What …,1"));
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
